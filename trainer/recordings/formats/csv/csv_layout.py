"""Where a CSV file's header, columns, units and first row of numbers are: given, else guessed."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import (
    EXAMPLE,
    Column,
    ColumnMap,
    column_units,
    guess_column,
    stated_rate_hz,
)
from springpot.trainer.recordings.formats.csv.decimals import (
    DecimalMark,
    decimal_mark,
    is_comma_number,
    is_number,
)
from springpot.trainer.recordings.formats.units import (
    QUANTITIES,
    Quantity,
    Unit,
    is_unit,
)

DELIMITERS = {"\t": "tab", ";": "semicolon", ",": "comma"}
_MAX_COLUMNS = 1024
_MAX_NAMED = 12  # columns in a message
_Row = list[str]
Candidates = dict[Quantity, list[int]]


@dataclass(frozen=True)
class Layout:
    """Layout of a file: cells to a row, 1-based line of the first numbers, columns from 0."""

    delimiter: str
    width: int
    first_line: int
    columns: dict[Quantity, int]
    units: dict[Quantity, Unit]
    guess: str
    decimal: DecimalMark
    unread_time: tuple[int, str] | None  # a column of time and its header, where a rate is stated


def find_layout(
    path: Path, head: Sequence[str], columns: ColumnMap, decimal: DecimalMark | None = None
) -> Layout:
    """Find the layout from the file's first lines; `columns` and `decimal` override the guess.

    Where `columns` states a rate, no column of time is needed.
    Raises DataError where a column or a unit is missing, unknown or ambiguous.
    """
    options = wanted_columns(columns)
    if all(q in columns and not _name(columns[q]) for q in options):
        return _layout_by_numbers(path, head, columns, decimal)
    best: tuple[int, Candidates, _Row] = (0, {}, [])
    for index in range(len(head)):
        for delimiter in DELIMITERS:
            row = cells(head[index], delimiter)
            if not len(options) <= len(row) <= _MAX_COLUMNS:
                continue
            found = {q: _candidates(row, q, columns.get(q)) for q in options}
            found = {q: candidates for q, candidates in found.items() if candidates}
            if len(found) == len(options):
                chosen = _only(path, index, row, found)
                return _layout(path, head, delimiter, index, chosen, columns, decimal)
            if len(found) > len(best[1]):
                best = (index, found, row)
    raise _missing(path, *best, columns)


def cells(line: str, delimiter: str) -> _Row:
    """Split one line; quoted cells keep their delimiters. None where one is too long for a cell."""
    try:
        rows = list(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    except csv.Error:
        return []
    return [cell.strip() for cell in rows[0]] if rows else []


def wanted_columns(columns: ColumnMap) -> tuple[Quantity, ...]:
    """Channels that are read from columns: all, or all but time where a rate is stated."""
    return tuple(q for q in QUANTITIES if q != "time" or stated_rate_hz(columns) is None)


def _name(column: Column | None) -> str:
    return column.header_or_number if column and isinstance(column.header_or_number, str) else ""


def _candidates(row: _Row, quantity: Quantity, column: Column | None) -> list[int]:
    if column is None:
        return guess_column(row, quantity)
    if isinstance(column.header_or_number, int):
        return [column.header_or_number - 1] if column.header_or_number <= len(row) else []
    options = _name(column)
    exact = [i for i, cell in enumerate(row) if cell == options]
    return exact or [i for i, cell in enumerate(row) if cell.casefold() == options.casefold()]


def _only(path: Path, index: int, row: _Row, found: Candidates) -> dict[Quantity, int]:
    for quantity, columns in found.items():
        if len(columns) > 1:
            names = ", ".join(f"{i + 1} {row[i]!r}" for i in columns[:_MAX_NAMED])
            raise DataError(
                f"{path}, row {index + 1}: {quantity} may be column {names}: "
                f"choose by number, --map {quantity}={columns[0] + 1}:UNIT"
            )
    return {quantity: columns[0] for quantity, columns in found.items()}


def _missing(path: Path, index: int, found: Candidates, row: _Row, columns: ColumnMap) -> DataError:
    missing = [q + (f" ({_name(columns.get(q))!r})" if _name(columns.get(q)) else "")
               for q in QUANTITIES if q in wanted_columns(columns) and q not in found]  # fmt: skip
    names = ", ".join(map(repr, row[:_MAX_NAMED])) + (", ..." if row[_MAX_NAMED:] else "")
    header = f" in row {index + 1}, which has {names}" if row else ""
    return DataError(
        f"{path}: found no column of {' or of '.join(missing)}{header}: pass --map {EXAMPLE}, "
        "where COL is a header or a column's number"
    )


def _layout_by_numbers(
    path: Path, head: Sequence[str], columns: ColumnMap, decimal: DecimalMark | None
) -> Layout:
    """Find the first row with numbers in all columns; the row above it is the header."""
    chosen = {q: int(columns[q].header_or_number) - 1 for q in wanted_columns(columns)}
    for index in range(len(head)):
        for delimiter in DELIMITERS:
            row = cells(head[index], delimiter)
            if len(row) <= max(chosen.values()):
                continue
            if all(is_number(row[i]) or is_comma_number(row[i]) for i in chosen.values()):
                return _layout(path, head, delimiter, index - 1, chosen, columns, decimal)
    numbers = ", ".join(str(i + 1) for i in chosen.values())
    raise DataError(
        f"{path}: no row has numbers in columns {numbers} (first {len(head)} rows read): "
        f"correct --map {EXAMPLE}"
    )


def _layout(
    path: Path,
    head: Sequence[str],
    delimiter: str,
    header_index: int,
    chosen: dict[Quantity, int],
    columns: ColumnMap,
    decimal: DecimalMark | None,
) -> Layout:
    if len(set(chosen.values())) < len(chosen):
        raise DataError(f"{path}: two channels would come from one column: correct --map")
    header = cells(head[header_index], delimiter) if header_index >= 0 else []
    first = header_index + 1
    while first < len(head) - 1 and not head[first].strip():
        first += 1
    below = cells(head[first], delimiter) if first < len(head) else []
    unit_row = _unit_row(below, chosen)
    if unit_row:
        first += 1
    units = column_units(path, header, chosen, columns, unit_row)
    found = []
    for quantity, index in chosen.items():
        name = f"{header[index]!r} " if header[index:] and header[index] else ""
        found.append(f"{quantity} = column {index + 1} {name}in {units[quantity].text}")
    mark: DecimalMark = "point"
    if delimiter != ",":
        mark = decimal or _decimal(path, head, delimiter, first, chosen)
    between = f"{DELIMITERS[delimiter]} between cells, "
    between += "decimal comma, " if mark == "comma" else ""
    return Layout(
        delimiter,
        width=len(header) if max(chosen.values()) < len(header) else len(below),
        first_line=first + 1,
        columns=chosen,
        units=units,
        guess=f"{', '.join(found)}; {between}numbers from row {first + 1}",
        decimal=mark,
        unread_time=None if "time" in chosen else _time_beside(header),
    )


def _time_beside(header: _Row) -> tuple[int, str] | None:
    found = guess_column(header, "time")
    return (found[0], header[found[0]]) if len(found) == 1 else None


def _decimal(
    path: Path, head: Sequence[str], delimiter: str, first: int, chosen: dict[Quantity, int]
) -> DecimalMark:
    rows = [(n, cells(line, delimiter)) for n, line in enumerate(head[first:], first + 1)]
    numbers = [(n, row[i]) for n, row in rows for i in chosen.values() if i < len(row)]
    return decimal_mark(str(path), numbers)


def _unit_row(row: _Row, chosen: dict[Quantity, int]) -> dict[Quantity, str]:
    """Return the units in the row below the header, or nothing where it is not a row of units."""
    if len(row) <= max(chosen.values()):
        return {}
    units = {quantity: row[index].strip("()[]{} ") for quantity, index in chosen.items()}
    if any(is_number(unit) or is_comma_number(unit) or not unit for unit in units.values()):
        return {}
    return units if any(is_unit(unit, quantity) for quantity, unit in units.items()) else {}
