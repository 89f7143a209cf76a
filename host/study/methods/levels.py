"""Adaptive methods: which pair of a series comes next, and which series have ended."""

from collections.abc import Sequence

from springpot.codegen.errors import UsageError
from springpot.host.study.definition import Study

History = Sequence[tuple[int, bool]]  # pair, and whether the answer was correct


def next_pair(study: Study, series: str, _history: History) -> int:
    """Index of the pair to show."""
    raise UsageError(f"{study.method}: not there yet ({series})")


def ended_series(study: Study, _history: History) -> set[str]:
    """Series that need no more trials."""
    raise UsageError(f"{study.method}: not there yet")
