"""Commands that measure kinds of model against each other, and the paper."""

from springpot.console import LazyCommand

_HERE = "springpot.host.wings.evidence.commands"
BENCH = LazyCommand(
    f"{_HERE}.bench:bench",
    "Measure every kind and size of model on your recordings; mark the front; pick.",
    16,
)
REPRODUCE = LazyCommand(
    f"{_HERE}.reproduce:reproduce",
    "Repeat the paper's tables and figures, and say which of its claims hold here.",
    19,
)
