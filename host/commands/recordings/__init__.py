"""Commands that make, read and show recordings."""
