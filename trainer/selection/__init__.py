"""Choosing between models: cross-validation, `auto`, smaller forests, the benchmark's sweep."""
