"""Numbers as text: a decimal point or a decimal comma, and separators of thousands."""

import re
from collections.abc import Iterable, Sequence
from typing import Literal

from springpot.codegen.errors import DataError

# A point in a file of decimal commas groups thousands, or is a mistake: made unreadable here.
COMMA_TO_POINT = str.maketrans({",": ".", ".": "!"})

DecimalMark = Literal["point", "comma"]
_MARKS: dict[DecimalMark, tuple[str, str]] = {"point": (".", ","), "comma": (",", ".")}
_SPACES = " '\u2019\u00a0\u202f"  # and apostrophes: they separate nothing but thousands
_GROUPED = {
    mark: re.compile(
        rf"[+-]?[1-9]\d{{0,2}}(?P<group>[{group}{_SPACES}])\d{{3}}((?P=group)\d{{3}})*([{decimal}]\d*)?"
    )
    for mark, (decimal, group) in _MARKS.items()
}
_NOT_GROUPED = re.compile(r"[+-]?\d{4,}([.,]\d*)?")


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


def is_grouped(cell: str, decimal: DecimalMark) -> bool:
    """Return whether a cell is a number with separators of thousands: 1,007.7 or 1.007,7."""
    return _GROUPED[decimal].fullmatch(cell) is not None


def without_groups(cells: Sequence[str], decimal: DecimalMark, stated: bool) -> list[str]:
    """The cells of a column without separators of thousands, as they are where that is not certain.

    Certain: somebody stated the mark of decimals, or the separator is a space or an apostrophe, or
    one cell has both marks and no other cell writes a thousand without a separator.

    >>> without_groups(["999.5", "1,007.7", "2,000"], "point", stated=False)
    ['999.5', '1007.7', '2000']
    """
    mark, group = _MARKS[decimal]
    both = any(mark in cell and group in cell and is_grouped(cell, decimal) for cell in cells)
    certain = stated or (both and not any(map(_NOT_GROUPED.fullmatch, cells)))
    taken = str.maketrans("", "", _SPACES + (group if certain else ""))
    return [cell.translate(taken) if is_grouped(cell, decimal) else cell for cell in cells]


def decimal_mark(where: str, found: Iterable[tuple[int, str]]) -> DecimalMark:
    """Mark of decimals in cells of numbers, each with its row: a comma only where they show it.

    Raises DataError where every comma may as well separate thousands.
    """
    cells = list(found)
    commas = [(row, cell) for row, cell in cells if is_comma_number(cell)]
    grouped = sum(is_grouped(cell, "comma") and "," in cell for _, cell in cells)
    # 1.007 may be grouped: it speaks for points only if no comma speaks against.
    plain = [cell for _, cell in cells if is_number(cell) or is_grouped(cell, "point")]
    points = sum("." in cell and not is_grouped(cell, "comma") for cell in plain)
    if len(commas) + grouped <= points:
        return "point"
    if not grouped and all(is_grouped(cell, "point") for _, cell in commas):
        row, cell = commas[0]
        raise DataError(
            f"{where}, row {row}: {cell!r} may be a decimal comma or a thousands separator: pass "
            "--decimal comma, or --decimal point if the comma separates thousands"
        )
    return "comma"
