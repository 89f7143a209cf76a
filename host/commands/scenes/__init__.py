"""Commands that emit, check, validate and run scenes."""
