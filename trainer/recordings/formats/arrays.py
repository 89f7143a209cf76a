"""MAT (v5, v7.3) and HDF5 files of any layout: one array a channel, by name or map."""

import io
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import (
    MAP_EXAMPLE,
    ColumnMap,
    guess_column,
    split_unit,
    stated_rate_hz,
)
from springpot.trainer.recordings.formats.csv.csv_missing import wanted_columns
from springpot.trainer.recordings.formats.csv.csv_units import pair_columns
from springpot.trainer.recordings.formats.file_request import FileRequest
from springpot.trainer.recordings.formats.raw_channels import RawChannels
from springpot.trainer.recordings.formats.units import Quantity, Unit, choose_unit
from springpot.trainer.recordings.places import require_one_place
from springpot.trainer.recordings.reader_limits import read_apart

_MAX_SHOWN = 12


@dataclass(frozen=True, eq=False)
class _Array:
    name: str
    unit: str
    values: Samples


def read_mat_arrays(path: Path, request: FileRequest) -> tuple[list[RawChannels], str]:
    """Read one recording from a MAT file of version 5, as `read_hdf5_arrays`."""
    return _read_arrays(path, "mat", request.columns)


def read_hdf5_arrays(path: Path, request: FileRequest) -> tuple[list[RawChannels], str]:
    """Read one recording from an HDF5 file of any layout, or a MAT file of version 7.3.

    A channel is a vector, or a column of a matrix as `data[2]`; structures and groups are named
    as `rig.force` and `rig/force`. Raises DataError naming file and array where a channel or its
    unit is missing or ambiguous, or lengths differ.
    """
    return _read_arrays(path, "hdf5", request.columns)


def _read_arrays(path: Path, kind: str, columns: ColumnMap) -> tuple[list[RawChannels], str]:
    arrays = _load(path, kind)
    options = wanted_columns(columns)
    chosen = {quantity: _choose(path, arrays, quantity, columns) for quantity in options}
    lengths = {quantity: len(array.values) for quantity, array in chosen.items()}
    if len(set(lengths.values())) > 1:
        found = ", ".join(f"{chosen[q].name!r} {n}" for q, n in lengths.items())
        raise DataError(f"{path}: channels of different lengths ({found}): correct --map")
    units = {q: _unit(path, q, array, columns) for q, array in chosen.items()}
    scaled = {q: array.values * units[q].to_si for q, array in chosen.items()}
    found = ", ".join(
        f"{q} = {array.name!r} in {units[q].text} ({units[q].origin})"
        for q, array in chosen.items()
    )
    metadata: dict[str, Any] = {q: unit.metadata() for q, unit in units.items()}
    rate_hz = stated_rate_hz(columns)
    if rate_hz is not None:
        scaled["time"] = np.arange(len(scaled["force"])) / rate_hz
        metadata["time"] = {"unit": f"{rate_hz:g} Hz", "from": "map"}
        found = f"time = samples counted at the stated {rate_hz:g} Hz, {found}"
    guess = f"{kind.upper()} file: {found}"
    raw = RawChannels(
        name=path.stem,
        time_s=scaled["time"],
        position_m=scaled["position"],
        force_n=scaled["force"],
        time_digit_s=0.0,
        source=str(path),
        line_of=lambda sample: sample + 1,
        details={"columns": guess, "units": metadata},
        place_m=_place_m(path, arrays, len(scaled["force"])),
    )
    return [raw], guess


def _place_m(path: Path, arrays: list[_Array], samples: int) -> tuple[float, float] | None:
    """Place that arrays such as place_x_mm and place_y_mm state, m; None without them."""
    names, units = _labels(arrays), [array.unit for array in arrays]
    place = pair_columns(path, names, units, "place", "position")
    for index, _ in place:
        if len(arrays[index].values) != samples:
            raise DataError(
                f"{path}: {arrays[index].name!r} has {len(arrays[index].values)} samples, force "
                f"{samples}: give as many"
            )
    found = [arrays[index].values * to_si for index, to_si in place]
    return require_one_place(str(path), np.column_stack(found)) if found else None


def _load(path: Path, kind: str) -> list[_Array]:
    if kind == "mat" and find_spec("scipy") is None:
        raise ModuleNotFoundError("MAT files are read by scipy", name="scipy")
    module = "springpot.trainer.recordings.formats.array_process"
    with np.load(io.BytesIO(read_apart(path, module, kind)), allow_pickle=False) as stored:
        names, units = stored["names"], stored["units"]
        arrays = [
            _Array(str(name), str(unit), stored[f"a{k}"])
            for k, (name, unit) in enumerate(zip(names, units, strict=True))
        ]
    if not arrays:
        raise DataError(
            f"{path}: holds no vectors of numbers (tables and objects of MATLAB cannot be read): "
            "save plain arrays"
        )
    return arrays


def _choose(path: Path, arrays: list[_Array], quantity: Quantity, columns: ColumnMap) -> _Array:
    column = columns.get(quantity)
    names = [array.name for array in arrays]
    shown = ", ".join(map(repr, names[:_MAX_SHOWN])) + (", ..." if names[_MAX_SHOWN:] else "")
    if column is None:
        found = _guess(arrays, quantity)
        if len(found) == 1:
            return found[0]
        what = "may be " + ", ".join(repr(a.name) for a in found) if found else "has no array"
        raise DataError(f"{path}: {quantity} {what}; it holds {shown}: pass --map {MAP_EXAMPLE}")
    if isinstance(column.header_or_number, int):
        if column.header_or_number > len(arrays):
            raise DataError(f"{path}: --map {quantity}={column.header_or_number}: it holds {shown}")
        return arrays[column.header_or_number - 1]
    options = column.header_or_number.strip("/")
    exact = [array for array in arrays if array.name == options]
    if len(exact) != 1:
        raise DataError(f"{path}: --map {quantity}: no array {options!r}; it holds {shown}")
    return exact[0]


def _guess(arrays: list[_Array], quantity: Quantity) -> list[_Array]:
    return [arrays[index] for index in guess_column(_labels(arrays), quantity)]


def _labels(arrays: list[_Array]) -> list[str]:
    """Last parts of the names: groups and structures are named after rigs."""
    return [array.name.replace(".", "/").rpartition("/")[2] for array in arrays]


def _unit(path: Path, quantity: Quantity, array: _Array, columns: ColumnMap) -> Unit:
    column = columns.get(quantity)
    label = array.name.replace(".", "/").rpartition("/")[2]
    found = {
        "map": column.unit if column else None,
        "attribute": array.unit,
        "name": split_unit(label, quantity)[1] if not label.endswith("]") else None,
    }
    return choose_unit(found, quantity, f"{path}, array {array.name!r}", array.name)
