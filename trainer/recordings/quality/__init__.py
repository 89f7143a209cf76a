"""Checks of recordings, and what their findings mean for a model."""
