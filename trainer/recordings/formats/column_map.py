"""Columns of the channels and their units, by a map, `time=COL:s,position=COL:mm,force=COL:N`.

What the map leaves out is guessed from the words and units in a header.
"""

import re
import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.formats.units import (
    COMMON_UNITS,
    QUANTITIES,
    Quantity,
    Unit,
    choose_unit,
    factor_to_si,
    is_specimen_unit,
    is_unit,
)
from springpot.trainer.recordings.recording import SAME_PLACE_M

DecimalMark = Literal["point", "comma"]
MAP_EXAMPLE = "time=COL:s,position=COL:mm,force=COL:N"
PLACE = ("place_x", "place_y")
# A header may hold commas ("Time, s"): only a comma before the next channel's name separates.
_NEXT_CHANNEL = re.compile(rf",(?=\s*(?:{'|'.join(QUANTITIES)})\s*=)")
_RATE = re.compile(r"(\d+\.?\d*(?:[eE][+-]?\d+)?)\s*(k?)Hz")
# Words of a header in rows of falling rank: of rigs; of texture analysers, indenters, LabVIEW and
# testing machines in German, French, Spanish, Italian; words that may be a date or a strain, too.
_LABELS: tuple[dict[Quantity, str], ...] = (
    {
        "time": "time t timestamp",
        "position": "position pos displacement disp depth penetration indentation compression "
        "extension stroke x z",
        "force": "force load f fz",
    },
    {
        "time": "zeit prüfzeit temps tiempo tempo elapsed x_value",
        "position": "distance travel crosshead weg standardweg traversenweg eindringtiefe traverse "
        "verlängerung verformung verschiebung kompressionsweg kompressionsverschiebung pd "
        "déplacement deplacement enfoncement desplazamiento spostamento deformation deflection",
        "force": "kraft standardkraft prüfkraft kompressionskraft last fn charge fuerza carga "
        "forza carico",
    },
    {
        "time": "date datetime datum uhrzeit clock",
        "position": "stauchung druckweg",
        "force": "druckkraft",
    },
)
# "Compression stress" and "Extension rate" are neither positions nor forces.
_NO_LABELS = {
    *("stress", "strain", "rate", "speed", "velocity", "setpoint", "command", "place", "dimension")
}
_BRACKETED_UNIT = re.compile(r"(.*?)[\s_,/]*[(\[{]\s*([^()\[\]{}]+?)\s*[)\]}]")
_SEPARATED_UNIT = re.compile(r"(.+?)\s*[,/]\s*([^,/]+)")
_APPENDED_UNIT = re.compile(r"(.+)[\s_]([^\s_]+)")
_MAX_HEADER = 200
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")


@dataclass(frozen=True)
class Column:
    """One channel's column: a header's text or a 1-based number, and its unit if it was given.

    rate_hz: of the channel time only, `time=10Hz`: no column is read, rows are counted.
    """

    header_or_number: str | int
    unit: str | None = None
    rate_hz: float | None = None

    def __str__(self) -> str:
        """As `--map` has it."""
        column = f"{self.header_or_number}" + f":{self.unit}" * bool(self.unit)
        return column if self.rate_hz is None else f"{self.rate_hz:g}Hz"


ColumnMap = Mapping[Quantity, Column]


@dataclass(frozen=True)
class FileRequest:
    """Hold what a person states about a file; the reader guesses the rest.

    decimal: the mark of decimals in text. place: headers of two columns, where the object was
    pressed.
    """

    columns: ColumnMap = field(default_factory=dict)
    decimal: DecimalMark | None = None
    place: tuple[str, str] = PLACE

    @property
    def rate_hz(self) -> float | None:
        """Rate that the map states in place of a column of time."""
        return self.columns["time"].rate_hz if "time" in self.columns else None

    @property
    def wanted(self) -> tuple[Quantity, ...]:
        """Channels that are read from columns: all, or all but time if a rate is stated."""
        return QUANTITIES if self.rate_hz is None else QUANTITIES[1:]


def parse_map(text: str) -> dict[Quantity, Column]:
    """Read the text of `--map`; the last colon separates a column from its unit.

    Raises UsageError for text of another form.
    """
    columns: dict[Quantity, Column] = {}
    for part in _NEXT_CHANNEL.split(text):
        name, equals, rest = (piece.strip() for piece in part.partition("="))
        quantity = next((known for known in QUANTITIES if known == name), None)
        if quantity is None or not equals:
            raise UsageError(f"--map: cannot read {part.strip()!r}: write {MAP_EXAMPLE}")
        if quantity in columns:
            raise UsageError(f"--map: {quantity} is given twice: give it once")
        rate_hz = parse_rate_hz(rest) if quantity == "time" else None
        header, colon, unit = (piece.strip() for piece in rest.rpartition(":"))
        if not colon:
            header, unit = unit, ""
        if not header:
            raise UsageError(f"--map: {quantity} has no column: write {MAP_EXAMPLE}")
        if header.isdecimal() and int(header) == 0:
            raise UsageError(f"--map: {quantity}: columns are counted from 1, not 0")
        column = Column(int(header) if header.isdecimal() else header, unit or None)
        columns[quantity] = column if rate_hz is None else Column("", rate_hz=rate_hz)
    return columns


def parse_rate_hz(text: str) -> float | None:
    """Return the rate that stands in place of a column of time, such as "10Hz"; None without one.

    Raises UsageError for 0 Hz and from 1 GHz on.
    """
    match = _RATE.fullmatch(text)
    if match is None:
        return None
    rate_hz = float(match[1]) * (1000.0 if match[2] else 1.0)
    if not 0.0 < rate_hz < 1e9:
        raise UsageError(f"time={text}: {rate_hz:g} Hz is no rate: write for example time=1000Hz")
    return rate_hz


def split_unit(header: str, quantity: Quantity) -> tuple[str, str | None]:
    """Split "Time (s)", "Load [N]", "Time, s" or "position_mm" into label and unit."""
    if header == "X_Value" and quantity == "time":
        return header, "s"  # LabVIEW writes its unit nowhere
    if len(header) > _MAX_HEADER:  # the patterns take the square of its length
        return header, None
    for pattern in (_BRACKETED_UNIT, _SEPARATED_UNIT):
        if match := pattern.fullmatch(header):
            return match[1], match[2]
    match = _APPENDED_UNIT.fullmatch(header)
    if match and (is_unit(match[2], quantity) or is_specimen_unit(match[2], quantity)):
        return match[1], match[2]
    return header, None


def guess_columns(row: Sequence[str], quantity: Quantity) -> list[int]:
    """Return the columns that may be a channel, from 0: those of the best label in a header.

    A label that is a known word goes before one that only contains such a word. A column in a unit
    of another quantity is no candidate. Without a word, a symbol in a unit of this one is
    ("s [mm]").
    """
    others = [q for q in QUANTITIES if q != quantity]
    candidates = {
        i: cell for i, cell in enumerate(row) if not any(_has_unit_of(cell, q) for q in others)
    }
    labels = {
        i: _CAMEL.sub("_", split_unit(cell, quantity)[0]).casefold().strip()
        for i, cell in candidates.items()
    }
    words = {
        i: set(re.split(r"[\W\d_]+", label.replace("x_value", ""))) for i, label in labels.items()
    }
    elsewhere = {word for q in others for word in _LABELS[0][q].split()}
    for rank in _LABELS:
        known = set(rank[quantity].split())
        exact = [i for i, label in labels.items() if label in known]
        if exact:
            return exact
        matches = [i for i, w in words.items() if w & known and not w & _NO_LABELS]
        if matches:  # an indentation force is a force
            return [i for i in matches if not words[i] & elsewhere] or matches
    return [
        i for i, cell in candidates.items() if len(labels[i]) < 3 and _has_unit_of(cell, quantity)
    ]


def _has_unit_of(header: str, quantity: Quantity) -> bool:
    unit = split_unit(header, quantity)[1]
    return unit is not None and is_unit(unit, quantity)


def choose_column_units(
    where: str,
    header: Sequence[str],
    chosen: Mapping[Quantity, int],
    columns: ColumnMap,
    below: Mapping[Quantity, str],
) -> dict[Quantity, Unit]:
    """Return the units of the map, which must not contradict the file's, or those of the file.

    where: begins a message. header: empty without one. chosen: columns from 0. below: units in the
    row below the header.
    Raises DataError for a unit that is unknown or contradicts, and once for all that are missing.
    """
    units: dict[Quantity, Unit] = {}
    wanted, missing = dict(columns), dict[Quantity, str]()
    for quantity, index in chosen.items():
        label = header[index] if index < len(header) else ""
        column = columns.get(quantity) or Column(label or index + 1)
        header_unit, unit_row_text = split_unit(label, quantity)[1], below.get(quantity)
        column_name = f"column {index + 1}{f' {label!r}' * bool(label)}"
        if column.unit or header_unit or unit_row_text:
            texts = {"map": column.unit, "header": header_unit, "row of units": unit_row_text}
            name = str(column.header_or_number)
            units[quantity] = choose_unit(texts, quantity, f"{where}, {column_name}", name)
        else:
            missing[quantity] = column_name
            wanted[quantity] = Column(column.header_or_number, "UNIT")
    if missing:
        option = shlex.quote(",".join(f"{q}={wanted[q]}" for q in QUANTITIES if q in wanted))
        raise DataError(
            f"{where}, {', '.join(missing.values())}: no unit of {', of '.join(missing)}: "
            f"pass --map {option}, with a unit such as "
            f"{', '.join(COMMON_UNITS[q] for q in missing)} for each UNIT"
        )
    return units


def read_place_m(
    where: str,
    header: Sequence[str],
    read: Callable[[int], Samples],
    names: tuple[str, str] = PLACE,
    below: Sequence[str] = (),
) -> tuple[float, float] | None:
    """Return x and y of the place that two columns state, m; None without them.

    read: the numbers of a column, (n,). below: the row of units. A stage that trembles stays.
    Raises DataError for one column alone, and if the tool moves along the surface.
    """
    labels = [split_unit(cell, "position") for cell in header]
    axes_m = []
    for name in names:
        for k, (label, header_unit) in enumerate(labels):
            if name.casefold() in (label.casefold(), header[k].casefold()):
                unit = header_unit or "".join(below[k : k + 1]).strip("()[]{} ")
                factor = factor_to_si(unit, "position", f"{where}, column {header[k]!r}")
                axes_m.append(read(k) * factor)
    if not axes_m:
        return None
    if len(axes_m) != 2:
        raise DataError(f"{where}: {' and '.join(names)} belong together: give one column of each")
    if np.ptp(axes_m, axis=1).max() > SAME_PLACE_M:
        raise DataError(
            f"{where}: the tool moves along the surface, and a model is of presses of one place "
            "each: cut it into one file a place"
        )
    x_m, y_m = np.median(axes_m, axis=1).tolist()
    return x_m, y_m
