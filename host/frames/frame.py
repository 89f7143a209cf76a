"""Tables in memory, of pandas or polars, or of anything else that has columns with names."""

from collections.abc import Hashable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples, given_numbers
from springpot.codegen.errors import UsageError
from springpot.host.console.in_python import errors_in_python
from springpot.trainer.recordings.formats.column_map import split_unit, stated_hz
from springpot.trainer.recordings.formats.csv.csv_units import pair_columns
from springpot.trainer.recordings.formats.raw_channels import RawChannels
from springpot.trainer.recordings.formats.units import FRAME_NAME, Quantity, choose_unit
from springpot.trainer.recordings.places import require_one_place
from springpot.trainer.recordings.recording import FRAME_SOURCE

_MAX_SHOWN = 200  # letters of all names


def frame_channels(frame: Any, name: str, columns: Mapping[Quantity, Hashable]) -> RawChannels:
    """Three columns of a table, in SI units; columns: as `Recording.from_frame` takes them.

    Columns of a place (place_x_mm, place_y_mm) are read as an import reads them. Raises UsageError
    for what is no table and for a column that is not there, DataError for a unit.
    """
    labels = _labels(frame)
    scaled: dict[Quantity, Samples] = {}
    units: dict[Quantity, dict[str, Any]] = {}
    digit_s = 0.0
    for quantity, column in columns.items():
        found = _label(labels, column)
        if found is None:
            continue
        label, stated = found
        where = f"{name}, {quantity}={str(column)!r}"
        values = np.asarray(frame[label])
        values = _without_zone(values)
        if quantity == "time" and values.dtype.kind in "mM":  # durations, dates
            digit_s = _step_s(values.dtype)
            scaled[quantity] = given_numbers((values - values[:1]) / np.timedelta64(1, "s"), where)
            units[quantity] = {"unit": "s", "from": "map"}  # its type states the unit
            continue
        own = split_unit(label, quantity)[1] if isinstance(label, str) else None
        texts = {"map": stated, FRAME_NAME: own}
        with errors_in_python():
            unit = choose_unit(texts, quantity, where, str(label), in_python=True)
        scaled[quantity] = given_numbers(values, where) * unit.to_si
        units[quantity] = unit.metadata()
    rate_hz = None if "time" in scaled else stated_hz(str(columns["time"]))
    for quantity, column in columns.items():
        if quantity not in scaled and (quantity != "time" or rate_hz is None):
            raise UsageError(_missing(quantity, column, labels, frame))
    if rate_hz is not None:
        scaled["time"] = np.arange(len(scaled["force"])) / rate_hz
        units["time"] = {"unit": f"{rate_hz:g} Hz", "from": "map"}
    return RawChannels(
        name,
        scaled["time"],
        scaled["position"],
        scaled["force"],
        digit_s,
        FRAME_SOURCE,
        lambda sample: sample,
        {"units": units},
        place_m=_place_m(frame, name, labels),
        in_python=True,
    )


def _place_m(frame: Any, name: str, labels: Sequence[Hashable]) -> tuple[float, float] | None:
    """Place that columns such as place_x_mm and place_y_mm state, m; None without them.

    Raises DataError for one of them alone, for its unit, and for a place that changes.
    """
    names = [str(label) for label in labels]
    place = pair_columns(Path(name), names, [], "place", "position")
    if not place:
        return None
    found = [
        given_numbers(np.asarray(frame[labels[index]]), f"{name}, {labels[index]}") * to_si
        for index, to_si in place
    ]
    return require_one_place(name, np.column_stack(found))


def _labels(frame: Any) -> list[Hashable]:
    """Names of all columns. Raises UsageError for what has none."""
    if isinstance(frame, np.ndarray):
        found = frame.dtype.names
    else:
        found = getattr(frame, "column_names", None) or getattr(frame, "columns", None)
        if found is None and hasattr(frame, "keys"):
            found = frame.keys()
    if found is None or callable(found):
        raise UsageError(
            f"{type(frame).__name__} is no table with names of columns: give one of pandas or "
            "polars, or a dict of columns; Recording(name, position_m, force_n, dt_s) takes "
            "arrays, import_recordings(path) files"
        )
    return list(found)


def _label(labels: Sequence[Hashable], column: Hashable) -> tuple[Hashable, str | None] | None:
    """The table's own name of a column, and the unit that stands behind a colon.

    Letters of the other case are taken where only one column has them.
    """
    text = str(column)
    bare, colon, stated = text.rpartition(":")
    for wanted, unit in ((text, None), (bare, stated)) if colon else ((text, None),):
        for form in (str, lambda label: str(label).casefold()):
            same = [label for label in labels if form(label) == form(wanted)]
            if len(same) == 1:
                return same[0], unit
    return None


def _missing(quantity: Quantity, column: Hashable, labels: Sequence[Hashable], frame: Any) -> str:
    where = f"{quantity}={str(column)!r}"
    bare = str(column).rpartition(":")[0]
    same = [name for name in map(str, labels) if name in (str(column), bare)]
    if len(same) > 1:
        return f"{where}: {len(same)} columns have the name {same[0]!r}: rename or drop all but one"
    index = getattr(getattr(frame, "index", None), "name", None)
    if index is not None and str(index) in (str(column), bare):
        return f"{where}: the table's index, no column: pass the table's reset_index()"
    shown = ", ".join(repr(str(label)) for label in labels)
    shown = shown if len(shown) <= _MAX_SHOWN else f"{shown[:_MAX_SHOWN]} ..."
    rate = ", or a rate such as time='1000Hz'" if quantity == "time" else ""
    return (
        f"{where}: no such column: the table has {shown or 'none'}: name one of them, "
        f"{quantity}=...{rate}"
    )


def _without_zone(values: NDArray[Any]) -> NDArray[Any]:
    """Dates of Python or pandas, which numpy keeps as objects, as numpy's own, in UTC."""
    if values.dtype.kind != "O" or not all(isinstance(each, datetime) for each in values.flat):
        return values
    zoned = [each if each.tzinfo is None else each.astimezone(UTC) for each in values.flat]
    return np.array([each.replace(tzinfo=None) for each in zoned], "datetime64[us]")


def _step_s(stamps: np.dtype[Any]) -> float:
    """One unit in the last digit that stamps of a date or duration have, s."""
    step = np.ones((), stamps.str.replace("M8", "m8"))
    return float(step / np.timedelta64(1, "s"))
