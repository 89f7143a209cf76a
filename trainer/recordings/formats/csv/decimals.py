"""Numbers as text: a decimal point or a decimal comma, and no separators of thousands."""

import re
from collections.abc import Iterable
from typing import Literal

from springpot.codegen.errors import DataError

# A point in a file of decimal commas groups thousands, or is a mistake: made unreadable here.
COMMA_TO_POINT = str.maketrans({",": ".", ".": "!"})
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")

DecimalMark = Literal["point", "comma"]


def is_number(cell: str, decimal: DecimalMark = "point") -> bool:
    """Return whether a cell is a number, NaN and infinity included."""
    if decimal == "comma":
        cell = cell.translate(COMMA_TO_POINT)
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell and cell.isascii()  # Python reads 1_000 and other scripts' digits


def is_comma_number(cell: str) -> bool:
    """Return whether a cell is a number with a decimal comma."""
    return "," in cell and is_number(cell, "comma")


def decimal_mark(where: str, found: Iterable[tuple[int, str]]) -> DecimalMark:
    """Mark of decimals in cells of numbers, each with its row: a comma only where they show it.

    Raises DataError where every comma may as well separate thousands.
    """
    cells = list(found)
    commas = [(row, cell) for row, cell in cells if is_comma_number(cell)]
    points = sum("." in cell and is_number(cell) for _, cell in cells)
    if len(commas) <= points:
        return "point"
    if all(_THOUSANDS.fullmatch(cell) for _, cell in commas):
        row, cell = commas[0]
        raise DataError(
            f"{where}, row {row}: {cell!r} may be a decimal comma or a thousands separator: pass "
            "--decimal comma, or export it without separators of thousands"
        )
    return "comma"
