"""Columns of the channels and their units, by a map, `time=COL:s,position=COL:mm,force=COL:N`.

What the map leaves out is guessed from the words and units in a header.
"""

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.formats.units import (
    COMMON_UNITS,
    QUANTITIES,
    Quantity,
    Unit,
    choose_unit,
    is_unit,
    is_weight,
)

MAP_EXAMPLE = "time=COL:s,position=COL:mm,force=COL:N"
# A header may hold commas ("Time, s"): only a comma before the next channel's name separates.
_NEXT_CHANNEL = re.compile(rf",(?=\s*(?:{'|'.join(QUANTITIES)})\s*=)")
_RATE = re.compile(r"(\d+\.?\d*(?:[eE][+-]?\d+)?)\s*(k?)Hz")
_LABELS: dict[Quantity, set[str]] = {
    "time": {"time", "t", "timestamp"},
    "position": {
        *("position", "pos", "displacement", "disp", "depth", "penetration", "indentation"),
        *("compression", "extension", "stroke", "x", "z"),
    },
    "force": {"force", "load", "f", "fz"},
}
# Of texture analysers, indenters (penetration depth, normal force), LabVIEW and testing machines in
# German, French, Spanish and Italian: taken where no word above is found.
_OTHER_LABELS: dict[Quantity, set[str]] = {
    "time": {"zeit", "prüfzeit", "temps", "tiempo", "tempo", "elapsed", "x_value"},
    "position": {
        *("distance", "travel", "crosshead", "weg", "standardweg", "traversenweg", "eindringtiefe"),
        *("verlängerung", "verformung", "verschiebung", "kompressionsweg", "traverse", "pd"),
        *("déplacement", "deplacement", "enfoncement", "desplazamiento", "spostamento"),
        *("kompressionsverschiebung", "deformation", "deflection"),
    },
    "force": {
        *("kraft", "standardkraft", "prüfkraft", "kompressionskraft", "last", "fn", "charge"),
        *("fuerza", "carga", "forza", "carico"),
    },
}
# Date and time in one column, and German words that may be a strain: taken where no other is found.
_LAST_LABELS: dict[Quantity, set[str]] = {
    "time": {"date", "datetime", "datum", "uhrzeit", "clock"},
    "position": {"stauchung", "druckweg"},
    "force": {"druckkraft"},
}
# "Compression stress" and "Extension rate" are neither positions nor forces.
_NOT_A_LABEL = {
    "stress",
    "strain",
    "rate",
    "speed",
    "velocity",
    "setpoint",
    "command",
    "place",
    "dimension",
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


ColumnMap = Mapping[Quantity, Column]


def stated_rate_hz(columns: ColumnMap) -> float | None:
    """Rate that the map states in place of a column of time, Hz."""
    return columns["time"].rate_hz if "time" in columns else None


def map_option(columns: ColumnMap) -> str:
    """Write columns as `--map` takes them, quoted for a shell."""
    parts = [
        f"{q}={columns[q].header_or_number}" + (f":{columns[q].unit}" if columns[q].unit else "")
        if columns[q].rate_hz is None
        else f"{q}={columns[q].rate_hz:g}Hz"
        for q in QUANTITIES
        if q in columns
    ]
    return shlex.quote(",".join(parts))


def parse_map(text: str) -> dict[Quantity, Column]:
    """Read the text of `--map`. Channels that it leaves out are guessed from the headers.

    The last colon separates a column from its unit. Raises UsageError for text of another form.
    """
    columns: dict[Quantity, Column] = {}
    for part in _NEXT_CHANNEL.split(text):
        name, equals, rest = (piece.strip() for piece in part.partition("="))
        quantity = next((known for known in QUANTITIES if known == name), None)
        if quantity is None or not equals:
            raise UsageError(f"--map: cannot read {part.strip()!r}: write {MAP_EXAMPLE}")
        if quantity in columns:
            raise UsageError(f"--map: {quantity} is given twice: give it once")
        rate_hz = stated_hz(rest) if quantity == "time" else None
        if rate_hz is not None:
            columns[quantity] = Column("", rate_hz=rate_hz)
        else:
            columns[quantity] = _parse_column(rest, quantity)
    return columns


def stated_hz(text: str) -> float | None:
    """Return the rate that stands in place of a column of time, such as "10Hz"; None without one.

    Raises UsageError for a rate that is none.
    """
    found = _RATE.fullmatch(text)
    if found is None:
        return None
    rate_hz = float(found[1]) * (1000.0 if found[2] else 1.0)
    if not 0.0 < rate_hz < 1e9:
        raise UsageError(f"time={text}: {rate_hz:g} Hz is no rate: write for example time=1000Hz")
    return rate_hz


def _parse_column(text: str, quantity: Quantity) -> Column:
    header, colon, unit = (piece.strip() for piece in text.rpartition(":"))
    if not colon:
        header, unit = unit, ""
    if not header:
        raise UsageError(f"--map: {quantity} has no column: write {MAP_EXAMPLE}")
    if not header.isdecimal():
        return Column(header, unit or None)
    if int(header) == 0:
        raise UsageError(f"--map: {quantity}: columns are counted from 1, not 0")
    return Column(int(header), unit or None)


def split_unit(header: str, quantity: Quantity) -> tuple[str, str | None]:
    """Split "Time (s)", "Load [N]", "Time, s" or "position_mm" into label and unit.

    A longer header than any channel's is a label as it is: the patterns take the square of its
    length.
    """
    if len(header) > _MAX_HEADER:
        return header, None
    for pattern in (_BRACKETED_UNIT, _SEPARATED_UNIT):
        if match := pattern.fullmatch(header):
            return match[1], match[2]
    match = _APPENDED_UNIT.fullmatch(header)
    if match and (is_unit(match[2], quantity) or is_weight(match[2], quantity)):
        return match[1], match[2]
    return header, None


def guess_column(row: Sequence[str], quantity: Quantity) -> list[int]:
    """Prefer a label that is one of the known words to one that only contains such a word.

    A column in a unit of another quantity is no candidate. Without a word, a symbol in a unit of
    this one is ("s [mm]").
    """
    others = [q for q in QUANTITIES if q != quantity]
    own = {i: cell for i, cell in enumerate(row) if not any(_in_unit_of(cell, q) for q in others)}
    labels = {
        i: _CAMEL.sub("_", split_unit(cell, quantity)[0]).casefold().strip()
        for i, cell in own.items()
    }
    words = {
        i: set(re.split(r"[\W\d_]+", label.replace("x_value", ""))) for i, label in labels.items()
    }
    elsewhere = set[str]().union(*(_LABELS[q] for q in others))
    for known in (_LABELS[quantity], _OTHER_LABELS[quantity], _LAST_LABELS[quantity]):
        exact = [i for i, label in labels.items() if label in known]
        if exact:
            return exact
        found = [i for i, w in words.items() if w & known and not w & _NOT_A_LABEL]
        if found:  # an indentation force is a force
            return [i for i in found if not words[i] & elsewhere] or found
    return [i for i, cell in own.items() if len(labels[i]) < 3 and _in_unit_of(cell, quantity)]


def _in_unit_of(header: str, quantity: Quantity) -> bool:
    unit = split_unit(header, quantity)[1]
    return unit is not None and is_unit(unit, quantity)


def column_units(
    path: Path,
    header: list[str],
    chosen: dict[Quantity, int],
    columns: ColumnMap,
    unit_row: dict[Quantity, str],
) -> dict[Quantity, Unit]:
    """The units of the map, which must not contradict the file's, or of the header or unit row.

    header: empty where there is none. chosen: columns from 0. unit_row: the units below the header.
    Raises DataError for a unit that is unknown or contradicts, and once for all that are missing.
    """
    labels = {q: header[index] if index < len(header) else "" for q, index in chosen.items()}
    named = {q: columns.get(q) or Column(labels[q] or index + 1) for q, index in chosen.items()}
    places = {
        q: {
            "map": named[q].unit,
            "header": split_unit(labels[q], q)[1],
            "row of units": unit_row.get(q),
        }
        for q in chosen
    }
    where = {
        q: f"column {index + 1}{f' {labels[q]!r}' if labels[q] else ''}"
        for q, index in chosen.items()
    }
    missing = [q for q in chosen if not any(places[q].values())]
    if missing:
        wanted = {**columns, **{q: Column(named[q].header_or_number, "UNIT") for q in missing}}
        raise DataError(
            f"{path}, {', '.join(where[q] for q in missing)}: no unit of {', of '.join(missing)}: "
            f"pass --map {map_option(wanted)}, with a unit such as "
            f"{', '.join(COMMON_UNITS[q] for q in missing)} for each UNIT"
        )
    return {
        q: choose_unit(places[q], q, f"{path}, {where[q]}", str(named[q].header_or_number))
        for q in chosen
    }
