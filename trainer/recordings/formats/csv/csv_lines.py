"""Lines of a CSV file as cells, by each delimiter that may separate them."""

import csv
import io
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import split_unit
from springpot.trainer.recordings.formats.csv.clock import is_clock
from springpot.trainer.recordings.formats.csv.decimals import (
    is_comma_number,
    is_grouped,
    is_number,
)

DELIMITERS = {"\t": "tab", ";": "semicolon", ",": "comma", "|": "bar", " ": "space"}
_BRACKETS = ("[", "(")
_MIN_COLUMNS, _MAX_COLUMNS = 2, 1024
_COMMENT = re.compile(r"\s*#+ *(?=[^\s,;|])")
Cells = list[str]


def without_comment_marks(head: Sequence[str], among: Sequence[int]) -> Sequence[str]:
    """Take the marks off lines such as "# time_s position_m force_N", as numpy.savetxt writes them.

    A mark with a column of its own is a name: "# time position" above three numbers.
    """
    if not any(_COMMENT.match(head[index]) for index in among):
        return head
    found: list[str] = []
    below = 0  # words of the row below
    for line in reversed(head):
        mark, words = _COMMENT.match(line), len(line.split())
        is_name = mark and mark[0].endswith(" ") and words == below
        found.append(line[mark.end() :] if mark and not is_name else line)
        below = below if mark else words
    return found[::-1]


def with_places(
    path: Path, head: Sequence[str], among: Sequence[int], place: tuple[str, str]
) -> Sequence[str]:
    """Call two columns place_x and place_y, in the header that has both.

    Raises DataError if no line has.
    """
    stated = dict(zip((name.casefold() for name in place), ("place_x", "place_y"), strict=True))
    for index in among:
        for delimiter, row in split_line(head, index):
            if not stated.keys() <= {cell.casefold() for cell in row}:
                continue
            renamed = [_called(stated.get(cell.casefold()), cell) for cell in row]
            text = io.StringIO()
            csv.writer(text, delimiter=delimiter, lineterminator="").writerow(renamed)
            return [*head[:index], text.getvalue(), *head[index + 1 :]]
    raise DataError(f"{path}: no header has columns {place[0]!r} and {place[1]!r}: correct --place")


def _called(name: str | None, header: str) -> str:
    unit = split_unit(header, "position")[1]
    return header if name is None else f"{name} [{unit}]" if unit else name


def cells(line: str, delimiter: str) -> Cells:
    """Split one line; quoted cells keep their delimiters. None where one is too long for a cell."""
    try:
        rows = list(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    except csv.Error:
        return []
    row = [cell.strip() for cell in rows[0]] if rows else []
    if delimiter == " " and any(cell.startswith(_BRACKETS) for cell in row[1:]):
        return _with_units(row)
    return row


def without_mark(header: str) -> str:
    """The header without a comment's mark before it."""
    return _COMMENT.sub("", header, 1)


def _with_units(row: Cells) -> Cells:
    """Cells between spaces where "time [s]" is one."""
    found = row[:1]
    for cell in row[1:]:
        if cell.startswith(_BRACKETS):
            found[-1] += f" {cell}"
        else:
            found.append(cell)
    return found


def split_line(head: Sequence[str], index: int) -> Iterator[tuple[str, Cells]]:
    """Yield each delimiter that may separate the cells of a line, and the cells.

    A space does so only above a row of as many numbers: sentences have spaces, too.
    """
    for delimiter in DELIMITERS:
        row = cells(head[index], delimiter)
        if not _MIN_COLUMNS <= len(row) <= _MAX_COLUMNS:
            continue
        if delimiter == " ":
            below = cells(head[index + 1], " ") if index + 1 < len(head) else []
            if len(below) != len(row) or not all(map(is_value, below)):
                continue
        yield delimiter, row


def above_numbers(head: Sequence[str]) -> tuple[int, Cells]:
    """Find a header of other words: the fullest of the three rows above the first of numbers."""
    for index in range(len(head)):
        for delimiter, row in split_line(head, index):
            if not all(map(is_value, row[:-1] if not row[-1] else row)):
                continue
            above = [(at, cells(head[at], delimiter)) for at in range(max(index - 3, 0), index)]
            words = [
                (at, one)
                for at, one in above
                if len(one) <= len(row) and not any(map(is_value, one))
            ]
            if words:
                return max(words, key=lambda found: sum(map(bool, found[1])))
    return 0, []


def is_value(cell: str) -> bool:
    """Return whether a cell is a number with either mark of decimals, or a clock's stamp."""
    number = is_number(cell) or is_comma_number(cell)
    return number or is_grouped(cell, "point") or is_grouped(cell, "comma") or is_clock(cell)
