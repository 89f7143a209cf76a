"""Arrays with names: MAT (v5, v7.3) and HDF5 files of any layout, and tables in memory.

A channel is found by its name, or by a map.
"""

import re
from collections.abc import Hashable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

from springpot.codegen.arrays import Samples, to_float64
from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.formats.column_map import (
    MAP_EXAMPLE,
    FileRequest,
    guess_columns,
    parse_rate_hz,
    read_place_m,
    split_unit,
)
from springpot.trainer.recordings.formats.sampling import RawChannels, to_si
from springpot.trainer.recordings.formats.units import QUANTITIES, Quantity, Unit, choose_unit
from springpot.trainer.recordings.hdf5_file import require_stored_here

_MAX_SHOWN = 12  # arrays in a message
_MAX_COLUMNS = 32
_SCALE_DEFAULTS = {"scale_factor": 1.0, "conversion": 1.0, "add_offset": 0.0, "offset": 0.0}
_FILL_ATTRIBUTES = ("_FillValue", "missing_value")
# Names of a rate in Hz, or of a time step in s.
_RATE_NAMES = {
    **dict.fromkeys(("fs", "rate", "rate_hz", "fs_hz", "sample_rate", "sampling_rate"), True),
    **dict.fromkeys(("dt", "dt_s", "delta_t", "time_step"), False),
}
_Stored = tuple[str, str, str, object]  # as `_Array`, whatever the values are
_MAX_LETTERS = 200  # of all names


class _Array(NamedTuple):
    """A vector; other: the attribute that says that its numbers are not the values, or ""."""

    name: str
    unit: str
    scale_attribute: str
    values: Samples

    @property
    def label(self) -> str:
        """Last part of the name: groups and structures are named after rigs."""
        return self.name.replace(".", "/").rpartition("/")[2]


def read_arrays(path: Path, kind: str, request: FileRequest) -> RawChannels:
    """Read one recording from a file of the kind "mat" (version 5) or "hdf5" (MAT 7.3 too).

    A channel is a vector, or a column of a matrix as `data[2]`; structures and groups are named
    as `rig.force` and `rig/force`. Raises DataError naming file and array if a channel or its
    unit is missing or ambiguous, or lengths differ.
    """
    stored = _load(path, kind)
    arrays = [array for parts in stored for array in _split_vectors(*parts)]
    if not arrays:
        raise DataError(
            f"{path}: holds no vectors of numbers (tables and objects of MATLAB cannot be read): "
            "save plain arrays"
        )
    rate_hz = request.rate_hz
    if rate_hz is None and "time" not in request.columns:
        labels = [array.label for array in arrays]
        rate_hz = None if guess_columns(labels, "time") else _find_rate_hz(stored)
    wanted = request.wanted if rate_hz is None else QUANTITIES[1:]
    chosen = {quantity: _choose(path, arrays, quantity, request) for quantity in wanted}
    if len({len(array.values) for array in chosen.values()}) > 1:
        lengths = ", ".join(f"{array.name!r} {len(array.values)}" for array in chosen.values())
        raise DataError(f"{path}: channels of different lengths ({lengths}): correct --map")
    units = {}
    for q, array in chosen.items():
        texts = {
            "map": request.columns[q].unit if q in request.columns else None,
            "attribute": array.unit,
            "name": None if array.label.endswith("]") else split_unit(array.label, q)[1],
        }
        units[q] = choose_unit(texts, q, f"{path}, array {array.name!r}", array.name)
    guess = f"{kind.upper()} file: " + ", ".join(
        f"{q} = {array.name!r} in {units[q].text} ({units[q].origin})"
        for q, array in chosen.items()
    )
    if rate_hz is not None:
        guess += f", time = samples counted at the stated {rate_hz:g} Hz"
    labels, below = [array.label for array in arrays], [array.unit for array in arrays]
    values = {q: array.values for q, array in chosen.items()}
    return to_si(
        values, units, rate_hz, guess,
        rows=np.arange(1, len(values["force"]) + 1),
        source=str(path),
        place_m=read_place_m(str(path), labels, lambda k: arrays[k].values, request.place, below),
    )  # fmt: skip


def _choose(
    path: Path, arrays: Sequence[_Array], quantity: Quantity, request: FileRequest
) -> _Array:
    """Return the array of a channel: the stated one, or the only one whose name fits.

    Raises DataError if none or several do, and for one that needs a scale applied.
    """
    if column := request.columns.get(quantity):
        stated = str(column.header_or_number).strip("/")
        candidates = [a for k, a in enumerate(arrays, 1) if stated in (a.name, str(k))]
        none = f"has no array {stated!r}"
    else:
        candidates = [arrays[k] for k in guess_columns([array.label for array in arrays], quantity)]
        none = "has no array"
    if len(candidates) != 1:
        what = (
            "may be " + ", ".join(repr(array.name) for array in candidates) if candidates else none
        )
        shown = ", ".join(repr(array.name) for array in arrays[:_MAX_SHOWN])
        raise DataError(f"{path}: {quantity} {what}; it holds {shown}: pass --map {MAP_EXAMPLE}")
    if candidates[0].scale_attribute:
        raise DataError(
            f"{path}, array {candidates[0].name!r}: its {candidates[0].scale_attribute} "
            "is not applied here: "
            "read it in Python and pass the values to springpot.Recording.from_frame"
        )
    return candidates[0]


def _load(path: Path, kind: str) -> list[_Stored]:
    """All that a file holds. Raises DataError for one that is damaged."""
    try:
        if kind == "hdf5":
            return _read_hdf5(path)
        from scipy.io import loadmat

        return list(_flatten("", loadmat(path, simplify_cells=True)))
    except ModuleNotFoundError:
        raise
    except Exception as error:  # whatever the libraries raise on a damaged file
        why = " ".join(f"{type(error).__name__}: {error}".split())[:300]
        raise DataError(f"{path}: damaged or of another format ({why}): export it again") from None


def _find_rate_hz(stored: Sequence[_Stored]) -> float | None:
    """The one rate that numbers or attributes of a file say, by name; None without one."""
    rates = set[float]()
    for name, unit, _, value in stored:
        word = re.split(r"[./@]", name)[-1].casefold()
        number = np.asarray(value)
        if word in _RATE_NAMES and number.size == 1 and number.dtype.kind in "fiu":
            size = float(number.ravel()[0]) * (1000.0 if unit == "kHz" else 1.0)
            if size > 0.0:
                rates.add(size if _RATE_NAMES[word] else 1.0 / size)
    return rates.pop() if len(rates) == 1 else None


def _split_vectors(name: str, unit: str, other: str, value: object) -> Iterator[_Array]:
    """Yield a numeric array as vectors: itself, or the columns of a narrow matrix."""
    if np.asarray(value).dtype.kind not in "fiu" or "@" in name:
        return
    array = np.squeeze(np.asarray(value)).astype(np.float64)
    if array.ndim == 1 and len(array) > 1:
        yield _Array(name, unit, other, array)
    elif array.ndim == 2 and min(array.shape) <= _MAX_COLUMNS:
        across = array.T if array.shape[0] >= array.shape[1] else array  # time is longer
        for k, column in enumerate(across, 1):
            yield _Array(f"{name}[{k}]", unit, other, np.ascontiguousarray(column))


def _flatten(name: str, value: object) -> Iterator[_Stored]:
    """Yield the arrays of structures and cells."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            if not key.startswith("__"):
                yield from _flatten(f"{name}.{key}" if name else key, inner)
    elif isinstance(value, list) or (isinstance(value, np.ndarray) and value.dtype == object):
        for k, inner in enumerate(value.flat if isinstance(value, np.ndarray) else value, 1):
            yield from _flatten(f"{name}({k})", inner)
    else:
        yield name, "", "", value


def _read_hdf5(path: Path) -> list[_Stored]:
    """Return name, unit, scale and values of every dataset of a file, and its attributes."""
    stored: list[_Stored] = []

    def visit(name: str, node: object) -> None:
        if not isinstance(node, h5py.Dataset) or name.startswith("#"):
            return
        texts = [node.attrs[a] for a in ("unit", "units", "Unit", "Units") if a in node.attrs]
        unit = texts[0] if texts else ""
        unit = unit.decode("utf-8", "replace") if isinstance(unit, bytes) else str(unit)
        if node.dtype.names:
            stored.extend((f"{name}.{f}", "", "", node[f]) for f in node.dtype.names)
        elif node.dtype.kind in "fiu" and node.ndim <= 2:
            value, attributes = node[()], dict(node.attrs)
            others = [
                a
                for a, default in _SCALE_DEFAULTS.items()
                if np.any(attributes.get(a, default) != default)
            ]
            others += [
                a for a in _FILL_ATTRIBUTES if a in attributes and np.any(value == attributes[a])
            ]
            stored.append((name, unit, "".join(others[:1]), value))

    def visit_attributes(name: str, node: h5py.Group | h5py.Dataset) -> None:
        stored.extend((f"{name}@{key}", "", "", value) for key, value in node.attrs.items())

    with h5py.File(path, "r") as file:
        require_stored_here(path, file)
        file.visititems(visit)
        visit_attributes("", file)
        file.visititems(visit_attributes)
    return stored


def frame_channels(frame: Any, name: str, columns: Mapping[Quantity, Hashable]) -> RawChannels:
    """Three columns of a table, in SI units; columns: as `Recording.from_frame` takes them.

    Columns of a place (place_x_mm, place_y_mm) are read as an import reads them. Raises UsageError
    for what is no table and for a column that is not there, DataError for a unit.
    """
    labels = _column_names(frame)
    numbers: dict[Quantity, Samples] = {}
    units: dict[Quantity, Unit] = {}
    missing: list[Quantity] = []
    digit_s, rate_hz = 0.0, None
    for quantity, column in columns.items():
        label_and_unit = _find_label(labels, column)
        if label_and_unit is None:
            rate_hz = parse_rate_hz(str(column)) if quantity == "time" else None
            if rate_hz is None:
                raise UsageError(_missing_column_message(quantity, column, labels))
            continue
        label, stated = label_and_unit
        name_unit = split_unit(label, quantity)[1] if isinstance(label, str) else None
        where, values = f"{name}, {quantity}={str(column)!r}", _to_utc(frame[label])
        if quantity == "time" and values.dtype.kind in "mM":  # its type states the unit
            step = np.ones((), values.dtype.str.replace("M8", "m8"))
            digit_s = float(step / np.timedelta64(1, "s"))
            values, stated, name_unit = (values - values[:1]) / np.timedelta64(1, "s"), "s", None
        if not (stated or name_unit):
            missing.append(quantity)
            continue
        texts = {"map": stated, "column's name": name_unit}
        units[quantity] = choose_unit(texts, quantity, where, str(label))
        numbers[quantity] = to_float64(values, where)
    if missing:
        units_of = {"time": "s", "position": "mm", "force": "N"}
        given = ", ".join(f'{q}="{columns[q]}:{units_of[q]}"' for q in missing)
        raise DataError(
            f"{name}: no unit of {', of '.join(missing)}: give each behind a colon, as in {given}"
        )
    return to_si(
        numbers, units, rate_hz,
        rows=np.arange(np.size(numbers["force"])),
        source=name,
        time_digit_s=digit_s,
        place_m=read_place_m(
            name,
            [str(label) for label in labels],
            lambda k: to_float64(np.asarray(frame[labels[k]]), f"{name}, {labels[k]}"),
        ),
    )  # fmt: skip


def _column_names(frame: Any) -> list[Hashable]:
    """Return the names of all columns. Raises UsageError for what has none, and a lazy table."""
    for method in ("collect", "compute"):  # of polars and Spark, of dask
        if hasattr(frame, method):
            raise UsageError(f"{type(frame).__name__}: not computed yet: give its .{method}()")
    names = frame.dtype.names if isinstance(frame, np.ndarray) else getattr(frame, "columns", None)
    names = getattr(frame, "column_names", None) or names
    if names is None and hasattr(frame, "keys"):
        names = frame.keys()
    if names is None or callable(names):
        raise UsageError(
            f"{type(frame).__name__} is no table with names of columns: give one of pandas or "
            "polars, or a dict of columns; Recording(name, position_m, force_n, dt_s) takes "
            "arrays, import_recordings(path) files"
        )
    return list(names)


def _find_label(labels: Sequence[Hashable], column: Hashable) -> tuple[Hashable, str | None] | None:
    """The table's own name of a column, in letters of either case, and the unit behind a colon."""
    bare, _, stated = str(column).rpartition(":")
    for wanted, unit in ((str(column), None), (bare, stated)):
        for form in (str, lambda label: str(label).casefold()):
            same = [label for label in labels if form(label) == form(wanted)]
            if len(same) == 1:
                return same[0], unit
    return None


def _missing_column_message(
    quantity: Quantity, column: Hashable, labels: Sequence[Hashable]
) -> str:
    """Say that a table has no such column, what it has, and what to pass."""
    shown = ", ".join(repr(str(label)) for label in labels)[:_MAX_LETTERS] or "none"
    rate = ", or a rate such as time='1000Hz'" if quantity == "time" else ""
    return (
        f"{quantity}={str(column)!r}: no column, or several, have this name: the table has {shown}:"
        f" name one of them, {quantity}=...{rate}; of an index pass the table's reset_index()"
    )


def _to_utc(column: Any) -> np.ndarray[Any, Any]:
    """Dates of Python or pandas, which numpy holds as objects, as numpy's own, in UTC."""
    values = np.asarray(column)
    if values.dtype.kind != "O" or not all(isinstance(stamp, datetime) for stamp in values.flat):
        return values
    zoned = [stamp if stamp.tzinfo is None else stamp.astimezone(UTC) for stamp in values.flat]
    return np.array([stamp.replace(tzinfo=None) for stamp in zoned], "datetime64[us]")
