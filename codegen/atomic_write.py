"""Files and folders that are written aside and renamed into place: nobody sees half of one."""

import os
import secrets
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def written_aside(path: Path, *, overwrite: bool = True, durable: bool = False) -> Iterator[Path]:
    """Yield a file to write beside `path`, which takes that name at the end.

    Where anything fails, `path` is as it was and nothing stays aside. overwrite: False raises
    FileExistsError where `path` exists, even if it came meanwhile. durable: it survives a power
    cut from then on.
    """
    aside = path.with_name(f"{path.name}.{secrets.token_hex(4)}.part")
    try:
        yield aside
        if durable:
            _sync(aside)
        if overwrite:
            aside.replace(path)
        else:
            path.hardlink_to(aside)
    finally:
        aside.unlink(missing_ok=True)
    if durable:
        sync_folder(path.parent)


@contextmanager
def folder_written_aside(folder: Path) -> Iterator[Path]:
    """Yield the name of a folder to make, which replaces `folder` at the end."""
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=f".{folder.name}-") as scratch:
        aside = Path(scratch) / "new"
        yield aside
        if folder.exists():
            folder.rename(Path(scratch) / "old")
        aside.rename(folder)


def write_file(path: Path, content: bytes) -> None:
    """Write a whole file aside and rename it into place."""
    with written_aside(path) as aside:
        aside.write_bytes(content)


def sync_folder(folder: Path) -> None:
    """Make new names in a folder survive a power cut."""
    _sync(folder)


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
