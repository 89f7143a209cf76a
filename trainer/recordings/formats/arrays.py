"""MAT (v5, v7.3) and HDF5 files of any layout: one array a channel, by name or map.

Their libraries can crash, hang or ask for any amount of memory on a damaged file. So this module
reads them in a process of its own, with limits, which prints the arrays as one NPZ.
"""

import io
import os
import resource
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.regular_file import max_unpacked_bytes
from springpot.trainer.recordings.formats.column_map import (
    MAP_EXAMPLE,
    FileRequest,
    guess_column,
    split_unit,
)
from springpot.trainer.recordings.formats.sampling import RawChannels, place_m
from springpot.trainer.recordings.formats.units import Quantity, choose_unit

_MAX_SHOWN = 12
_MAX_COLUMNS = 32
_MAX_RATIO = 256  # a recording of nothing but zeros shrinks by 230
_MAX_BYTES, _LEAST_BYTES = 8 << 30, 1 << 30  # of the process, libraries included
_MAX_CPU_S, _LEAST_CPU_S, _TIMEOUT_S = 120, 4, 150.0
_SCALED = ("scale_factor", "add_offset", "conversion", "offset", "_FillValue", "missing_value")


@dataclass(frozen=True, eq=False)
class _Array:
    name: str
    unit: str
    values: Samples

    @property
    def label(self) -> str:
        """Last part of the name: groups and structures are named after rigs."""
        return self.name.replace(".", "/").rpartition("/")[2]


def read_arrays(path: Path, kind: str, request: FileRequest) -> tuple[RawChannels, str]:
    """Read one recording from a file of the kind "mat" (version 5) or "hdf5" (MAT 7.3 too).

    A channel is a vector, or a column of a matrix as `data[2]`; structures and groups are named
    as `rig.force` and `rig/force`. Raises DataError naming file and array if a channel or its
    unit is missing or ambiguous, or lengths differ.
    """
    arrays = _load(path, kind)
    chosen = {quantity: _choose(path, arrays, quantity, request) for quantity in request.wanted}
    if len({len(array.values) for array in chosen.values()}) > 1:
        found = ", ".join(f"{array.name!r} {len(array.values)}" for array in chosen.values())
        raise DataError(f"{path}: channels of different lengths ({found}): correct --map")
    units = {}
    for q, array in chosen.items():
        texts = {
            "map": request.columns[q].unit if q in request.columns else None,
            "attribute": array.unit,
            "name": None if array.label.endswith("]") else split_unit(array.label, q)[1],
        }
        units[q] = choose_unit(texts, q, f"{path}, array {array.name!r}", array.name)
    scaled = {q: array.values * units[q].to_si for q, array in chosen.items()}
    guess = f"{kind.upper()} file: " + ", ".join(
        f"{q} = {array.name!r} in {units[q].text} ({units[q].origin})"
        for q, array in chosen.items()
    )
    metadata = {q: unit.metadata() for q, unit in units.items()}
    count = len(scaled["force"])
    if request.rate_hz is not None:
        scaled["time"] = np.arange(count) / request.rate_hz
        metadata["time"] = {"unit": f"{request.rate_hz:g} Hz", "from": "map"}
        guess += f", time = samples counted at the stated {request.rate_hz:g} Hz"
    labels, below = [array.label for array in arrays], [array.unit for array in arrays]
    return RawChannels(
        time_s=scaled["time"],
        position_m=scaled["position"],
        force_n=scaled["force"],
        rows=np.arange(1, count + 1),
        source=str(path),
        details={"columns": guess, "units": metadata},
        place_m=place_m(str(path), labels, lambda k: arrays[k].values, request.place, below),
    ), guess


def _choose(
    path: Path, arrays: Sequence[_Array], quantity: Quantity, request: FileRequest
) -> _Array:
    column = request.columns.get(quantity)
    shown = ", ".join(repr(a.name) for a in arrays[:_MAX_SHOWN]) + ", ..." * (
        len(arrays) > _MAX_SHOWN
    )
    if column is None:
        found = [arrays[k] for k in guess_column([array.label for array in arrays], quantity)]
    elif isinstance(column.header_or_number, int):
        found = list(arrays[column.header_or_number - 1 : column.header_or_number])
    else:
        stated = column.header_or_number.strip("/")
        found = [array for array in arrays if array.name == stated]
    if len(found) == 1:
        return found[0]
    what = "has no array" if column is None else f"has no array {column.header_or_number!r}"
    if found:
        what = "may be " + ", ".join(repr(array.name) for array in found)
    raise DataError(f"{path}: {quantity} {what}; it holds {shown}: pass --map {MAP_EXAMPLE}")


def _load(path: Path, kind: str) -> list[_Array]:
    with np.load(io.BytesIO(_npz_apart(path, kind)), allow_pickle=False) as stored:
        columns = zip(stored["names"], stored["units"], strict=True)
        arrays = [_Array(str(name), str(unit), stored[f"a{k}"])
                  for k, (name, unit) in enumerate(columns)]  # fmt: skip
    if not arrays:
        raise DataError(
            f"{path}: holds no vectors of numbers (tables and objects of MATLAB cannot be read): "
            "save plain arrays"
        )
    return arrays


def _npz_apart(path: Path, kind: str) -> bytes:
    """Run this module on the file. Raises DataError if the process refuses it, or is ended."""
    if kind == "mat" and find_spec("scipy") is None:
        raise ModuleNotFoundError("MAT files are read by scipy", name="scipy")
    try:
        done = subprocess.run(
            [sys.executable, "-m", __name__, path, kind], capture_output=True, check=False,
            timeout=_TIMEOUT_S,
            env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},  # each thread counts as memory
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        why = "reading it does not end"
    else:
        if not done.returncode:
            return done.stdout
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        why = lines[-1] if lines and done.returncode > 0 else "it crashes the reader"
    raise DataError(f"{path}: damaged or of another format ({why}): export it again")


def arrays_as_npz(path: Path, kind: str) -> bytes:
    """Return names, units and values of the vectors in a file; raises whatever its library does."""
    found: list[tuple[str, str, object]] = []
    if kind == "mat":
        from scipy.io import loadmat

        _nested("", loadmat(path, simplify_cells=True), found)
    else:
        import h5py

        def visit(name: str, node: object) -> None:
            if not isinstance(node, h5py.Dataset) or name.startswith("#"):
                return
            if scaled := [each for each in _SCALED if each in node.attrs]:
                raise ValueError(
                    f"{name} has the attribute {scaled[0]}, which is not applied: read it in "
                    "Python and pass the arrays to springpot.Recording.from_frame"
                )
            unit = next((node.attrs[a] for a in ("unit", "units", "Unit", "Units")
                         if a in node.attrs), "")  # fmt: skip
            unit = unit.decode("utf-8", "replace") if isinstance(unit, bytes) else str(unit)
            if node.dtype.names:
                found.extend((f"{name}.{f}", "", node[f]) for f in node.dtype.names)
            elif node.dtype.kind in "fiu" and node.ndim <= 2:
                found.append((name, unit, node[()]))

        with h5py.File(path, "r") as file:
            file.visititems(visit)
    columns: list[tuple[str, str, Samples]] = []
    for name, unit, value in found:
        array = np.asarray(value)
        if array.dtype.kind not in "fiu":
            continue
        array = np.squeeze(array).astype(np.float64)
        if array.ndim == 1 and len(array) > 1:
            columns.append((name, unit, array))
        elif array.ndim == 2 and min(array.shape) <= _MAX_COLUMNS:
            across = array.T if array.shape[0] >= array.shape[1] else array  # time is longer
            columns += [(f"{name}[{k}]", unit, its) for k, its in enumerate(across, 1)]
    if sum(its.nbytes for *_, its in columns) > max_unpacked_bytes(path.stat().st_size, _MAX_RATIO):
        raise ValueError("more numbers than a file of its size can hold")
    memory = io.BytesIO()
    stored = {f"a{k}": np.asarray(its) for k, (*_, its) in enumerate(columns)}
    stored["names"] = np.array([name for name, *_ in columns], dtype=str)
    stored["units"] = np.array([unit for _, unit, _ in columns], dtype=str)
    np.savez(memory, allow_pickle=False, **stored)
    return memory.getvalue()


def _nested(name: str, value: object, found: list[tuple[str, str, object]]) -> None:
    """Collect the arrays of structures and cells."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            if not key.startswith("__"):
                _nested(f"{name}.{key}" if name else key, inner, found)
    elif isinstance(value, list) or (isinstance(value, np.ndarray) and value.dtype == object):
        for k, inner in enumerate(np.ravel(value) if isinstance(value, np.ndarray) else value, 1):
            _nested(f"{name}({k})", inner, found)
    else:
        found.append((name, "", value))


def limit_reader(path: Path) -> None:
    """Limit this process to the memory and time that reading a file of its size may take."""
    mib = path.stat().st_size >> 20
    max_bytes = min(_MAX_BYTES, _LEAST_BYTES + (mib << 28))
    cpu_s = min(_MAX_CPU_S, _LEAST_CPU_S + mib)
    resource.setrlimit(resource.RLIMIT_AS, (max_bytes, max_bytes))
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s))


if __name__ == "__main__":
    limit_reader(Path(sys.argv[1]))
    try:
        sys.stdout.buffer.write(arrays_as_npz(Path(sys.argv[1]), sys.argv[2]))
    except Exception as error:  # whatever the libraries raise on a damaged file
        sys.exit(" ".join(f"{type(error).__name__}: {error}".split())[:300])
