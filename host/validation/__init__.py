"""Recordings replayed through the C: accuracy, what is kept of it, report."""
