"""Recordings: the type, its file and journal, conditioning; formats and quality beside."""
