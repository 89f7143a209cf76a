"""Readers of files from outside: text and binary formats -> recordings."""
