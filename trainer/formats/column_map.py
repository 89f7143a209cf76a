"""Which column is which: `time=COL:s,position=COL:mm,force=COL:N`."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from springpot.runtime_c.errors import UsageError
from springpot.trainer.formats.units import QUANTITIES, Quantity

EXAMPLE = "time=COL:s,position=COL:mm,force=COL:N"
# A header may hold commas ("Time, s"): only a comma before the next channel's name separates.
_NEXT_CHANNEL = re.compile(rf",(?=\s*(?:{'|'.join(QUANTITIES)})\s*=)")


@dataclass(frozen=True)
class Column:
    """One channel's column: a header's text or a 1-based number, and its unit if it was given."""

    header_or_number: str | int
    unit: str | None = None


ColumnMap = Mapping[Quantity, Column]


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
        columns[quantity] = _parse_column(rest, quantity)
    return columns


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
