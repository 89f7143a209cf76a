"""Where a CSV file's header, columns, units and first row of numbers are: given, else guessed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from springpot.codegen.errors import DataError
from springpot.codegen.plurals import number_of
from springpot.trainer.recordings.formats.column_map import (
    MAP_EXAMPLE,
    Column,
    column_units,
    guess_column,
)
from springpot.trainer.recordings.formats.csv.clock import is_clock
from springpot.trainer.recordings.formats.csv.csv_lines import (
    DELIMITERS,
    Cells,
    above_numbers,
    cells,
    is_value,
    split_line,
    with_places,
    without_comment_marks,
    without_mark,
)
from springpot.trainer.recordings.formats.csv.csv_missing import (
    Candidates,
    is_json,
    missing_columns,
    stated_header,
    wanted_columns,
    which_column,
)
from springpot.trainer.recordings.formats.csv.csv_units import (
    clock_units,
    labview_units,
    pair_columns,
    unit_row,
)
from springpot.trainer.recordings.formats.csv.decimals import DecimalMark, decimal_mark
from springpot.trainer.recordings.formats.csv.stress import require_no_stress
from springpot.trainer.recordings.formats.file_request import FileRequest
from springpot.trainer.recordings.formats.units import CLOCK, Quantity, Unit

_LINES = 400  # of numbers, that show their mark of decimals
_ABOVE = 50  # lines of a LabVIEW header
_SHOWN = 4  # columns that are not read
_COMMENT = "comment"  # LabVIEW's last column, in which few rows have a cell


@dataclass(frozen=True)
class Layout:
    """Layout of a table: cells to a row, 1-based line of the first numbers, columns from 0.

    stated: somebody stated the mark of decimals. clock: times are a clock's stamps. beside: other
    tests stand beside, and rows may end where only they have numbers.
    """

    delimiter: str
    width: int
    first_line: int
    columns: dict[Quantity, int]
    units: dict[Quantity, Unit]
    guess: str
    decimal: DecimalMark
    stated: bool
    clock: bool
    beside: bool
    unread_time: tuple[int, str] | None  # a column of time and its header, where a rate is stated
    # Columns place_x and place_y, and their factors to m.
    place: tuple[tuple[int, float], ...] = ()


def find_layout(
    path: Path, head: Sequence[str], request: FileRequest, among: Sequence[int] = ()
) -> Layout:
    """Find the layout from the file's first lines; what is requested overrides the guess.

    Where the map states a rate, no column of time is needed. among: of `head`, the lines that may
    be the header; none: all.
    Raises DataError where a column or a unit is missing, unknown or ambiguous, and of those
    MissingColumnsError if no line names all columns.
    """
    columns = request.columns
    options = wanted_columns(columns)
    among = among or range(len(head))
    head = without_comment_marks(head, among)
    if request.place:
        head = with_places(path, head, among, request.place)
    if all(q in columns and not stated_header(columns[q]) for q in options):
        return _layout_by_numbers(path, head, request, among[0])
    best: tuple[int, Candidates, Cells] = (0, {}, [])
    for index in among:
        for delimiter, row in split_line(head, index):
            found = {q: _candidates(row, q, columns.get(q)) for q in options}
            found = {q: candidates for q, candidates in found.items() if candidates}
            if len(found) == len(options) <= len(row):
                chosen = {q: candidates[0] for q, candidates in found.items()}
                if any(len(candidates) > 1 for candidates in found.values()):
                    raise which_column(path, index, row, found)
                return _layout(path, head, delimiter, index, chosen, request)
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
    stated = stated_header(column)
    options = (stated, without_mark(stated))
    exact = [i for i, cell in enumerate(row) if cell in options]
    folded = [option.casefold() for option in options]
    return exact or [i for i, cell in enumerate(row) if cell.casefold() in folded]


def _layout_by_numbers(path: Path, head: Sequence[str], request: FileRequest, begin: int) -> Layout:
    """Find the first row with numbers in all columns; the row above it is the header."""
    columns = request.columns
    chosen = {q: int(columns[q].header_or_number) - 1 for q in wanted_columns(columns)}
    for index in range(begin, len(head)):
        for delimiter, row in split_line(head, index):
            if len(row) <= max(chosen.values()):
                continue
            if all(is_value(row[i]) for i in chosen.values()):
                header = index - 1
                while header > begin and not head[header].strip():
                    header -= 1
                return _layout(path, head, delimiter, header, chosen, request)
    numbers = ", ".join(str(i + 1) for i in chosen.values())
    raise DataError(
        f"{path}: no row has numbers in columns {numbers} ({number_of(len(head), 'row')} read): "
        f"correct --map {MAP_EXAMPLE}"
    )


def _layout(
    path: Path,
    head: Sequence[str],
    delimiter: str,
    header_index: int,
    chosen: dict[Quantity, int],
    request: FileRequest,
) -> Layout:
    columns = request.columns
    if len(set(chosen.values())) < len(chosen):
        raise DataError(f"{path}: two channels would come from one column: correct --map")
    header, below, first = _header_and_below(head, delimiter, header_index)
    units_below = unit_row(below, chosen)
    if units_below:
        first += 1
    rows = [cells(line, delimiter) for line in head[first : first + _LINES]] or [[]]
    clock = "time" in chosen and any(is_clock(cell) for cell in rows[0][chosen["time"] :][:1])
    stated_units = units_below or labview_units(
        head[max(header_index - _ABOVE, 0) : max(header_index, 0)], delimiter, chosen
    )
    if clock:
        header, columns, stated_units = clock_units(header, columns, stated_units, chosen["time"])
    labels = {q: header[index] if index < len(header) else "" for q, index in chosen.items()}
    require_no_stress(str(path), labels, stated_units, columns)
    units = column_units(path, header, chosen, columns, stated_units)
    if clock:
        units["time"] = replace(units["time"], origin=CLOCK)
    numbers = [
        (n, row[i]) for n, row in enumerate(rows, first + 1) for i in chosen.values() if row[i:]
    ]
    mark = request.decimal
    if mark is None or (delimiter == "," and not any("," in cell for _, cell in numbers)):
        mark = decimal_mark(str(path), numbers)
    between = f"{DELIMITERS[delimiter]} between cells, "
    between += "decimal comma, " if mark == "comma" else ""
    under = below if units_below else []
    place = pair_columns(path, header, under, "place", "position")
    taken = {*chosen.values(), *(index for index, _ in place)}
    unread = [name for index, name in enumerate(header) if index not in taken and name]
    return Layout(
        delimiter,
        width=len(header) if max(chosen.values()) < len(header) else len(below),
        first_line=first + 1,
        columns=chosen,
        units=units,
        guess=f"{_understood(labels, chosen, units, clock)}; {between}numbers from row {first + 1}"
        f"{_not_read(unread)}",
        decimal=mark,
        stated=request.decimal is not None,
        clock=clock,
        beside=len(guess_column(header, "time")) > 1,
        unread_time=None if "time" in chosen else _time_beside(header),
        place=place,
    )


def _header_and_below(
    head: Sequence[str], delimiter: str, header_index: int
) -> tuple[Cells, Cells, int]:
    """Return the header, the first row below it that has cells, and the index of its line."""
    header = cells(head[header_index], delimiter) if header_index >= 0 else []
    first = header_index + 1
    while first < len(head) - 1 and not head[first].strip():
        first += 1
    below = cells(head[first], delimiter) if first < len(head) else []
    if header and header[-1].casefold() in ("", _COMMENT) and len(below) == len(header) - 1:
        header = header[:-1]  # a column without cells, or a delimiter at the header's end, is none
    return header, below, first


def _understood(
    labels: dict[Quantity, str],
    chosen: dict[Quantity, int],
    units: dict[Quantity, Unit],
    clock: bool,
) -> str:
    found = []
    for quantity, index in chosen.items():
        name = f"{labels[quantity]!r} " if labels[quantity] else ""
        found.append(f"{quantity} = column {index + 1} {name}in {units[quantity].text}")
        if clock and quantity == "time":
            found[-1] += " after its first clock stamp"
    return ", ".join(found)


def _not_read(names: Sequence[str]) -> str:
    """Name the columns that nothing is taken from, as far as a line has room."""
    shown = ", ".join(repr(name) for name in names[:_SHOWN])
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return f"; not read: {shown}{more}" if names else ""


def _time_beside(header: Cells) -> tuple[int, str] | None:
    found = guess_column(header, "time")
    return (found[0], header[found[0]]) if len(found) == 1 else None
