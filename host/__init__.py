"""Floor 4: build, load, devices, validation, reports, command line."""
