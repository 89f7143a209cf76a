"""Which column is which: `time=COL:s,position=COL:mm,force=COL:N`."""

import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass

from springpot.codegen.errors import UsageError
from springpot.trainer.recordings.formats.units import QUANTITIES, Quantity

EXAMPLE = "time=COL:s,position=COL:mm,force=COL:N"
# A header may hold commas ("Time, s"): only a comma before the next channel's name separates.
_NEXT_CHANNEL = re.compile(rf",(?=\s*(?:{'|'.join(QUANTITIES)})\s*=)")


_RATE = re.compile(r"(\d+\.?\d*(?:[eE][+-]?\d+)?)\s*(k?)Hz")


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
            raise UsageError(f"--map: cannot read {part.strip()!r}: write {EXAMPLE}")
        if quantity in columns:
            raise UsageError(f"--map: {quantity} is given twice: give it once")
        rate = _RATE.fullmatch(rest)
        if quantity == "time" and rate:
            columns[quantity] = _parse_rate(float(rate[1]) * (1000.0 if rate[2] else 1.0))
        else:
            columns[quantity] = _parse_column(rest, quantity)
    return columns


def _parse_rate(rate_hz: float) -> Column:
    if not 0.0 < rate_hz < 1e9:
        raise UsageError(f"--map: time at {rate_hz:g} Hz is no rate: write for example time=1000Hz")
    return Column("", rate_hz=rate_hz)


def _parse_column(text: str, quantity: Quantity) -> Column:
    header, colon, unit = (piece.strip() for piece in text.rpartition(":"))
    if not colon:
        header, unit = unit, ""
    if not header:
        raise UsageError(f"--map: {quantity} has no column: write {EXAMPLE}")
    if not header.isdecimal():
        return Column(header, unit or None)
    if int(header) == 0:
        raise UsageError(f"--map: {quantity}: columns are counted from 1, not 0")
    return Column(int(header), unit or None)
