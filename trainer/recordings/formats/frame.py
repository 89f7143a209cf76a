"""Tables in memory, of pandas or polars, or of anything else that has columns with names."""

from collections.abc import Hashable, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np

from springpot.codegen.arrays import Samples, given_numbers
from springpot.codegen.errors import UsageError
from springpot.trainer.recordings.formats.column_map import place_m, split_unit, stated_hz
from springpot.trainer.recordings.formats.sampling import RawChannels
from springpot.trainer.recordings.formats.units import FRAME_NAME, Quantity, choose_unit
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
    digit_s, rate_hz = 0.0, None
    for quantity, column in columns.items():
        found = _label(labels, column)
        if found is None:
            rate_hz = stated_hz(str(column)) if quantity == "time" else None
            if rate_hz is None:
                raise UsageError(_missing(quantity, column, labels, frame))
            units[quantity] = {"unit": f"{rate_hz:g} Hz", "from": "map"}
            continue
        label, stated = found
        where, values = f"{name}, {quantity}={str(column)!r}", _without_zone(frame[label])
        if quantity == "time" and values.dtype.kind in "mM":  # its type states the unit
            step = np.ones((), values.dtype.str.replace("M8", "m8"))
            digit_s = float(step / np.timedelta64(1, "s"))
            scaled[quantity] = given_numbers((values - values[:1]) / np.timedelta64(1, "s"), where)
            units[quantity] = {"unit": "s", "from": "map"}
            continue
        own = split_unit(label, quantity)[1] if isinstance(label, str) else None
        texts = {"map": stated, FRAME_NAME: own}
        unit = choose_unit(texts, quantity, where, str(label), in_python=True)
        scaled[quantity] = given_numbers(values, where) * unit.to_si
        units[quantity] = unit.metadata()
    count = len(scaled["force"])
    return RawChannels(
        time_s=scaled["time"] if rate_hz is None else np.arange(count) / rate_hz,
        position_m=scaled["position"],
        force_n=scaled["force"],
        rows=np.arange(count),
        source=FRAME_SOURCE,
        time_digit_s=digit_s,
        details={"units": units},
        place_m=place_m(
            name,
            [str(label) for label in labels],
            lambda k: given_numbers(np.asarray(frame[labels[k]]), f"{name}, {labels[k]}"),
        ),
        in_python=True,
    )


def _labels(frame: Any) -> list[Hashable]:
    """Names of all columns. Raises UsageError for what has none."""
    found = frame.dtype.names if isinstance(frame, np.ndarray) else getattr(frame, "columns", None)
    found = getattr(frame, "column_names", None) or found
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
    """The table's own name of a column, in letters of either case, and the unit behind a colon."""
    bare, _, stated = str(column).rpartition(":")
    for wanted, unit in ((str(column), None), (bare, stated)):
        for form in (str, lambda label: str(label).casefold()):
            same = [label for label in labels if form(label) == form(wanted)]
            if len(same) == 1:
                return same[0], unit
    return None


def _missing(quantity: Quantity, column: Hashable, labels: Sequence[Hashable], frame: Any) -> str:
    where, asked = f"{quantity}={str(column)!r}", (str(column), str(column).rpartition(":")[0])
    same = [name for name in map(str, labels) if name in asked]
    if len(same) > 1:
        return f"{where}: {len(same)} columns have the name {same[0]!r}: rename or drop all but one"
    if str(getattr(getattr(frame, "index", None), "name", None)) in asked:
        return f"{where}: the table's index, no column: pass the table's reset_index()"
    shown = ", ".join(repr(str(label)) for label in labels)[:_MAX_SHOWN] or "none"
    rate = ", or a rate such as time='1000Hz'" if quantity == "time" else ""
    return f"{where}: no such column: the table has {shown}: name one of them, {quantity}=...{rate}"


def _without_zone(column: Any) -> np.ndarray[Any, Any]:
    """Dates of Python or pandas, which numpy holds as objects, as numpy's own, in UTC."""
    values = np.asarray(column)
    if values.dtype.kind != "O" or not all(isinstance(each, datetime) for each in values.flat):
        return values
    zoned = [each if each.tzinfo is None else each.astimezone(UTC) for each in values.flat]
    return np.array([each.replace(tzinfo=None) for each in zoned], "datetime64[us]")
