"""Files of `springpot import`: those of a folder that are recordings, and those it writes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from springpot.codegen.errors import UsageError
from springpot.host.console.output import say
from springpot.trainer.recordings.recording import RECORDING_SUFFIX, Recording
from springpot.trainer.recordings.recording_file import write_recording

# Files of a folder that may be recordings; others are named one by one.
_OF_RECORDINGS = {
    ".csv", ".tsv", ".tab", ".txt", ".dat", ".asc", ".tra", ".lvm", ".mat", ".h5",
    ".hdf5", ".journal",
}  # fmt: skip
_MAX_NAMED = 12  # files in a message


def listed(paths: Sequence[Path]) -> list[Path]:
    """Put in the place of each folder its files that may be recordings, and name the others.

    Raises UsageError for a folder without recordings.
    """
    found: list[Path] = []
    for path in paths:
        if not path.is_dir():
            found.append(path)
            continue
        there = sorted(f for f in path.iterdir() if f.is_file() and not f.name.startswith("."))
        inside = [file for file in there if file.suffix.casefold() in _OF_RECORDINGS]
        if not inside:
            kinds = ", ".join(sorted(_OF_RECORDINGS))
            raise UsageError(f"{path}: no file in this folder ends in {kinds}: name the files")
        others = [file.name for file in there if file not in inside]
        if others:
            more = f" and {len(others) - _MAX_NAMED} more" if others[_MAX_NAMED:] else ""
            say(f"{path}: left out, no recordings: {', '.join(others[:_MAX_NAMED])}{more}")
        found += inside
    return found


def write_all(out: Path, recordings: list[Recording]) -> list[Path]:
    """Write all recordings, or none of them where one file exists already."""
    files: dict[Path, Recording] = {}
    for recording in recordings:
        path = out / f"{recording.name}{RECORDING_SUFFIX}"
        if path in files:
            raise UsageError(
                f"{path}: both {files[path].source} and {recording.source} would be written there: "
                "import them into two folders"
            )
        if path.exists():
            raise UsageError(f"{path}: exists already: remove it or choose another --out")
        files[path] = recording
    try:
        out.mkdir(parents=True, exist_ok=True)
        for path, recording in files.items():
            write_recording(path, recording, overwrite=False)
    except FileExistsError as error:
        raise UsageError(
            f"{error.filename2 or out}: came into being meanwhile: choose another --out"
        ) from None
    except OSError as error:
        raise UsageError(f"{out}: cannot write here ({error}): choose another --out") from None
    return list(files)
