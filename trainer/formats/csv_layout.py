"""Where a CSV file's header, columns, units and first row of numbers are: given, else guessed."""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from springpot.runtime_c.errors import DataError
from springpot.trainer.formats.column_map import EXAMPLE, Column, ColumnMap
from springpot.trainer.formats.units import QUANTITIES, Quantity, factor_to_si, is_unit

DELIMITERS = {"\t": "tab", ";": "semicolon", ",": "comma"}
_LABELS: dict[Quantity, set[str]] = {
    "time": {"time", "t", "timestamp"},
    "position": {
        *("position", "pos", "displacement", "disp", "depth", "penetration", "indentation"),
        *("compression", "extension", "stroke", "x", "z"),
    },
    "force": {"force", "load", "f", "fz"},
}
# "Compression stress" and "Extension rate" are neither positions nor forces.
_NOT_A_LABEL = {"stress", "strain", "rate", "speed", "velocity", "setpoint", "command"}
_BRACKETED_UNIT = re.compile(r"(.*?)[\s_,/]*[(\[{]\s*([^()\[\]{}]+?)\s*[)\]}]")
_SEPARATED_UNIT = re.compile(r"(.+?)\s*[,/]\s*([^,/]+)")
_APPENDED_UNIT = re.compile(r"(.+)[\s_]([^\s_]+)")

Row = list[str]
Candidates = dict[Quantity, list[int]]


@dataclass(frozen=True)
class Layout:
    """How to read a file: cells to a row, 1-based line of the first numbers, columns from 0."""

    delimiter: str
    width: int
    first_line: int
    columns: dict[Quantity, int]
    factors: dict[Quantity, float]
    guess: str


def find_layout(path: Path, head: Sequence[str], columns: ColumnMap) -> Layout:
    """Find the layout from the file's first lines; `columns` overrides the guess.

    Raises DataError where a column or a unit is missing, unknown or ambiguous.
    """
    if columns.keys() == set(QUANTITIES) and not any(_name(c) for c in columns.values()):
        return _layout_by_numbers(path, head, columns)
    best: tuple[int, Candidates, Row] = (0, {}, [])
    for index in range(len(head)):
        for delimiter in DELIMITERS:
            row = cells(head[index], delimiter)
            if len(row) < len(QUANTITIES):
                continue
            found = {q: _candidates(row, q, columns.get(q)) for q in QUANTITIES}
            found = {q: candidates for q, candidates in found.items() if candidates}
            if len(found) == len(QUANTITIES):
                chosen = _only(path, index, row, found)
                return _layout(path, head, delimiter, index, chosen, columns)
            if len(found) > len(best[1]):
                best = (index, found, row)
    raise _missing(path, *best, columns)


def cells(line: str, delimiter: str) -> Row:
    """Split one line; quoted cells keep their delimiters."""
    rows = list(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    return [cell.strip() for cell in rows[0]] if rows else []


def is_number(cell: str) -> bool:
    """Tell whether a cell is a number, NaN and infinity included."""
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell  # Python reads 1_000, nobody else does


def split_unit(header: str, quantity: Quantity) -> tuple[str, str | None]:
    """Split "Time (s)", "Load [N]", "Time, s" or "position_mm" into label and unit."""
    for pattern in (_BRACKETED_UNIT, _SEPARATED_UNIT):
        if match := pattern.fullmatch(header):
            return match[1], match[2]
    match = _APPENDED_UNIT.fullmatch(header)
    if match and is_unit(match[2], quantity):
        return match[1], match[2]
    return header, None


def _name(column: Column | None) -> str:
    return column.header_or_number if column and isinstance(column.header_or_number, str) else ""


def _candidates(row: Row, quantity: Quantity, column: Column | None) -> list[int]:
    if column is None:
        return _guess(row, quantity)
    if isinstance(column.header_or_number, int):
        return [column.header_or_number - 1] if column.header_or_number <= len(row) else []
    wanted = _name(column)
    exact = [i for i, cell in enumerate(row) if cell == wanted]
    return exact or [i for i, cell in enumerate(row) if cell.casefold() == wanted.casefold()]


def _guess(row: Row, quantity: Quantity) -> list[int]:
    """Prefer a label that is one of the known words to one that only contains such a word."""
    labels = [split_unit(cell, quantity)[0].casefold().strip() for cell in row]
    exact = [i for i, label in enumerate(labels) if label in _LABELS[quantity]]
    if exact:
        return exact
    words = [set(re.split(r"[^a-z]+", label)) for label in labels]
    return [i for i, w in enumerate(words) if w & _LABELS[quantity] and not w & _NOT_A_LABEL]


def _only(path: Path, index: int, row: Row, found: Candidates) -> dict[Quantity, int]:
    for quantity, columns in found.items():
        if len(columns) > 1:
            names = ", ".join(f"{i + 1} {row[i]!r}" for i in columns)
            raise DataError(
                f"{path}, row {index + 1}: {quantity} may be column {names}: "
                f"choose by number, --map {quantity}={columns[0] + 1}:UNIT"
            )
    return {quantity: columns[0] for quantity, columns in found.items()}


def _missing(path: Path, index: int, found: Candidates, row: Row, columns: ColumnMap) -> DataError:
    missing = [q + (f" ({_name(columns.get(q))!r})" if _name(columns.get(q)) else "")
               for q in QUANTITIES if q not in found]  # fmt: skip
    header = f" in row {index + 1}, which has {', '.join(map(repr, row))}" if row else ""
    return DataError(
        f"{path}: found no column of {' or of '.join(missing)}{header}: pass --map {EXAMPLE}, "
        "where COL is a header or a column's number"
    )


def _layout_by_numbers(path: Path, head: Sequence[str], columns: ColumnMap) -> Layout:
    """Find the first row with numbers in all three columns; the row above it is the header."""
    chosen = {q: int(c.header_or_number) - 1 for q, c in columns.items()}
    for index in range(len(head)):
        for delimiter in DELIMITERS:
            row = cells(head[index], delimiter)
            if len(row) > max(chosen.values()) and all(is_number(row[i]) for i in chosen.values()):
                return _layout(path, head, delimiter, index - 1, chosen, columns)
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
    units = {}
    for quantity, index in chosen.items():
        column = columns.get(quantity)
        label = header[index] if index < len(header) else ""
        in_header = split_unit(label, quantity)[1] or ""
        given = (column.unit if column else None) or in_header or unit_row.get(quantity, "")
        where = f"{path}, column {index + 1}{f' {label!r}' if label else ''}"
        units[quantity] = given, factor_to_si(given, quantity, where), f"{label!r} " * bool(label)
    guess = ", ".join(
        f"{quantity} = column {chosen[quantity] + 1} {label}in {unit}"
        for quantity, (unit, _, label) in units.items()
    )
    return Layout(
        delimiter,
        width=len(header) if max(chosen.values()) < len(header) else len(below),
        first_line=first + 1,
        columns=chosen,
        factors={quantity: factor for quantity, (_, factor, _) in units.items()},
        guess=f"{guess}; {DELIMITERS[delimiter]} between cells, numbers from row {first + 1}",
    )


def _unit_row(row: Row, chosen: dict[Quantity, int]) -> dict[Quantity, str]:
    """Return the units in the row below the header, or nothing where it is not a row of units."""
    if len(row) <= max(chosen.values()):
        return {}
    units = {quantity: row[index].strip("()[]{} ") for quantity, index in chosen.items()}
    if any(is_number(unit) or not unit for unit in units.values()):
        return {}
    return units if any(is_unit(unit, quantity) for quantity, unit in units.items()) else {}
