"""Recordings, and what a model predicts along them, as files that other programs read."""

from springpot.console import LazyCommand

_HERE = "springpot.host.wings.export"
EXPORT = LazyCommand(f"{_HERE}.commands:export_", place=6)
PREDICT = LazyCommand(f"{_HERE}.commands:predict", place=7)
