"""Checksums of an emitted folder: what was changed there is never replaced, nor run unnoticed."""

import hashlib
import json
import warnings
from collections.abc import Collection, Sequence
from pathlib import Path

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.files import read_bounded

CHECKSUMS = "from/files.json"
# What validation, report and a build by hand put beside it.
_WRITTEN_LATER = {"validation", "report.html", "example", "firmware.elf"}
# For a build by hand, and its user's to change: springpot compiles neither these nor with these.
_MEANT_TO_EDIT = {"main.c", "Makefile"}
# What a build reads. A header more would be taken in the place of a system's.
_READ = ("*.h", "*.gch", "manifest.json", "from/*")
_MAX_BYTES = 1 << 30


def require_replaceable(folder: Path, yours: Collection[str] = ()) -> None:
    """Refuse to replace a folder in which anything is not as springpot wrote it.

    yours: names of files that their user may have changed.
    """
    if folder.is_file():
        raise UsageError(f"{folder}: is a file: give a folder")
    if folder.exists() and any(folder.iterdir()):
        if not (folder / CHECKSUMS).exists():
            raise UsageError(
                f"{folder}: holds files that springpot did not emit: give an empty or new folder"
            )
        known = _read_checksums(folder)
        for file in sorted(folder.rglob("*")):
            name = file.relative_to(folder).as_posix()
            if (
                file.is_dir()
                or name == CHECKSUMS
                or name.split("/", maxsplit=1)[0] in _WRITTEN_LATER
            ):
                continue
            if name not in yours and known.get(name) != _digest(file):
                raise UsageError(
                    f"{file}: not as springpot emitted it: move your changes out of {folder}, or "
                    "give another folder"
                )
    folder.parent.mkdir(parents=True, exist_ok=True)


def edited_files(folder: Path) -> tuple[str, ...]:
    """Return names of the files that a build takes and that are not as emitted, with a warning."""
    known = _read_checksums(folder)
    changed = {name for name, digest in known.items() if _digest(folder / name) != digest}
    read = {file for pattern in _READ for file in folder.rglob(pattern)}
    read |= {file.with_suffix(".c") for file in read if file.with_suffix(".c").exists()}
    read |= {file for file in folder.rglob("*") if file.is_symlink() and file.is_dir()}
    more = {file.relative_to(folder).as_posix() for file in read} - known.keys() - {CHECKSUMS}
    edited = [name for name in changed | more if name.split("/")[0] not in _MEANT_TO_EDIT]
    edited = sorted(edited) if known else [CHECKSUMS]
    if edited:
        others = f" (and {len(edited) - 1} more)" if len(edited) > 1 else ""
        what = "not as springpot emitted it" if (folder / edited[0]).exists() else "missing"
        line = f"{folder / edited[0]}: {what}{others}: if you did not change it, emit again"
        warnings.warn(line, UserWarning, stacklevel=3)
    return tuple(edited)


def is_edited(folder: Path, name: str) -> bool:
    """Return True if a file exists and is not as springpot wrote it."""
    return (folder / name).exists() and _read_checksums(folder).get(name) != _digest(folder / name)


def edited_hash(emitted: str, folder: Path, edited: Sequence[str]) -> str:
    """Return the hash of an emission with its edits, so that logs tell one from the other."""
    if not edited:
        return emitted
    digest = hashlib.sha256(emitted.encode())
    for name in edited:
        digest.update(f"{name} {_digest(folder / name)}\n".encode())
    return digest.hexdigest()


def write_checksums(folder: Path) -> None:
    """SHA-256 of every file of a new emission or firmware, in the folder itself."""
    (folder / CHECKSUMS).parent.mkdir(exist_ok=True)
    files = [file for file in folder.rglob("*") if file.is_file() and file != folder / CHECKSUMS]
    checksums = {file.relative_to(folder).as_posix(): _digest(file) for file in files}
    (folder / CHECKSUMS).write_text(
        json.dumps(checksums, indent=2, sort_keys=True) + "\n", encoding="utf-8", newline="\n"
    )


def _read_checksums(folder: Path) -> dict[str, str]:
    """Return name -> digest; nothing where the list is missing or no list."""
    try:
        known = json.loads(read_bounded(folder / CHECKSUMS, _MAX_BYTES, "list of checksums"))
    except (OSError, ValueError, DataError):
        return {}
    fits = isinstance(known, dict) and all(name.isprintable() for name in known)
    return known if fits else {}


def _digest(file: Path) -> str:
    """SHA-256 of a file; nothing where there is none to be read."""
    try:
        return hashlib.sha256(read_bounded(file, _MAX_BYTES, "file of an emission")).hexdigest()
    except (OSError, ValueError, DataError):
        return ""
