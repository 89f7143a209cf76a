"""Files from outside -> recordings: chooses the reader by what is in the file."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from springpot.runtime_c.errors import DataError, UsageError
from springpot.trainer.formats.column_map import ColumnMap
from springpot.trainer.formats.csv_text import read_csv
from springpot.trainer.formats.mach1 import MAGIC, read_mach1
from springpot.trainer.formats.sampling import RawChannels, to_recording
from springpot.trainer.recording import Recording, Zero

_BYTE_ORDER_MARK = b"\xef\xbb\xbf"
_UNSAFE = re.compile(r"[^\w.+-]+")


@dataclass(frozen=True)
class ImportResult:
    """What one file gave, and one line that says how it was understood."""

    recordings: list[Recording]
    guess: str


def import_file(
    path: Path, mapping: ColumnMap | None, zero: Zero, resample_hz: float | None
) -> ImportResult:
    """Read every recording of one file, in SI units.

    mapping: columns and units; what it leaves out is guessed from the headers.
    zero: subtract nothing, the first sample or the smallest one, of each channel.
    resample_hz: rate for linear interpolation; None refuses uneven steps.
    Raises DataError naming file and row, UsageError for a map where the file needs none.
    """
    if resample_hz is not None and not 0.0 < resample_hz < np.inf:
        raise UsageError(f"--resample-hz: {resample_hz} is not a rate: give a number above 0")
    try:
        raws, guess = _read(path, mapping)
    except OSError as error:
        raise DataError(f"{path}: {error.strerror}: give a file that can be read") from None
    names = _unique([raw.name for raw in raws])
    recordings = []
    for raw, name in zip(raws, names, strict=True):
        recording = to_recording(raw, name, zero, resample_hz)
        recordings.append(recording)
        if _pulls(recording):
            guess += (
                f"; note: {name}: force falls as position rises, where pressing should push back: "
                "turn a sign round with a factor in --map (position=COL:-1mm)"
            )
    return ImportResult(recordings, f"{path}: {guess}")


def _read(path: Path, mapping: ColumnMap | None) -> tuple[list[RawChannels], str]:
    with path.open("rb") as file:
        start = file.read(64).removeprefix(_BYTE_ORDER_MARK)
    if not start.startswith(MAGIC):
        raw, guess = read_csv(path, mapping or {}, path.stem)
        return [raw], guess
    if mapping:
        raise UsageError(f"{path}: a Mach-1 file names its own columns: leave out --map")
    return read_mach1(path)


def _unique(names: list[str]) -> list[str]:
    """Make names fit for file systems, with a number behind those that came before."""
    unique: list[str] = []
    for name in names:
        safe = _UNSAFE.sub("_", name).strip("._") or "recording"
        numbered, count = safe, 1
        while numbered in unique:
            count += 1
            numbered = f"{safe}-{count}"
        unique.append(numbered)
    return unique


def _pulls(recording: Recording) -> bool:
    position_m = recording.position_m - np.mean(recording.position_m)
    return float(np.dot(position_m, recording.force_n)) < 0.0
