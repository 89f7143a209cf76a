"""Where a CSV file's header, columns, units and first row of numbers are: given, else guessed."""

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
    split_unit,
)
from springpot.trainer.recordings.formats.csv.csv_lines import (
    DELIMITERS,
    Cells,
    above_numbers,
    cells,
    split_line,
)
from springpot.trainer.recordings.formats.csv.csv_missing import (
    MAX_NAMED,
    Candidates,
    is_json,
    missing_columns,
    stated_header,
    wanted_columns,
)
from springpot.trainer.recordings.formats.csv.decimals import (
    DecimalMark,
    decimal_mark,
    is_comma_number,
    is_number,
)
from springpot.trainer.recordings.formats.specimen import Specimen, require_no_stress
from springpot.trainer.recordings.formats.units import (
    OF_SPECIMEN,
    Quantity,
    Unit,
    factor_to_si,
    is_unit,
)

_COMMENT = "comment"  # LabVIEW's last column, in which few rows have a cell


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
    place: tuple[tuple[int, float], ...] = ()  # columns place_x and place_y, and their factors to m


def find_layout(
    path: Path,
    head: Sequence[str],
    columns: ColumnMap,
    decimal: DecimalMark | None = None,
    specimen: Specimen | None = None,
) -> Layout:
    """Find the layout from the file's first lines; `columns` and `decimal` override the guess.

    Where `columns` states a rate, no column of time is needed; with a specimen's sizes, stress and
    strain are force and position.
    Raises DataError where a column or a unit is missing, unknown or ambiguous.
    """
    options = wanted_columns(columns)
    if all(q in columns and not stated_header(columns[q]) for q in options):
        return _layout_by_numbers(path, head, columns, decimal, specimen)
    best: tuple[int, Candidates, Cells] = (0, {}, [])
    for index in range(len(head)):
        for delimiter, row in split_line(head, index):
            stated = specimen.columns(row, columns) if specimen else columns
            found = {q: _candidates(row, q, stated.get(q)) for q in options}
            found = {q: candidates for q, candidates in found.items() if candidates}
            if len(found) == len(options) <= len(row):
                chosen = _only(path, index, row, found)
                return _layout(path, head, delimiter, index, chosen, stated, decimal, specimen)
            if len(found) > len(best[1]):
                best = (index, found, row)
    index, row = above_numbers(head)
    there = {q: its for q in options if (its := _candidates(row, q, columns.get(q)))}
    if len(there) >= len(best[1]):  # the likelier header: numbers follow it
        best = (index, there, row)
    if is_json(path):
        raise DataError(f"{path}: JSON, no table: save it as CSV, one row a sample, in its program")
    raise missing_columns(path, *best, columns)


def _candidates(row: Cells, quantity: Quantity, column: Column | None) -> list[int]:
    if column is None:
        return guess_column(row, quantity)
    if isinstance(column.header_or_number, int):
        return [column.header_or_number - 1] if column.header_or_number <= len(row) else []
    options = stated_header(column)
    exact = [i for i, cell in enumerate(row) if cell == options]
    return exact or [i for i, cell in enumerate(row) if cell.casefold() == options.casefold()]


def _only(path: Path, index: int, row: Cells, found: Candidates) -> dict[Quantity, int]:
    for quantity, columns in found.items():
        if len(columns) > 1:
            names = ", ".join(f"{i + 1} {row[i]!r}" for i in columns[:MAX_NAMED])
            raise DataError(
                f"{path}, row {index + 1}: {quantity} may be column {names}: "
                f"choose by number, --map {quantity}={columns[0] + 1}:UNIT"
            )
    return {quantity: columns[0] for quantity, columns in found.items()}


def _layout_by_numbers(
    path: Path,
    head: Sequence[str],
    columns: ColumnMap,
    decimal: DecimalMark | None,
    specimen: Specimen | None,
) -> Layout:
    """Find the first row with numbers in all columns; the row above it is the header."""
    chosen = {q: int(columns[q].header_or_number) - 1 for q in wanted_columns(columns)}
    for index in range(len(head)):
        for delimiter, row in split_line(head, index):
            if len(row) <= max(chosen.values()):
                continue
            if all(is_number(row[i]) or is_comma_number(row[i]) for i in chosen.values()):
                return _layout(path, head, delimiter, index - 1, chosen, columns, decimal, specimen)
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
    specimen: Specimen | None,
) -> Layout:
    if len(set(chosen.values())) < len(chosen):
        raise DataError(f"{path}: two channels would come from one column: correct --map")
    header = cells(head[header_index], delimiter) if header_index >= 0 else []
    first = header_index + 1
    while first < len(head) - 1 and not head[first].strip():
        first += 1
    below = cells(head[first], delimiter) if first < len(head) else []
    if header and header[-1].casefold() in ("", _COMMENT) and len(below) == len(header) - 1:
        header = header[:-1]  # a column without cells, or a delimiter at the header's end, is none
    unit_row = _unit_row(below, chosen)
    if unit_row:
        first += 1
    labels = {q: header[index] if index < len(header) else "" for q, index in chosen.items()}
    if specimen:
        columns = specimen.in_si(labels, unit_row, columns)
    else:
        require_no_stress(str(path), labels, unit_row, columns)
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
        place=_place_columns(path, header, below if unit_row else []),
    )


def _place_columns(path: Path, header: Cells, unit_row: Cells) -> tuple[tuple[int, float], ...]:
    """Columns that say where the object was pressed, x and y, and factors to m; none without."""
    labels = [split_unit(cell, "position") for cell in header]
    found = []
    for name in ("place_x", "place_y"):
        for index, (label, unit) in enumerate(labels):
            if label.casefold() == name:
                below = unit_row[index].strip("()[]{} ") if index < len(unit_row) else ""
                where = f"{path}, column {header[index]!r}"
                found.append((index, factor_to_si(unit or below, "position", where)))
    if len(found) == 1:
        raise DataError(f"{path}: a place has place_x and place_y: add the other column")
    return tuple(found[:2])


def _time_beside(header: Cells) -> tuple[int, str] | None:
    found = guess_column(header, "time")
    return (found[0], header[found[0]]) if len(found) == 1 else None


def _decimal(
    path: Path, head: Sequence[str], delimiter: str, first: int, chosen: dict[Quantity, int]
) -> DecimalMark:
    rows = [(n, cells(line, delimiter)) for n, line in enumerate(head[first:], first + 1)]
    numbers = [(n, row[i]) for n, row in rows for i in chosen.values() if i < len(row)]
    return decimal_mark(str(path), numbers)


def _unit_row(row: Cells, chosen: dict[Quantity, int]) -> dict[Quantity, str]:
    """Return the units in the row below the header, or nothing where it is not a row of units."""
    if len(row) <= max(chosen.values()):
        return {}
    units = {quantity: row[index].strip("()[]{} ") for quantity, index in chosen.items()}
    if any(is_number(unit) or is_comma_number(unit) or not unit for unit in units.values()):
        return {}
    known = (is_unit(unit, q) or unit.casefold() in OF_SPECIMEN[q] for q, unit in units.items())
    return units if any(known) else {}
