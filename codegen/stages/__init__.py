"""Stages of a model in C: each knows its constants, its state, its lines of glue, its reference."""
