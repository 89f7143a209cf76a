"""The tables of a CSV file that is not numbers to its end: text behind them, further blocks."""

import csv
import re
from collections.abc import Sequence
from itertools import islice
from pathlib import Path

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.csv.csv_layout import Layout, find_layout
from springpot.trainer.recordings.formats.csv.csv_lines import Cells, cells, is_value
from springpot.trainer.recordings.formats.csv.csv_missing import MAX_NAMED, MissingColumnsError
from springpot.trainer.recordings.formats.csv.csv_table import CsvTable
from springpot.trainer.recordings.formats.file_request import FileRequest
from springpot.trainer.recordings.formats.sampling import MIN_ROWS

_HEADER_ROWS = 3  # names, units and one more
_WORD = re.compile(r"[^\W\d_]{2}|\D*$")
_LONGEST = 40  # letters of a line in a message


def tables_of(whole: CsvTable, request: FileRequest) -> tuple[list[CsvTable], str]:
    """Split a file into its tables, and say what is left out of it.

    A block of numbers with a header of its own is a table. Left out are text behind the last
    numbers, and blocks with other columns. Raises DataError for text in the middle of numbers.
    """
    path, layout = whole.path, whole.layout
    with path.open(encoding=whole.encoding, newline="") as file:
        lines = list(file)
    tables: list[CsvTable] = []
    left_out: list[str] = []
    found: Layout | None = layout
    while found is not None:
        layout, begin = found, found.first_line - 1
        end, text = _ends(lines, begin, layout)
        tables.append(CsvTable(path, layout, whole.encoding, lines[begin:end]))
        found = None
        while found is None and text < len(lines):
            numbers = _run_of_numbers(lines, text, layout)
            if not numbers:
                left_out.append(f"text from row {text + 1} on, {_short(lines[text])}")
                break
            found = _block(path, lines, range(end, numbers.start), numbers, request, layout)
            if found is None:
                left_out.append(f"other columns from row {text + 1} on, {_short(lines[text])}")
            end = text = numbers.stop
    return _long_enough(tables, left_out)


def _ends(lines: Sequence[str], begin: int, layout: Layout) -> tuple[int, int]:
    """Where the numbers end, without empty rows, and where the text behind them begins."""
    reader = csv.reader(lines[begin:], delimiter=layout.delimiter)
    end = text = begin
    try:
        for row in reader:
            if _is_text(row, layout):
                return end, text
            text = begin + reader.line_num
            if any(row[i].strip() for i in layout.columns.values() if i < len(row)):
                end = text
    except csv.Error:  # a cell that is too long: said when the rows are read
        return len(lines), len(lines)
    return end, len(lines)


def _is_text(row: Cells, layout: Layout) -> bool:
    """Tell a row of words from one of numbers in which something is wrong.

    The first channel's cell is a word, 'Maximum load', '8.12', 'N': one without digits, or that
    begins with two letters. If it stands alone in its row, it is text if it is no number.
    """
    first = layout.columns.get("time", layout.columns["position"])
    word = _WORD.match("".join(row[first:][:1]).strip())
    if word is None and sum(map(bool, row)) > 1:
        return False
    return not all(is_value(cell.strip()) for cell in row if cell.strip())


def _run_of_numbers(lines: Sequence[str], begin: int, layout: Layout) -> range:
    """The first rows of numbers from a line on: of any table, so they begin with two numbers."""
    first = last = begin
    for first in range(begin, len(lines)):
        last = first
        while last < len(lines) and _is_numbers(lines[last], layout):
            last += 1
        if last > first:
            break
    return range(first, last)


def _is_numbers(line: str, layout: Layout) -> bool:
    row = cells(line, layout.delimiter)
    found = [cell for cell in row if cell]
    of_layout = len(row) >= layout.width and all(is_value(row[i]) for i in layout.columns.values())
    return of_layout or (len(found) > 1 and all(map(is_value, found[:2])))


def _block(
    path: Path,
    lines: Sequence[str],
    text: range,
    numbers: range,
    request: FileRequest,
    layout: Layout,
) -> Layout | None:
    """Layout of numbers behind text, whose end is their header; None for other columns.

    Raises DataError for a line that is no header: the numbers would go on behind it.
    """
    above = [lines[i] for i in text if lines[i].strip()]
    first = cells(lines[numbers.start], layout.delimiter)
    rows = [cells(line, layout.delimiter) for line in above[-_HEADER_ROWS:]]
    words = [
        sum(map(bool, row))
        for row in rows
        if abs(len(row) - len(first)) < 2 and not any(map(is_value, row))
    ]
    apart = len(above) < len(text)  # by an empty line
    if max(words, default=0) > 1 and (apart or len(above) > 1):
        try:
            return find_layout(path, lines, request, text)
        except MissingColumnsError:
            # 'Event', 'pause' above numbers of the same columns heads no other table.
            named = max(words) >= sum(map(bool, first)) - (len(first) != layout.width)
            if named and (apart or len(numbers) < MIN_ROWS):
                return None
    line = next(i for i in text if lines[i].strip())
    raise DataError(
        f"{path}, row {line + 1}: {_short(lines[line])} stands in the middle of numbers: correct "
        "that row in the source"
    )


def _short(line: str) -> str:
    words = " ".join(line.replace('"', "").split())
    return repr(words if len(words) <= _LONGEST else f"{words[:_LONGEST]}...")


def _long_enough(tables: list[CsvTable], left_out: list[str]) -> tuple[list[CsvTable], str]:
    """The tables with rows enough for a recording, or all where no table has."""
    whole = [table for table in tables if len(list(islice(table.rows(), MIN_ROWS))) == MIN_ROWS]
    if whole:
        left_out += [
            f"fewer than {MIN_ROWS} rows from row {table.layout.first_line} on"
            for table in tables
            if table not in whole
        ]
    named = "; ".join(left_out[:MAX_NAMED]) + ("; ..." if left_out[MAX_NAMED:] else "")
    return whole or tables[:1], f"; left out: {named}" if left_out else ""
