"""Recordings replayed through the C: accuracy, its store, report."""
