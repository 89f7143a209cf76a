"""Lines that a reader says beside its result: what was recovered, left out, assumed."""

import sys


def notice(line: str) -> None:
    """Print one line on standard error, where it cannot end up in a command's result."""
    print(f"springpot: {line}", file=sys.stderr, flush=True)
