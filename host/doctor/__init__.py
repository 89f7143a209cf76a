"""What is missing on this machine, and at a device before its first session."""
