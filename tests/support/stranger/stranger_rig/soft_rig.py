"""Files of the rig: a first line `#soft-rig RATE_HZ`, then rows of position, mm, and force, N."""

from pathlib import Path

import numpy as np

from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.formats.file_format import FileFormat, FileRequest
from springpot.trainer.recordings.formats.raw_channels import RawChannels


def read_soft_rig(path: Path, request: FileRequest) -> tuple[list[RawChannels], str]:
    """Read one recording. Raises DataError for a damaged file, UsageError for columns."""
    if request.columns:
        raise UsageError(f"{path}: a soft rig has one order of columns: leave --map out")
    with path.open(encoding="utf-8") as file:
        try:
            rate_hz = float(file.readline().split()[1])
            position_mm, force_n = np.loadtxt(file, ndmin=2).T
        except (ValueError, IndexError) as error:
            raise DataError(f"{path}: {error}: give a rate, then two numbers a row") from None
    raw = RawChannels(
        name=path.stem,
        time_s=np.arange(len(force_n)) / rate_hz,
        position_m=1e-3 * position_mm,
        force_n=force_n,
        time_digit_s=0.0,
        source=str(path),
        line_of=lambda sample: sample + 2,
    )
    return [raw], f"soft rig at {rate_hz:g} Hz, position in mm, force in N"


SOFT_RIG = FileFormat("soft rig", lambda start: start.startswith(b"#soft-rig"), read_soft_rig)
