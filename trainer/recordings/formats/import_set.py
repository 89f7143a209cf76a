"""All files of one object at once: what is a recording, on one surface, as one session."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from springpot.codegen.errors import UsageError
from springpot.codegen.messages import counted, short_repr
from springpot.trainer.recordings.conditioning import on_one_surface
from springpot.trainer.recordings.formats.column_map import ColumnMap
from springpot.trainer.recordings.formats.csv_layout import NoRecordingError
from springpot.trainer.recordings.formats.importing import (
    ImportOptions,
    import_file,
    one_session,
)
from springpot.trainer.recordings.recording import Recording, Zero

# Files of a folder that may be recordings; others are named one by one.
_OF_RECORDINGS = {
    ".csv", ".tsv", ".tab", ".txt", ".dat", ".asc", ".tra", ".lvm", ".mat", ".h5",
    ".hdf5", ".journal",
}  # fmt: skip
_MAX_NAMED = 12  # files in a line


@dataclass(frozen=True)
class ImportedSet:
    """Recordings of some files, and lines on how each was understood, and on what they share."""

    recordings: list[Recording]
    guesses: dict[Path, str]
    notes: list[str]
    __repr__ = short_repr


def import_set(
    paths: Sequence[Path],
    mapping: ColumnMap | None = None,
    zero: Zero | None = "none",
    resample_hz: float | None = None,
    options: ImportOptions | None = None,
    rest_s: float | None = None,
) -> ImportedSet:
    """Read files, and folders of them, in SI units; arguments as of `import_file`.

    A file that was named is a recording, or refused; of a folder, what is none is left out.
    rest_s: the files are presses of one object in this order, so long apart, s.
    """
    files, notes = _listed(paths)
    recordings: list[Recording] = []
    guesses: dict[Path, str] = {}
    others: list[NoRecordingError] = []
    for file in counted(files, "reading"):
        try:
            found = import_file(file, mapping, zero, resample_hz, options)
        except NoRecordingError as error:
            if file in paths:
                raise
            others.append(error)
            continue
        recordings += found.recordings
        guesses[file] = found.guess
    if others and not recordings:
        raise others[0]
    notes += [f"left out, no recording: {other}" for other in others]
    recordings, surface = on_one_surface(recordings, (options or ImportOptions()).conditioning)
    if rest_s is not None:
        recordings = one_session(recordings, rest_s)
    return ImportedSet(recordings, guesses, [*notes, surface] if surface else notes)


def _listed(paths: Sequence[Path]) -> tuple[list[Path], list[str]]:
    """Files, with those of each folder that may be recordings; a line names the others.

    Raises UsageError for a folder without recordings.
    """
    found, notes = list[Path](), list[str]()
    for path in paths:
        if not path.is_dir():
            found.append(path)
            continue
        there = sorted(f for f in path.iterdir() if f.is_file() and not f.name.startswith("."))
        inside = [file for file in there if file.suffix.casefold() in _OF_RECORDINGS]
        if not inside:
            kinds = ", ".join(sorted(_OF_RECORDINGS))
            raise UsageError(f"{path}: no file in this folder ends in {kinds}: name the files")
        if others := [file.name for file in there if file not in inside]:
            more = f" and {len(others) - _MAX_NAMED} more" if others[_MAX_NAMED:] else ""
            notes.append(f"{path}: left out, no recordings: {', '.join(others[:_MAX_NAMED])}{more}")
        found += inside
    return found, notes
