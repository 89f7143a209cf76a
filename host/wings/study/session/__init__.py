"""One session with a person: trials on a device, two screens, a journal that survives."""
