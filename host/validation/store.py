"""The last validation of an emitted folder, kept beside its C for the report."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.atomic_write import write_file, written_aside
from springpot.codegen.errors import DataError
from springpot.host.native.machine import machine_metadata
from springpot.host.validation.validation import Validation
from springpot.trainer.recordings.recording import Recording

_FOLDER = "validation"
_METADATA = "result.json"
_SERIES = "series.npz"
_ARRAYS = ("position_m", "measured_n", "predicted_n")  # of a recording


@dataclass(frozen=True, eq=False)
class Series:
    """One validated recording: time step, and three arrays of shape (n,)."""

    name: str
    dt_s: float
    position_m: NDArray[np.float64]
    measured_n: NDArray[np.float64]
    predicted_n: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stored:
    """What the report reads: metadata (result, machine, recordings), samples, paced tick times."""

    metadata: dict[str, Any]
    series: tuple[Series, ...]
    tick_ns: NDArray[np.float64]


def store_validation(folder: Path, validation: Validation, recordings: Sequence[Recording]) -> None:
    """Write folder/validation, replacing an earlier one."""
    target = folder / _FOLDER
    target.mkdir(exist_ok=True)
    metadata = {
        "result": validation.as_dict(),
        "machine": machine_metadata(),
        "recordings": [
            {"name": rec.name, "dt_s": rec.dt_s, "source": rec.source, "hash": rec.content_hash}
            for rec in recordings
        ],
    }
    arrays = {"tick_ns": validation.ticks.paced_ns}
    for i, (rec, predicted_n) in enumerate(zip(recordings, validation.predicted_n, strict=True)):
        samples = (rec.position_m, rec.force_n, predicted_n)
        arrays |= {f"{name}_{i}": values for name, values in zip(_ARRAYS, samples, strict=True)}
    with written_aside(target / _SERIES) as aside, aside.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)
    write_file(target / _METADATA, (json.dumps(metadata, indent=2) + "\n").encode())


def read_validation(folder: Path) -> Stored:
    """Read folder/validation. Raises DataError where there is none."""
    target = folder / _FOLDER
    try:
        metadata = json.loads((target / _METADATA).read_text())
        with np.load(target / _SERIES, allow_pickle=False) as stored:
            series = tuple(
                Series(rec["name"], rec["dt_s"], *(stored[f"{name}_{i}"] for name in _ARRAYS))
                for i, rec in enumerate(metadata["recordings"])
            )
            return Stored(metadata=metadata, series=series, tick_ns=stored["tick_ns"])
    except (OSError, ValueError, KeyError):
        raise DataError(
            f"{folder}: no validation to report: run `springpot validate {folder} --recording ...`"
        ) from None
