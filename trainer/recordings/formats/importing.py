"""Files from outside -> recordings: chooses the reader by what is in a file.

All files of one object together are on one surface, and may be one session.
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.files import require_regular
from springpot.codegen.messages import short_repr, with_progress
from springpot.trainer.recordings.conditioning import Conditioning, align_surfaces, condition
from springpot.trainer.recordings.formats.arrays import frame_channels, read_arrays
from springpot.trainer.recordings.formats.column_map import ColumnMap, DecimalMark, FileRequest
from springpot.trainer.recordings.formats.csv_file import read_csv
from springpot.trainer.recordings.formats.csv_layout import NoRecordingError
from springpot.trainer.recordings.formats.sampling import RawChannels, to_recording
from springpot.trainer.recordings.formats.units import factor_to_si, split_factor
from springpot.trainer.recordings.hdf5_file import is_recording
from springpot.trainer.recordings.journal import JOURNAL_SUFFIX
from springpot.trainer.recordings.quality.finding import join_refusals
from springpot.trainer.recordings.recording import (
    FRAME_SOURCE,
    Recording,
    Zero,
    parse_zero,
    safe_recording_name,
)
from springpot.trainer.recordings.recording_file import read_recording

_NUMBER_STARTS = set("+-.0123456789")  # a number
_START_BYTES = 520  # a user block of HDF5 is 512 of them
_HDF5, _MAT5, _MAT73 = b"\x89HDF\r\n\x1a\n", b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file"
# Files of a folder that may be recordings; others are named one by one.
_RECORDING_SUFFIXES = {
    ".csv", ".tsv", ".tab", ".txt", ".dat", ".asc", ".tra", ".lvm", ".mat", ".h5",
    ".hdf5", ".journal",
}  # fmt: skip
_MAX_LISTED_FILES = 12  # files in a line


@dataclass(frozen=True)
class ImportOptions:
    """Hold what only some files need.

    decimal: what marks decimals in a CSV file, None: guessed.
    conditioning: delays, mass, tare and contact point.
    place_m: where the object was pressed, x and y, or the headers of the two columns that say it;
    None: what the file says.

    >>> ImportOptions(decimal="comma")
    ImportOptions(decimal='comma')
    """

    decimal: DecimalMark | None = None
    conditioning: Conditioning = field(default_factory=Conditioning)
    place_m: tuple[float, float] | tuple[str, str] | None = None
    __repr__ = short_repr


def import_file(
    path: Path,
    mapping: ColumnMap | None = None,
    zero: Zero | None = "none",
    resample_hz: float | None = None,
    options: ImportOptions | None = None,
) -> tuple[Recording, str]:
    """Read the recording of one file, in SI units, and how the file was understood, in a line.

    mapping: columns and units; what it leaves out is guessed from the headers.
    zero: subtract nothing, the first sample or the smallest one, of each channel.
    resample_hz: rate for linear interpolation; None refuses uneven steps before the file's end.
    Raises DataError naming file and row, UsageError for a map where the file needs none.
    """
    if resample_hz is not None and not 0.0 < resample_hz < np.inf:
        raise UsageError(f"--resample-hz: {resample_hz} is not a rate: give a number above 0")
    options, zero = options or ImportOptions(), parse_zero(zero)
    x, y = options.place_m or (None, None)  # metres, or the names of two columns
    if path.is_dir():
        raise DataError(f"{path}: a folder: name its files, such as {path}/*.csv")
    try:
        require_regular(path)
        is_own_format = path.suffix == JOURNAL_SUFFIX or is_recording(path)
        if is_own_format and (mapping or zero != "none" or resample_hz is not None):
            raise UsageError(
                f"{path}: is a springpot recording already: only --contact-force, --tare, "
                "--mass-kg, delays, --align and --place apply to it"
            )
        if is_own_format:
            recording, notes = read_recording(path), ["a springpot recording"]
        else:
            request = FileRequest(mapping or {}, options.decimal)
            if isinstance(x, str) and isinstance(y, str):
                request = replace(request, place=(x, y))
            raw = _read_file(path, request)
            recording = to_recording(raw, safe_recording_name(path.stem), resample_hz)
            notes = [raw.details["columns"], *recording.details["notes"]]
    except OSError as error:
        raise DataError(f"{path}: {error.strerror}: give a file that can be read") from None
    recording, messages = condition(recording, options.conditioning, zero)
    if isinstance(x, float | int) and isinstance(y, float | int):
        recording = replace(recording, place_x_m=float(x), place_y_m=float(y))
    elif options.place_m is not None and recording.place_m is None:
        raise DataError(f"{path}: no header has columns {x!r} and {y!r}: correct --place")
    return recording, f"{path}: {'; '.join([*notes, *messages])}"


def recording_from_frame(
    frame: Any,
    name: str,
    *,
    time: Hashable = "time_s",
    position: Hashable = "position_m",
    force: Hashable = "force_n",
    zero: Zero | None = "none",
    resample_hz: float | None = None,
    conditioning: Conditioning | None = None,
) -> Recording:
    """Read three columns of a table: `Recording.from_frame`, where the arguments are described."""
    raw = frame_channels(frame, name, {"time": time, "position": position, "force": force})
    recording = replace(to_recording(raw, name, resample_hz), source=FRAME_SOURCE)
    return condition(recording, conditioning or Conditioning(), parse_zero(zero))[0]


def _read_file(path: Path, request: FileRequest) -> RawChannels:
    """Read a file of other programs: arrays by how it begins, else text."""
    with path.open("rb") as file:
        start = file.read(_START_BYTES)
    if start.startswith(_MAT5):
        return read_arrays(path, "mat", request)
    if start.startswith((_HDF5, _MAT73)) or _HDF5 in start[512:]:
        return read_arrays(path, "hdf5", request)
    return read_csv(path, request)


def parse_place_option(text: str) -> tuple[float, float] | tuple[str, str]:
    """Read the text of `--place`: a place as `parse_place`, or two headers, such as x_mm,y_mm."""
    x, _, y = (part.strip() for part in text.partition(","))
    headers = x[:1].isalpha() and y[:1].isalpha() and "," not in y
    return (x, y) if headers else parse_place(text)


def parse_place(text: str) -> tuple[float, float]:
    """Read x and y, m, from a text such as 5,10mm or 5mm,1cm; UsageError for anything else."""
    x, _, y = text.partition(",")
    (x_size, x_unit), (y_size, unit) = split_factor(x), split_factor(y)
    if not {x.strip()[:1], y.strip()[:1]} <= _NUMBER_STARTS:
        raise UsageError(f"--place {text}: give x and y with a unit, such as 5,10mm")
    try:
        return (
            x_size * factor_to_si(x_unit or unit, "position", f"--place {text}"),
            y_size * factor_to_si(unit, "position", f"--place {text}"),
        )
    except DataError as error:
        raise UsageError(str(error)) from None


def join_session(recordings: Sequence[Recording], rest_s: float) -> list[Recording]:
    """The recordings as presses of one object, in this order, so long apart, s.

    Raises UsageError for a time below 0.
    """
    if not 0.0 <= rest_s < np.inf:
        raise UsageError(f"--rest-s: {rest_s} is no time between presses: give seconds from 0 on")
    joined, start_s = [], 0.0
    for recording in recordings:
        name = f"{recordings[0].name} and {len(recordings) - 1} more"
        joined.append(replace(recording, session=name, start_s=start_s))
        start_s += recording.duration_s + rest_s
    return joined


def import_set(
    paths: Sequence[Path],
    mapping: ColumnMap | None = None,
    zero: Zero | None = "none",
    resample_hz: float | None = None,
    options: ImportOptions | None = None,
    rest_s: float | None = None,
) -> tuple[list[Recording], dict[Path, str], list[str]]:
    """Read files, and folders of them, in SI units; arguments as of `import_file`.

    A file that was named is a recording, or refused; of a folder, what is none is left out.
    rest_s: the files are presses of one object in this order, so long apart, s.
    Return the recordings, how each file was understood, and lines on what they share.
    """
    files, notes = _list_files(paths)
    recordings: list[Recording] = []
    guesses: dict[Path, str] = {}
    others, refused = list[NoRecordingError](), list[DataError]()
    for file in with_progress(files, "reading"):
        try:
            recording, guesses[file] = import_file(file, mapping, zero, resample_hz, options)
        except NoRecordingError as error:
            if file in paths:
                raise
            others.append(error)
            continue
        except DataError as error:
            refused.append(error)
            continue
        recordings.append(recording)
    if refused:
        raise join_refusals(map(str, refused))
    if others and not recordings:
        raise others[0]
    rates = {f"{recording.rate_hz:.5g}": recording.name for recording in recordings}
    if len(rates) > 1:
        shown = ", ".join(f"{hz} Hz ({name})" for hz, name in rates.items())
        notes.append(f"rates differ, and a model has one: {shown}: import with --resample-hz RATE")
    notes += [f"left out, no recording: {other}" for other in others]
    recordings, surface = align_surfaces(recordings, (options or ImportOptions()).conditioning)
    if rest_s is not None:
        recordings = join_session(recordings, rest_s)
    return recordings, guesses, [*notes, surface] if surface else notes


def _list_files(paths: Sequence[Path]) -> tuple[list[Path], list[str]]:
    """Files, with those of each folder that may be recordings; a line names the others.

    Raises UsageError for a folder without recordings.
    """
    files, notes = list[Path](), list[str]()
    for path in paths:
        if not path.is_dir():
            files.append(path)
            continue
        listed = sorted(f for f in path.iterdir() if f.is_file() and not f.name.startswith("."))
        usable = [file for file in listed if file.suffix.casefold() in _RECORDING_SUFFIXES]
        if not usable:
            kinds = ", ".join(sorted(_RECORDING_SUFFIXES))
            raise UsageError(f"{path}: no file in this folder ends in {kinds}: name the files")
        if others := [file.name for file in listed if file not in usable]:
            more = (
                f" and {len(others) - _MAX_LISTED_FILES} more" if others[_MAX_LISTED_FILES:] else ""
            )
            notes.append(
                f"{path}: left out, no recordings: {', '.join(others[:_MAX_LISTED_FILES])}{more}"
            )
        files += usable
    return files, notes
