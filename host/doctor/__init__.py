"""Checks of this machine, and of a device before its first session."""
