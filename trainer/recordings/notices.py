"""Lines beside the result of a reader: what was recovered, left out, assumed."""

import sys


def notice(line: str) -> None:
    """Print one line on standard error, where it cannot end up in a command's result."""
    print(f"springpot: {line}", file=sys.stderr, flush=True)
