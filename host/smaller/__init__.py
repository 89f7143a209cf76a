"""Smaller models: forests within a loss of error, and versions that fit a scene's budget."""
