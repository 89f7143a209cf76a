"""The cells of one column as numbers, read one by one where a row must be named."""

import math
from collections.abc import Iterable
from decimal import Decimal, InvalidOperation
from pathlib import Path

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.csv.clock import clock_s, is_clock, printed_exponent
from springpot.trainer.recordings.formats.csv.csv_layout import Layout
from springpot.trainer.recordings.formats.csv.csv_lines import Cells, cells
from springpot.trainer.recordings.formats.csv.decimals import (
    COMMA_TO_POINT,
    DecimalMark,
    is_grouped,
    is_number,
    without_groups,
)

_MAX_EXPONENT = 300


def column_numbers(
    path: Path, layout: Layout, rows: list[tuple[int, Cells]], index: int
) -> list[float]:
    """Numbers of a column, each row with its line: stamps of a clock as s, no thousands' marks.

    An empty cell is NaN: what is missing is told of all rows at once, by `require_finite`.
    Raises DataError for the first cell that holds something else.
    """
    found = [row[index].strip() for _, row in rows]
    where = f"{path}, row {{}}, column {index + 1}"
    if layout.clock and index == layout.columns["time"]:
        try:
            return clock_s(found)
        except ValueError as error:
            number = int(error.args[0])
            raise DataError(
                f"{where.format(rows[number][0])}: {found[number]!r} is no stamp of a clock, as "
                "the others are: correct it in the source"
            ) from None
    found = without_groups(found, layout.decimal, layout.stated)
    for (line, _), cell in zip(rows, found, strict=True):
        if cell and not is_number(cell, layout.decimal):
            raise _no_number(where.format(line), cell, layout.decimal)
    return [float(_plain(cell, layout.decimal)) if cell else math.nan for cell in found]


def _no_number(where: str, cell: str, decimal: DecimalMark) -> DataError:
    what = f"{cell!r} is not a number"
    if is_grouped(cell, decimal):
        (number,) = without_groups([cell], decimal, stated=True)
        return DataError(
            f"{where}: {cell!r} may have a separator of thousands or another mark of decimals: "
            f"pass --decimal {decimal} if it is {_plain(number, decimal)}, else write all numbers "
            "with one mark of decimals"
        )
    if decimal == "comma":
        what += " with a decimal comma, as the others are"
    elif is_number(cell.replace(",", ".")):
        what += " (decimal comma? write a point)"
    return DataError(f"{where}: {what}: correct it in the source")


def last_digit(lines: Iterable[str], layout: Layout) -> float:
    """One unit in the last printed digit of the stamps in lines, in their unit; 0 without one."""
    exponents, column = [], layout.columns["time"]
    for line in lines:
        row = cells(line, layout.delimiter)
        if len(row) - (row[-1:] == [""]) > layout.width or len(row) < layout.width:
            continue
        if layout.clock and is_clock(row[column]):
            exponents.append(printed_exponent(row[column]))
        elif is_number(row[column], layout.decimal):
            exponents += _last_exponent(_plain(row[column], layout.decimal))
    return 10.0 ** min(_MAX_EXPONENT, *exponents) if exponents else 0.0


def _plain(cell: str, decimal: DecimalMark) -> str:
    return cell.translate(COMMA_TO_POINT) if decimal == "comma" else cell


def _last_exponent(number: str) -> list[int]:
    """Power of ten of the last printed digit, where there is one."""
    try:
        exponent = Decimal(number).as_tuple().exponent
    except InvalidOperation:  # farther from 0 than even decimals go
        return []
    return [exponent] if isinstance(exponent, int) else []
