"""Read the arrays of a MAT or HDF5 file: run as a process of its own.

Their libraries can crash, hang or ask for any amount of memory on a damaged file; a process of its
own turns that into one line. Prints the arrays as one NPZ file: names, units and values.
"""

import io
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from springpot.trainer.recordings.reader_limits import require_unpacked, run_reader

_MAX_COLUMNS = 32
Found = Iterator[tuple[str, str, Any]]


def arrays_as_npz(path: Path, kind: str) -> bytes:
    """Names, units and values of the vectors in a file of the kind "mat" or "hdf5"."""
    found = {"mat": _of_mat, "hdf5": _of_hdf5}[kind](path)
    columns = [part for name, unit, value in found for part in _columns(name, unit, value)]
    require_unpacked(path, sum(values.nbytes for _, _, values in columns), "MiB of numbers")
    memory = io.BytesIO()
    np.savez(
        memory,
        names=np.array([name for name, _, _ in columns], dtype=str),
        units=np.array([unit for _, unit, _ in columns], dtype=str),
        **{f"a{k}": values for k, (_, _, values) in enumerate(columns)},
    )
    return memory.getvalue()


def _of_mat(path: Path) -> Found:
    from scipy.io import loadmat

    yield from _nested("", loadmat(path, simplify_cells=True))


def _nested(prefix: str, value: Any) -> Found:
    if isinstance(value, Mapping):
        for name, inner in value.items():
            if not name.startswith("__"):
                yield from _nested(f"{prefix}.{name}" if prefix else name, inner)
    elif isinstance(value, list):
        for k, inner in enumerate(value, 1):
            yield from _nested(f"{prefix}({k})", inner)
    elif isinstance(value, np.ndarray) and value.dtype == object:
        for k, inner in enumerate(value.ravel(), 1):
            yield from _nested(f"{prefix}({k})", inner)
    else:
        yield prefix, "", value


def _of_hdf5(path: Path) -> Found:
    import h5py

    found: list[tuple[str, str, Any]] = []

    def visit(name: str, node: Any) -> None:
        if isinstance(node, h5py.Dataset) and not name.startswith("#"):
            unit = next((node.attrs[a] for a in ("unit", "units", "Unit", "Units")
                         if a in node.attrs), "")  # fmt: skip
            unit = unit.decode("utf-8", "replace") if isinstance(unit, bytes) else str(unit)
            if node.dtype.names:
                found.extend((f"{name}.{f}", "", node[f]) for f in node.dtype.names)
            elif node.dtype.kind in "fiu" and node.ndim <= 2:
                found.append((name, unit, node[()]))

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    yield from found


def _columns(name: str, unit: str, value: Any) -> Iterator[tuple[str, str, Any]]:
    """Give a vector as it is and a matrix column by column, the longer side being time."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":
        return
    array = np.squeeze(array).astype(np.float64)
    if array.ndim == 1 and len(array) > 1:
        yield name, unit, array
    elif array.ndim == 2 and min(array.shape) <= _MAX_COLUMNS:
        tall = array if array.shape[0] >= array.shape[1] else array.T
        for k in range(tall.shape[1]):
            yield f"{name}[{k + 1}]", unit, np.ascontiguousarray(tall[:, k])


if __name__ == "__main__":
    run_reader(Path(sys.argv[1]), lambda path: arrays_as_npz(path, sys.argv[2]))
