"""Text that is imported from a file, and the line that refuses it."""

from pathlib import Path

import numpy as np
import pytest

from springpot import Recording
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import parse_map
from springpot.trainer.recordings.formats.importing import import_file

GOOD = "time_s,position_m,force_N\n0.000,0,0\n0.001,0.1,1\n0.002,0.2,2\n0.003,0.3,3\n0.004,0.4,4\n"


def load(
    folder: Path, text: str | bytes, mapping: str = "", resample_hz: float | None = None
) -> Recording:
    """The recording of a text."""
    file = folder / "press 1.csv"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    columns = parse_map(mapping) if mapping else None
    recording, guess = import_file(file, columns, resample_hz=resample_hz)
    assert str(file) in guess
    return recording


def refusal(folder: Path, text: str | bytes, mapping: str = "", rate: float | None = None) -> str:
    """One line that names the file."""
    with pytest.raises(DataError) as error:
        load(folder, text, mapping, rate)
    message = str(error.value)
    assert "press 1.csv" in message and "\n" not in message
    return message


def rows(time_s: list[float] | np.ndarray, form: str = "%.6f") -> str:
    """A table of such stamps: position and force grow row by row."""
    lines = [f"{form % t},{k * 1e-4!r},{k * 0.1!r}" for k, t in enumerate(time_s)]
    return "\n".join(["time_s,position_m,force_N", *lines]) + "\n"
