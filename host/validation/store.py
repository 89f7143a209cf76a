"""The last validation of an emitted folder, kept beside its C for the report."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.atomic_write import write_file, written_aside
from springpot.codegen.errors import DataError
from springpot.codegen.short_repr import short_repr
from springpot.codegen.types import JsonObject
from springpot.host.native.compiler import machine_metadata
from springpot.host.validation.validation import Validation

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
    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class Stored:
    """What the report reads: metadata (result, machine, recordings), and samples."""

    metadata: JsonObject
    series: tuple[Series, ...]
    __repr__ = short_repr


def series_of(validation: Validation) -> list[Series]:
    """Return each recording beside the forces of the C."""
    pairs = zip(validation.recordings, validation.predicted_n, strict=True)
    return [Series(r.name, r.dt_s, r.position_m, r.force_n, force_n) for r, force_n in pairs]


def store_validation(folder: Path, validation: Validation) -> None:
    """Write folder/validation, replacing an earlier one."""
    target = folder / _FOLDER
    target.mkdir(exist_ok=True)
    metadata = {
        "result": validation.as_dict(),
        "machine": machine_metadata(),
        "recordings": [
            {"name": rec.name, "dt_s": rec.dt_s, "source": rec.source, "hash": rec.content_hash}
            for rec in validation.recordings
        ],
    }
    arrays: dict[str, NDArray[np.float64]] = {}
    for i, series in enumerate(series_of(validation)):
        arrays |= {f"{name}_{i}": getattr(series, name) for name in _ARRAYS}
    with written_aside(target / _SERIES) as aside, aside.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)
    write_file(target / _METADATA, (json.dumps(metadata, indent=2) + "\n").encode())


def read_validation(folder: Path) -> Stored:
    """Read folder/validation. Raises DataError where there is none."""
    target = folder / _FOLDER
    try:
        metadata = json.loads((target / _METADATA).read_text())
        metadata["result"]["clamped_low"]  # which an older validation lacks
        with np.load(target / _SERIES, allow_pickle=False) as stored:
            series = tuple(
                Series(rec["name"], rec["dt_s"], *(stored[f"{name}_{i}"] for name in _ARRAYS))
                for i, rec in enumerate(metadata["recordings"])
            )
            return Stored(metadata=metadata, series=series)
    except (OSError, ValueError, KeyError):
        raise DataError(
            f"{folder}: no validation to report: run `springpot validate {folder} --recording ...`"
        ) from None
