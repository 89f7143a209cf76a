"""Pages that run the emitted C, or show a session, in a browser."""
