"""Files that are given: by no empty path; only regular ones, for pipes may never end or begin."""

import stat
from os import PathLike
from pathlib import Path

from springpot.codegen.errors import DataError, UsageError

_ALWAYS_BYTES = 1 << 26


def given_path(path: str | PathLike[str]) -> Path:
    """Return the path that a person gave. Raises UsageError for "", which Path takes for "."."""
    if path == "":
        raise UsageError('an empty path: give a file or folder; "." is the current folder')
    return Path(path)


def max_unpacked_bytes(file_bytes: int, ratio: int) -> int:
    """Return how many bytes a file that shrank by `ratio` at most unpacks to, 64 MiB or more."""
    return max(_ALWAYS_BYTES, ratio * file_bytes)


def require_regular(path: Path) -> None:
    """Raise DataError for pipes, devices and sockets, and OSError where there is nothing.

    Looks without opening: opening a pipe waits for whoever writes to it. Folders pass: the
    system refuses to read one as a file.
    """
    mode = path.stat().st_mode
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        raise DataError(
            f"{path}: a pipe or device, not a file: write what comes out of it to a file first"
        )


def read_bounded(path: Path, max_bytes: int, what: str) -> bytes:
    """Content of a regular file. Raises DataError where it is larger: it is not a `what`."""
    require_regular(path)
    with path.open("rb") as file:
        content = file.read(max_bytes + 1)
    if len(content) > max_bytes:
        raise DataError(f"{path}: larger than {max_bytes >> 10} KiB: not a {what}")
    return content
