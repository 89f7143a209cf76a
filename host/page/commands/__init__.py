"""The command that writes a page to press."""
