"""A protocol file that `train --next` writes."""

from collections.abc import Sequence
from pathlib import Path

from springpot import UsageError
from springpot.basics import write_file


def write_lines(path: Path, lines: Sequence[str]) -> None:
    """Write a protocol. Raises UsageError where the file cannot be written."""
    head = "# springpot record --device URL --protocol THIS_FILE.toml --out FOLDER"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_file(path, ("\n".join([head, *lines]) + "\n").encode())
    except OSError as error:
        raise UsageError(
            f"--next {path}: {error.strerror}: give a file that can be written"
        ) from None
