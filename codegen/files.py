"""Files: those that are given, and those that are written aside and renamed into place."""

import os
import secrets
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from os import PathLike
from pathlib import Path

from springpot.codegen.errors import DataError, UsageError


def parse_path(path: str | PathLike[str]) -> Path:
    """Return the path that a person gave. Raises UsageError for "", which Path takes for "."."""
    if path == "":
        raise UsageError('an empty path: give a file or folder; "." is the current folder')
    return Path(path)


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


@contextmanager
def atomic_write(path: Path, *, overwrite: bool = True, durable: bool = False) -> Iterator[Path]:
    """Yield a file to write beside `path`, which takes that name at the end.

    Where anything fails, `path` is as it was and nothing stays aside. overwrite: False raises
    FileExistsError where `path` exists, even if it came meanwhile. durable: it survives a power
    cut from then on.
    """
    aside = path.with_name(f"{path.name}.{secrets.token_hex(4)}.part")
    try:
        yield aside
        if durable:
            sync_path(aside)
        if overwrite:
            aside.replace(path)
        else:
            path.hardlink_to(aside)
    except OSError as error:
        _set_filename(error, aside, path)
        raise
    finally:
        with suppress(NotADirectoryError):
            aside.unlink(missing_ok=True)
    if durable:
        sync_path(path.parent)


@contextmanager
def write_folder_atomically(folder: Path) -> Iterator[Path]:
    """Yield the name of a folder to make, which replaces `folder` at the end."""
    parent, prefix = folder.parent, f".{folder.name}-"
    try:
        with tempfile.TemporaryDirectory(dir=parent, prefix=prefix) as scratch:
            aside = Path(scratch) / "new"
            yield aside
            if folder.exists():
                folder.rename(Path(scratch) / "old")
            aside.rename(folder)
    except OSError as error:
        _set_filename(error, parent / prefix, folder)
        raise


def _set_filename(error: OSError, aside: Path, path: Path) -> None:
    """Let an error name what was asked for, not what is beside it: a full disk names nothing."""
    if error.filename is None or str(error.filename).startswith(str(aside)):
        error.filename = str(path)


def require_writable(path: Path) -> None:
    """Raise UsageError where no file of that name can be written, its folders not made yet."""
    parent = next(folder for folder in path.absolute().parents if folder.exists())
    if path.is_dir():
        raise UsageError(f"{path}: is a folder: give a file")
    if not parent.is_dir() or not os.access(parent, os.W_OK | os.X_OK):
        raise UsageError(f"{path}: cannot be written in {parent}: choose another place")


def write_file(path: Path, content: bytes) -> None:
    """Write a whole file aside and rename it into place."""
    with atomic_write(path) as aside:
        aside.write_bytes(content)


def sync_path(path: Path) -> None:
    """Make new names in a folder, or the content of a file, survive a power cut."""
    if os.name == "nt" and path.is_dir():  # Windows writes names through
        return
    descriptor = os.open(path, os.O_RDWR if os.name == "nt" else os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
