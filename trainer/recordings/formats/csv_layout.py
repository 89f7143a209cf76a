"""Where a CSV file's header, columns, units and first row of numbers are: stated, else guessed."""

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import (
    MAP_EXAMPLE,
    Column,
    DecimalMark,
    FileRequest,
    choose_column_units,
    guess_columns,
    split_unit,
)
from springpot.trainer.recordings.formats.units import (
    QUANTITIES,
    Quantity,
    Unit,
    is_specimen_unit,
    is_unit,
    specimen_remedy,
)

Cells = list[str]
Found = tuple[dict[Quantity, list[int]], int, Cells]  # columns that may be a channel, in which row
# A point in a file of decimal commas is a mistake: made unreadable here.
COMMA_TO_POINT = str.maketrans({",": ".", ".": "!"})
_DELIMITERS = {"\t": "tab", ";": "semicolon", ",": "comma", "|": "bar", " ": "space"}
_HEAD_LINES = 400
_MAX_COLUMNS = 1024
_SHOWN = 12  # columns in a message
# Groups of three before a mark of decimals: alone they may be decimals of another mark.
_GROUPED: dict[DecimalMark, re.Pattern[str]] = {
    "point": re.compile(r"[+-]?\d{1,3}(?:,\d{3})+\.\d*"),
    "comma": re.compile(r"[+-]?\d{1,3}(?:\.\d{3})+,\d*"),
}
# A clock's time, with or without a date before it and a zone behind it; "12:30" alone is either.
_CLOCK = re.compile(
    r"(?:[\d./-]*\d[T ] *)?(?:(?P<h>\d{1,2}):(?P<m>\d{1,2}):(?P<s>\d{2}(?:[.,]\d+)?)"
    r"|(?P<m2>\d{1,3}):(?P<s2>\d{2}[.,]\d+))(?: ?(?P<half>[AP]M))?(?:Z|[+-]\d\d:?\d\d)?",
    re.I,
)
_SIGNAL = re.compile(r"Sig\d+\s+(\S.*?)\s*")  # TA Instruments: a channel in a line of its own
_COMMENT = re.compile(r"\s*#+ *(?=[^\s,;|])")
# Whole numbers in groups of three: decimals of the other mark, or separators of thousands.
GROUPS: dict[DecimalMark, re.Pattern[str]] = {
    "point": re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+"),
    "comma": re.compile(r"[+-]?[1-9]\d{0,2}(?:\.\d{3})+"),
}
_STRESS_WORDS = "stress|spannung|contrainte"
_HINTS = {
    "modul": "moduli over frequency or temperature are no recording: export the samples of the "
    "test, position and force over time",
}


class NoRecordingError(DataError):
    """A file has neither a position nor a force: in a folder it is left out."""


@dataclass(frozen=True)
class Layout:
    """Layout of a table: cells to a row, index of the first line of numbers, columns from 0.

    unit_row: the row of units below the header, empty without one. step_s: time between rows, if
    lines above the header say it; None: they do not.
    """

    delimiter: str
    width: int
    first_row: int
    header: Cells
    unit_row: Cells
    columns: Mapping[Quantity, int]
    units: Mapping[Quantity, Unit]
    decimal: DecimalMark
    step_s: float | None = None

    def without_time(self) -> "Layout":
        """The layout of a table whose rows are counted."""
        return replace(
            self,
            columns={q: i for q, i in self.columns.items() if q != "time"},
            units={q: unit for q, unit in self.units.items() if q != "time"},
        )

    def guess(self) -> str:
        """Write how the file was understood, and which columns are not read."""
        labels = dict(enumerate(self.header))
        channels = ", ".join(
            f"{q} = column {i + 1} {f'{labels[i]!r} ' if labels.get(i) else ''}in "
            f"{self.units[q].text}"
            for q, i in self.columns.items()
        )
        comma = ", decimal comma" if self.decimal == "comma" else ""
        unread = [repr(n) for k, n in labels.items() if n and k not in self.columns.values()]
        return (
            f"{channels}; {_DELIMITERS[self.delimiter]} between cells{comma}, numbers from row "
            f"{self.first_row + 1}" + f"; not read: {', '.join(unread[:_SHOWN])}" * bool(unread)
        )


def find_layout(path: Path, lines: Sequence[str], request: FileRequest) -> Layout:
    """Find the layout from the file's first lines; what is requested overrides the guess.

    Raises DataError if a column or a unit is missing, unknown or ambiguous: NoRecordingError if
    the header has neither a position nor a force.
    """
    head, wanted, columns = lines[:_HEAD_LINES], request.wanted, request.columns
    stated = [columns[q].header_or_number for q in wanted if q in columns]
    numbers = [column - 1 for column in stated if isinstance(column, int)]
    if len(numbers) == len(wanted):
        return _find_layout_by_numbers(path, head, dict(zip(wanted, numbers, strict=True)), request)
    hidden = [name.casefold() for name in request.place]
    best: Found = ({}, 0, [])
    for index in range(len(head)):
        for delimiter, row in _split_line(head, index):
            names = ["" if cell.casefold() in hidden else cell for cell in row]
            candidates = {
                q: indices for q in wanted if (indices := _match_columns(names, q, columns.get(q)))
            }
            if len(candidates) == len(wanted) - 1 and "time" in wanted and "time" not in candidates:
                below = split_cells("".join(head[index + 1 : index + 2]), delimiter)
                clocks = [i for i, cell in enumerate(below) if parse_clock_s(cell) is not None]
                candidates |= {"time": clocks} if clocks and "time" not in columns else {}
            if len(candidates) == len(wanted) <= len(row):
                for quantity, indices in candidates.items():
                    if len(indices) == 1:
                        continue
                    shown = ", ".join(f"{i + 1} {row[i]!r}" for i in indices[:_SHOWN])
                    place = ", or name those of the place, --place X,Y" * (quantity == "position")
                    raise DataError(
                        f"{path}, row {index + 1}: {quantity} may be column {shown}: choose by "
                        f"number, --map {quantity}={indices[0] + 1}:UNIT{place}"
                    )
                chosen = {q: indices[0] for q, indices in candidates.items()}
                return _build_layout(path, head, delimiter, row, index + 1, chosen, request)
            # A line about the test, "Load Cell;1 kN", has a channel's name, and fewer cells.
            if (len(candidates), sum(map(bool, row))) > (len(best[0]), sum(map(bool, best[2]))):
                best = (candidates, index, row)
    raise _missing_columns_error(path, head, best, request)


def _find_layout_by_numbers(
    path: Path, head: Sequence[str], chosen: Mapping[Quantity, int], request: FileRequest
) -> Layout:
    """Find the first row with numbers in all columns; the row above it is the header."""
    header_index = -1
    for index in range(len(head)):
        for delimiter, row in _split_line(head, index):
            if len(row) > max(chosen.values()) and all(is_value(row[i]) for i in chosen.values()):
                header = split_cells(_strip_comment(head[header_index]), delimiter) * (
                    header_index >= 0
                )
                values = [i for i in chosen.values() if i < len(header) and is_value(header[i])]
                if 2 * len(values) > len(chosen):
                    raise DataError(
                        f"{path}, row {header_index + 1}: numbers in some of the columns only: "
                        "correct or cut that row in the source"
                    )
                return _build_layout(
                    path, head, delimiter, header, header_index + 1, chosen, request
                )
        header_index = index if head[index].strip() else header_index
    raise _missing_columns_error(path, head, ({}, 0, []), request)


def _match_columns(row: Cells, quantity: Quantity, column: Column | None) -> list[int]:
    """Return the columns of a row that may be a channel, as stated or else guessed."""
    if column is None:
        return guess_columns(row, quantity)
    if isinstance(column.header_or_number, int):
        return [column.header_or_number - 1] if column.header_or_number <= len(row) else []
    stated = column.header_or_number
    options = (stated, _strip_comment(stated))
    exact = [i for i, cell in enumerate(row) if cell in options]
    folded = [option.casefold() for option in options]
    return exact or [i for i, cell in enumerate(row) if cell.casefold() in folded]


def _build_layout(
    path: Path,
    head: Sequence[str],
    delimiter: str,
    header: Cells,
    first: int,
    chosen: Mapping[Quantity, int],
    request: FileRequest,
) -> Layout:
    """Complete the layout once its columns are known: units, first row of numbers, decimal mark.

    Looks for a row of units below the header, and for a clock in the column of time.
    """
    if len(set(chosen.values())) < len(chosen):
        raise DataError(f"{path}: two channels would come from one column: correct --map")
    rows = [k for k in range(first, len(head)) if head[k].strip()] or [len(head)]
    below = split_cells(_strip_comment("".join(head[rows[0] : rows[0] + 1])), delimiter)
    if header and header[-1].casefold() in ("", "comment") and len(below) == len(header) - 1:
        header = header[:-1]  # a column without cells, or a delimiter at the header's end, is none
    width = len(header) if max(chosen.values()) < len(header) else len(below)
    units = {q: "".join(below[i : i + 1]).strip("()[]{} ") for q, i in chosen.items()}
    known = [is_unit(unit, q) or is_specimen_unit(unit, q) for q, unit in units.items()]
    other = [is_unit(unit, o) and not is_unit(unit, q) for q, unit in units.items()
             for o in QUANTITIES]  # fmt: skip
    if any(known) and not any(other) and not any(map(is_value, units.values())):
        rows = rows[1:] or [len(head)]
    else:
        units, below = {}, []
    numbers = [
        (k + 1, row[i])
        for k in rows
        for row in [split_cells("".join(head[k : k + 1]), delimiter)]
        for i in chosen.values()
        if i < len(row)
    ]
    stated = _read_stated(head[:first], delimiter)
    if not units and len(labels := stated.get("Y_Unit_Label", [])) > 1:
        units = {q: labels[i] for q, i in chosen.items() if i < len(labels) and q != "time"}
    first_stamp = next((row[chosen["time"]] for k in rows if "time" in chosen
                        for row in [split_cells(head[k] if k < len(head) else "", delimiter)]
                        if chosen["time"] < len(row)), "")  # fmt: skip
    described = list(header)
    if parse_clock_s(first_stamp) is not None:
        units["time"] = "s"
        described[chosen["time"] : chosen["time"] + 1] = [""] if header else []
    elif ":" in first_stamp:
        raise DataError(
            f"{path}, row {numbers[0][0]}: {first_stamp!r} is a clock's time, no number: state "
            "the rate, --map time=RATEHz, or read the file with pandas and pass the table to "
            "springpot.Recording.from_frame"
        )
    return Layout(
        delimiter, width, rows[0], header, below, chosen,
        choose_column_units(str(path), described, chosen, request.columns, units),
        request.decimal or _find_decimal_mark(path, numbers), _parse_step_s(stated),
    )  # fmt: skip


def with_signal_header(lines: Sequence[str]) -> Sequence[str]:
    """Lines with a header above the numbers, where a file names each channel in a line, SigN."""
    head = [line.strip() for line in lines[:_HEAD_LINES]]
    labels = {k: match[1] for k, line in enumerate(head) if (match := _SIGNAL.fullmatch(line))}
    rows = [
        k
        for k in range(max(labels, default=0) + 1, len(head))
        if len(cells := head[k].split()) >= len(labels) and all(map(is_value, cells))
    ]
    if len(labels) < 2 or not rows:
        return lines
    mark = "\t" if "\t" in lines[rows[0]].strip() else " "
    header = mark.join(f'"{label}"' for label in labels.values())
    return [*lines[: rows[0] - 1], f"{header}\n", *lines[rows[0] :]]


def _read_stated(above: Sequence[str], delimiter: str) -> dict[str, Cells]:
    """Cells of the lines above a header that LabVIEW writes, by the word in the first."""
    rows = (split_cells(line, delimiter) for line in above)
    return {row[0]: row for row in rows if row and row[0] in ("Y_Unit_Label", "Delta_X")}


def _parse_step_s(stated: Mapping[str, Cells]) -> float | None:
    steps = [cell.replace(",", ".") for cell in stated.get("Delta_X", [])[1:] if is_value(cell)]
    return float(steps[0]) if steps and float(steps[0]) > 0.0 else None


def parse_clock_s(cell: str) -> Decimal | None:
    """Seconds since midnight of a clock's time, to its last digit; None for anything else."""
    match = _CLOCK.fullmatch(cell.strip())
    if not match:
        return None
    hours, minutes = int(match["h"] or 0), int(match["m"] or match["m2"])
    if match["half"]:
        hours = hours % 12 + 12 * (match["half"].upper() == "PM")
    seconds = Decimal((match["s"] or match["s2"]).replace(",", "."))
    return 3600 * hours + 60 * minutes + seconds


def _find_decimal_mark(path: Path, numbers: Sequence[tuple[int, str]]) -> DecimalMark:
    """Mark of decimals in cells of numbers, each with its row: that of most of them."""
    commas = [(row, cell) for row, cell in numbers if "," in cell and is_number(cell, "comma")]
    if len(commas) <= sum("." in cell and is_number(cell) for _, cell in numbers):
        return "point"
    if all(GROUPS["point"].fullmatch(cell) for _, cell in commas):
        row, cell = commas[0]
        raise DataError(
            f"{path}, row {row}: {cell!r} may be a decimal comma or a separator of thousands: pass "
            "--decimal comma, or take the separators out, as pandas.read_csv(thousands=',') does"
        )
    return "comma"


def _missing_columns_error(
    path: Path, head: Sequence[str], found: Found, request: FileRequest
) -> DataError:
    """Say which channels the likeliest header lacks, and what to pass."""
    present, index, row = found
    tables = ((k, row_cells) for k in range(len(head)) for _, row_cells in _split_line(head, k))
    first = next((k for k, row_cells in tables if all(map(is_value, row_cells))), None)
    if first is not None and not present:  # other words: the fullest row above the first of numbers
        above = [
            (k, row_cells)
            for k in range(max(first - 3, 0), first)
            for _, row_cells in _split_line(head, k)
        ]
        index, row = max(above, key=lambda titled: sum(map(bool, titled[1])), default=(index, row))
    names = ", ".join(map(repr, row[:_SHOWN])) + ", ..." * (len(row) > _SHOWN)
    header = f" in row {index + 1}, which has {names}" * bool(row)
    missing = [q for q in request.wanted if q not in present]
    stated = {q: request.columns[q].header_or_number for q in missing if q in request.columns}
    kind = DataError
    if not present.keys() - {"time"} and not stated and (row or first is None):
        kind = NoRecordingError
        if re.search(_STRESS_WORDS, names, re.I):
            return kind(f"{path}: {_specimen_hint(row)}: found{header[3:]}")
        for words, hint in _HINTS.items():
            if re.search(words, names, re.I):
                return kind(f"{path}: {hint}: found{header[3:]}")
    remedy = f"pass --map {MAP_EXAMPLE}, where COL is a header or a column's number"
    if stated:
        remedy = "pass --map with COL as the file has it, or as a column's number"
    elif missing == ["time"] and row:
        remedy = (
            "if its samples were taken evenly, pass --map time=RATEHz, RATE how many in a second; "
            "without it nobody knows how fast the object was pressed"
        )
    channels = " or of ".join(q + f" ({stated.get(q)!r})" * (q in stated) for q in missing)
    return kind(f"{path}: found no column of {channels}{header}: {remedy}")


def _specimen_hint(row: Cells) -> str:
    """Say what to pass for columns of strain and stress, by the units that the header says."""
    quantities: tuple[Quantity, ...] = ("position", "force")
    specimen = {
        quantity: (cell, unit)
        for quantity in quantities
        for cell in reversed(row)
        if is_specimen_unit(unit := split_unit(cell, quantity)[1] or "", quantity)
    }
    how = (
        specimen_remedy(specimen)
        if specimen
        else "pass the specimen's height for a strain of 1, and its area times the unit of stress, "
        "--map position=COL:33mm,force=COL:18N for 33 mm, and 18 mm2 of a stress in MPa"
    )
    return f"stress and strain are neither force nor position: {how}"


def _split_line(head: Sequence[str], index: int) -> Iterator[tuple[str, Cells]]:
    """Yield each delimiter that may separate the cells of a line, and the cells.

    A space does so only above a row of as many numbers, or in one: sentences have spaces, too. A
    mark of comments, as numpy.savetxt writes it, is no part of a header, unless it has a column.
    """
    line = head[index]
    for delimiter in _DELIMITERS:
        for text in dict.fromkeys((_strip_comment(line), line)):
            row = split_cells(text, delimiter)
            if 2 <= len(row) <= _MAX_COLUMNS:
                below = split_cells("".join(head[index + 1 : index + 2]), " ")
                if delimiter != " " or (len(below) == len(row) and all(map(is_value, below))):
                    yield delimiter, row
                    break


def _strip_comment(line: str) -> str:
    """A line without a comment's mark."""
    return _COMMENT.sub("", line, 1)


def split_cells(line: str, delimiter: str) -> Cells:
    """Split one line; quoted cells keep their delimiters. Empty if a cell is too long."""
    try:
        rows = list(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    except csv.Error:
        return []
    split: Cells = []
    for cell in (cell.strip() for cell in rows[0]) if rows else ():
        if delimiter == " " and split and cell.startswith(("[", "(")):
            split[-1] += f" {cell}"  # "time [s]" is one cell
        else:
            split.append(cell)
    return split


def plain_number(cell: str, decimal: DecimalMark) -> str:
    """A number as Python reads it: a point for decimals, and no separators of thousands."""
    if _GROUPED[decimal].fullmatch(cell):
        cell = cell.replace("," if decimal == "point" else ".", "")
    return cell.translate(COMMA_TO_POINT) if decimal == "comma" else cell


def is_number(cell: str, decimal: DecimalMark = "point") -> bool:
    """Return whether a cell is a number, NaN and infinity included."""
    try:
        float(plain_number(cell, decimal))
    except ValueError:
        return False
    return "_" not in cell and cell.isascii()  # Python reads 1_000 and other scripts' digits


def is_value(cell: str) -> bool:
    """Return whether a cell is a number with either mark of decimals, or a clock's time."""
    return is_number(cell) or is_number(cell, "comma") or parse_clock_s(cell) is not None
