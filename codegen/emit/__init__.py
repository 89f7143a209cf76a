"""Plan -> the text of every emitted file."""
