"""Recordings that a person gives: in memory, as files, or as folders of them."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.files import parse_path, require_regular
from springpot.codegen.messages import caution
from springpot.trainer.recordings.hdf5_file import GIVE_RECORDING, read_hdf5
from springpot.trainer.recordings.journal import JOURNAL_SUFFIX, journal_path, read_journal
from springpot.trainer.recordings.recording import RECORDING_SUFFIX, Recording

File = str | PathLike[str]
Recordings = Recording | File | Iterable[Recording | File]  # what a person may give


def resolve_recordings(given: Recordings) -> list[Recording]:
    """One recording or several; text and paths are files or folders of them. Raises UsageError."""
    several = [given] if isinstance(given, Recording | str | PathLike) else given
    recordings: list[Recording] = []
    if isinstance(several, Mapping) or not isinstance(several, Iterable):
        raise _not_a_recording_error(given)
    # The items of a table are names of its columns, those of an array its rows: neither is taken.
    for one in [given] if hasattr(several, "columns") or hasattr(several, "shape") else several:
        if isinstance(one, Recording):
            recordings.append(one)
        elif isinstance(one, str | PathLike):
            recordings += read_recordings([parse_path(one)])
        else:
            raise _not_a_recording_error(one)
    return recordings


def _not_a_recording_error(given: object) -> UsageError:
    return UsageError(
        f"{type(given).__name__} is no recording: give recordings, or files and folders as "
        "read_recordings does; list(recordings.values()) of a dict, Recording.from_frame of a "
        "table, Recording(name, position_m, force_n, dt_s) of arrays"
    )


def read_recording(path: Path) -> Recording:
    """Read one recording, or recover what a crash left of it and say so.

    path: an HDF5 file, or a journal. Raises DataError with the file's name if it cannot be used.
    """
    journal = journal_path(path)
    if not (path.exists() or journal.exists()):
        raise DataError(f"{path}: no such file: {GIVE_RECORDING}")
    if path.suffix == JOURNAL_SUFFIX or not path.exists():
        recording, lost = read_journal(journal)
        whole_s = f"{recording.duration_s:.3f} s"
        message = f"recovered {whole_s} from the journal of an interrupted recording{lost}"
        caution(f"{journal}: {message}")
        return replace(recording, details={**recording.details, "recovered": message})
    try:
        require_regular(path)
        return read_hdf5(path)
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}): {GIVE_RECORDING}") from None


def read_recordings(paths: Iterable[Path]) -> list[Recording]:
    """Read files and folders of recordings, folders in the order of their files' names.

    Journals that a crash left in a folder are recovered. Raises DataError for an empty folder.
    """
    files: list[Path] = []
    for path in paths:
        files += _list_folder(path) if path.is_dir() else [path]
    return [read_recording(file) for file in files]


def _list_folder(folder: Path) -> list[Path]:
    """Return a folder's recordings and unfinished journals, sorted; DataError if there are none."""
    files = list(folder.glob(f"*{RECORDING_SUFFIX}"))
    for journal in folder.glob(f"*{JOURNAL_SUFFIX}"):
        finished = journal.with_suffix(RECORDING_SUFFIX)
        if finished in files:
            caution(f"{journal}: left out, {finished.name} is this recording, finished: remove it")
        else:
            files.append(journal)
    if not files:
        raise DataError(
            f"{folder}: no {RECORDING_SUFFIX} file in this folder: `springpot import` makes them"
        )
    return sorted(files)
