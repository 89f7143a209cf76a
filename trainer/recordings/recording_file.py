"""Files of recordings: HDF5 with a checksum behind it, or what a crash left of one."""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path

from springpot.codegen.atomic_write import written_aside
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.regular_file import given_path, require_regular
from springpot.trainer.recordings.journal_reader import (
    JOURNAL_SUFFIX,
    is_being_recorded,
    journal_of,
    read_journal,
)
from springpot.trainer.recordings.notices import caution
from springpot.trainer.recordings.recording import RECORDING_SUFFIX, Recording
from springpot.trainer.recordings.recording_hdf5 import as_hdf5, read_hdf5
from springpot.trainer.recordings.recording_process import read_unsealed

# Behind the HDF5 file stand these bytes and its SHA-256: the library itself can crash or hang on a
# flipped byte. HDF5 readers ignore them; a program that edits the file cuts them off.
_CHECKSUM = b"springpot sha256"
_GIVE = "give a recording; `springpot import` makes them"
_CHECKSUM_BYTES = len(_CHECKSUM) + hashlib.sha256().digest_size


File = str | PathLike[str]
Recordings = Recording | File | Iterable[Recording | File]  # what a person may give


def given_recordings(given: Recordings) -> list[Recording]:
    """One recording or several; text and paths are files or folders of them. Raises UsageError."""
    several = [given] if isinstance(given, Recording | str | PathLike) else given
    # The items of a table are names of its columns, those of an array its rows.
    table = isinstance(several, Mapping) or hasattr(several, "columns") or hasattr(several, "shape")
    if table or not isinstance(several, Iterable):
        raise _no_recording(given)
    found: list[Recording] = []
    for one in several:
        if isinstance(one, Recording):
            found.append(one)
        elif isinstance(one, str | PathLike):
            found += read_recordings([given_path(one)])
        else:
            raise _no_recording(one)
    return found


def _no_recording(given: object) -> UsageError:
    """Say of what was given in place of a recording how it becomes one."""
    kind = type(given).__name__
    if isinstance(given, Mapping) and all(isinstance(one, Recording) for one in given.values()):
        return UsageError(f"{kind} of recordings: give a list of them, list(recordings.values())")
    if isinstance(given, Mapping) or hasattr(given, "columns"):
        return UsageError(f"{kind} is no recording: Recording.from_frame makes one of a table")
    if hasattr(given, "shape"):
        return UsageError(
            f"{kind} is no recording: Recording(name, position_m, force_n, dt_s) makes one"
        )
    return UsageError(f"{kind} is no recording: read_recordings reads files and folders")


def write_recording(path: Path, recording: Recording, *, overwrite: bool = True) -> None:
    """Write a recording aside, sync and rename it to `path`: a reader never sees half a file.

    overwrite: False raises FileExistsError if `path` exists, even if it came meanwhile.
    Raises OSError, and leaves nothing aside, if that fails.
    """
    content = as_hdf5(recording)
    checksum = _CHECKSUM + hashlib.sha256(content).digest()
    with written_aside(path, overwrite=overwrite, durable=True) as aside, aside.open("wb") as file:
        file.write(content)
        file.write(checksum)


def read_recording(path: Path) -> Recording:
    """Read one recording, or recover what a crash left of it and say so.

    path: an HDF5 file, or a journal. Raises DataError with the file's name where it cannot be used.
    """
    if path.suffix == JOURNAL_SUFFIX:
        return _recovered(path)
    if not path.exists() and path.suffix == RECORDING_SUFFIX and journal_of(path).exists():
        return _recovered(journal_of(path))
    # Only a file as springpot wrote it is shown to the HDF5 library here.
    if _is_sealed(path):
        return read_hdf5(path)
    from springpot.codegen.model.model_file import MODEL_SUFFIX

    if path.suffix == MODEL_SUFFIX:
        raise DataError(f"{path}: a model, not a recording: {_GIVE}")
    return read_unsealed(path)


def _recovered(journal: Path) -> Recording:
    if not journal.exists():
        raise DataError(f"{journal}: no such file: {_GIVE}")
    if is_being_recorded(journal):
        raise DataError(f"{journal}: still being recorded: wait until that ends")
    found = read_journal(journal)
    message = (
        f"recovered {found.recording.duration_s:.3f} s from the journal of a recording that was "
        f"interrupted{found.lost}"
    )
    caution(f"{journal}: {message}")
    return replace(found.recording, details={**found.recording.details, "recovered": message})


def _is_sealed(path: Path) -> bool:
    """Whether the checksum is there and right. Raises DataError where it is there and wrong."""
    try:
        require_regular(path)
        return _verify_checksum(path)
    except FileNotFoundError:
        raise DataError(f"{path}: no such file: {_GIVE}") from None
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}): {_GIVE}") from None


def has_checksum(path: Path) -> bool:
    """Return whether a file is a recording that springpot wrote and nobody edited since."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - _CHECKSUM_BYTES))
        return file.read().startswith(_CHECKSUM)


def _verify_checksum(path: Path) -> bool:
    """Compare the bytes with the checksum after them; False: a file that others edited has none."""
    content, checksum = path.stat().st_size - _CHECKSUM_BYTES, b""
    with path.open("rb") as file:
        if content > 0:
            file.seek(content)
            checksum = file.read()
        if not checksum.startswith(_CHECKSUM):
            return False
        digest = hashlib.sha256()
        file.seek(0)
        while content > 0:
            chunk = file.read(min(content, 1 << 20))
            digest.update(chunk)
            content -= len(chunk)
    if checksum != _CHECKSUM + digest.digest():
        raise DataError(f"{path}: damaged, its bytes differ from those written: import it again")
    return True


def read_recordings(paths: Iterable[Path]) -> list[Recording]:
    """Read files and folders of recordings, folders in the order of their files' names.

    Journals that a crash left in a folder are recovered.
    """
    return [read_recording(file) for file in recording_files(paths)]


def recording_files(paths: Iterable[Path]) -> list[Path]:
    """Return the files behind arguments that are files and folders of recordings.

    Raises DataError for a folder without any.
    """
    files: list[Path] = []
    for path in paths:
        files += _in_folder(path) if path.is_dir() else [path]
    return files


def _in_folder(folder: Path) -> list[Path]:
    files = list(folder.glob(f"*{RECORDING_SUFFIX}"))
    for journal in folder.glob(f"*{JOURNAL_SUFFIX}"):
        finished = journal.with_name(journal.name.removesuffix(JOURNAL_SUFFIX) + RECORDING_SUFFIX)
        if finished in files:
            caution(
                f"{journal}: left out, its recording was finished in {finished.name}: remove it"
            )
        else:
            files.append(journal)
    if not files:
        raise DataError(
            f"{folder}: no {RECORDING_SUFFIX} file in this folder: `springpot import` makes them"
        )
    return sorted(files)
