"""`springpot study` and its parts."""

from springpot.console import LazyCommand

_HERE = "springpot.host.wings.study.commands"
STUDY = LazyCommand(
    f"{_HERE}.study:study",
    "Does it feel like the object? Plan a study, run it with people, and report.",
    20,
)
