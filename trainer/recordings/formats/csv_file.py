"""CSV files: one table of numbers in columns, below one header and perhaps a row of units."""

import csv
import io
import re
from collections.abc import Sequence
from contextlib import suppress
from decimal import Decimal
from pathlib import Path

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.errors import DataError
from springpot.codegen.messages import counted_noun
from springpot.trainer.recordings.formats.column_map import (
    FileRequest,
    guess_columns,
    read_place_m,
    split_unit,
)
from springpot.trainer.recordings.formats.csv_layout import (
    GROUPS,
    Cells,
    Layout,
    NoRecordingError,
    find_layout,
    is_number,
    is_value,
    parse_clock_s,
    plain_number,
    split_cells,
    with_signal_header,
)
from springpot.trainer.recordings.formats.sampling import MIN_ROWS, RawChannels, to_si
from springpot.trainer.recordings.formats.units import factor_to_si

_LAST_ROWS = 2000  # with a fixed number of significant digits, the last stamps have the fewest
_MAX_EXPONENT = 300
_DAY_S = 86_400
_CONTROL_CHARACTERS = re.compile("[\0-\b\x0e-\x19\x1b-\x1f]")  # but for Ctrl-Z at the end of DOS
_SHOWN = 40  # letters of a line in a message


def read_csv(path: Path, request: FileRequest) -> RawChannels:
    """Read the table of a file.

    Raises DataError naming file and row for bytes that are no text, missing columns or units, rows
    of another length, cells without a number and text in the middle of numbers.
    """
    text, encoding = _decode_lines(path)
    lines = with_signal_header(text)
    layout = find_layout(path, lines, request)
    table = _Table(path, lines, layout)
    rate_hz = request.rate_hz
    # LabVIEW: the step stands above the header, and the column of time is empty.
    if layout.step_s and "time" in layout.columns and table.is_empty(layout.columns["time"]):
        rate_hz = 1.0 / layout.step_s
        layout = table.layout = layout.without_time()
    guess = layout.guess() + encoding + table.trailer_note
    if rate_hz is not None:
        beside = _compare_time_column(table, rate_hz)
        guess = f"time = rows counted at the stated {rate_hz:g} Hz{beside}; {guess}"
    values = {q: table.column(i) for q, i in layout.columns.items()}
    return to_si(
        values, layout.units, rate_hz, guess,
        rows=table.rows,
        source=str(path),
        time_digit_s=table.printed_digit_s() if "time" in layout.columns else 0.0,
        place_m=read_place_m(
            str(path), layout.header, table.column, request.place, layout.unit_row
        ),
    )  # fmt: skip


def _decode_lines(path: Path) -> tuple[list[str], str]:
    """Lines of a text, and a note on an encoding that is not UTF-8.

    Bytes that are no UTF-8 are Windows-1252. Raises DataError for bytes that are no text.
    """
    content, note = path.read_bytes(), ""
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        wide = content.startswith((b"\xff\xfe", b"\xfe\xff"))
        text = content.decode("utf-16" if wide else "cp1252", errors="replace")
        note = "; UTF-16 text" if wide else "; not UTF-8, read as Windows-1252"
    if _CONTROL_CHARACTERS.search(text):
        raise DataError(
            f"{path}: control characters, so no text: export it as CSV in UTF-8, or read it in "
            "Python (an Excel workbook, TDMS, a log of CAN frames) and pass its columns to "
            "springpot.Recording.from_frame"
        )
    if not text.strip():
        raise NoRecordingError(f"{path}: the file is empty: give a header and rows of numbers")
    text = text.replace("\u2212", "-")  # the minus of typesetters
    return io.StringIO(text, newline=None).readlines(), note


class _Table:
    """The rows of numbers below a header, cell by cell.

    rows: number of each row in the file, from 1. trailer_note: on text behind the numbers, or "".
    """

    def __init__(self, path: Path, lines: Sequence[str], layout: Layout) -> None:
        self.path, self.lines, self.layout, self.trailer_note = path, lines, layout, ""
        self._cells = list[Cells]()
        self.rows: Indices = np.array(self._read_cells(), dtype=np.intp)
        self._join_groups()
        self._count_clock()

    def column(self, index: int) -> Samples:
        """Return the numbers of a column, (n,), NaN for an empty cell.

        Raises DataError for the first cell that holds something else.
        """
        texts = [row[index].strip() for row in self._cells]
        for row, cell in zip(self.rows, texts, strict=True):
            if cell and not is_number(cell, self.layout.decimal):
                raise DataError(
                    f"{self.path}, row {row}, column {index + 1}: {cell!r} is not a number with a "
                    f"decimal {self.layout.decimal}, as the others are: correct it in the source"
                )
        decimal = self.layout.decimal
        return np.array([float(plain_number(cell, decimal) or "nan") for cell in texts])

    def is_empty(self, index: int) -> bool:
        """Return whether no row has anything in a column."""
        return not any(row[index].strip() for row in self._cells)

    def _join_groups(self) -> None:
        """Take separators out of whole numbers: of 998 and 1,001, not of 0,998 and 1,001."""
        groups = GROUPS[self.layout.decimal]
        for index in self.layout.columns.values():
            cells = [row[index].strip() for row in self._cells]
            marked = [cell for cell in cells if not cell.lstrip("+-").isdecimal()]
            if 0 < len(marked) < len(cells) and all(map(groups.fullmatch, marked)):
                for row in self._cells:
                    row[index] = re.sub("[,.]", "", row[index])

    def _count_clock(self) -> None:
        """Write seconds from the first row on in place of a clock's times; midnight is passed."""
        index = self.layout.columns.get("time", -1)
        stamps = [parse_clock_s(row[index]) for row in self._cells if index >= 0]
        if not stamps or stamps[0] is None:
            return
        days, before_s = 0, stamps[0]
        mark = "," if self.layout.decimal == "comma" else "."
        for row, stamp_s in zip(self._cells, stamps, strict=True):
            if stamp_s is not None:  # else a cell that `column` refuses
                days += before_s - stamp_s > _DAY_S / 2
                before_s = stamp_s
                row[index] = f"{stamp_s + days * _DAY_S - stamps[0]:f}".replace(".", mark)

    def _read_cells(self) -> list[int]:
        """Read the rows as text up to the file's end, or to text behind them."""
        layout, rows, table = self.layout, list[int](), self._cells
        reader = csv.reader(
            self.lines[layout.first_row :], delimiter=layout.delimiter, skipinitialspace=True
        )
        try:
            for cells in reader:
                line = layout.first_row + reader.line_num
                # A delimiter at the end of each row begins no cell.
                ended = len(cells) == layout.width + 1 and not cells[-1].strip()
                row = cells[:-1] if ended else cells
                if len(row) != layout.width and not any(map(str.strip, row)):
                    continue
                if _is_text(row, layout):
                    self._skip_trailer(line)
                    break
                if len(row) != layout.width:
                    raise DataError(
                        f"{self.path}, row {line}: {counted_noun(len(row), 'cell')}, the header "
                        f"and the rows above have {layout.width}: "
                        "correct or cut that row in the source"
                    )
                rows.append(line)
                table.append(row)
        except csv.Error as error:
            line = layout.first_row + reader.line_num
            raise DataError(
                f"{self.path}, row {line}: {error}: correct that row in the source"
            ) from None
        while rows and not any(table[-1][i].strip() for i in layout.columns.values()):
            table.pop()  # delimiters alone, as spreadsheets leave them
            rows.pop()
        return rows

    def _skip_trailer(self, line: int) -> None:
        """Note the text that begins in a line, or refuse it if the numbers go on behind it.

        A title or an empty line, and fewer rows than a recording has, is a table of results.
        """
        trailer = [split_cells(text, self.layout.delimiter) for text in self.lines[line - 1 :]]
        numbers = [k for k, row in enumerate(trailer) if len(row) >= self.layout.width
                   and all(is_value(row[i]) for i in self.layout.columns.values())]  # fmt: skip
        words = " ".join(self.lines[line - 1].replace('"', "").split())
        words = repr(words if len(words) <= _SHOWN else f"{words[:_SHOWN]}...")
        titled = not self.lines[line - 2].strip() or bool(numbers and any(trailer[1 : numbers[0]]))
        if numbers and not (titled and len(numbers) < MIN_ROWS):
            raise DataError(
                f"{self.path}, row {line}: {words} stands in the middle of numbers: correct that "
                "row, or cut the file into one table each, or read it in Python and pass its "
                "columns to springpot.Recording.from_frame"
            )
        what = "other columns" if numbers else "text"
        self.trailer_note = f"; left out: {what} from row {line} on, {words}"

    def printed_digit_s(self) -> float:
        """Return one unit in the last printed digit of the time column, s; 0 without one."""
        index = self.layout.columns["time"]
        last = self._cells[-_LAST_ROWS:]
        stamps = [plain_number(row[index].strip(), self.layout.decimal) for row in last]
        exponents = [Decimal(stamp).as_tuple().exponent for stamp in stamps if stamp.strip()]
        printed = [exponent for exponent in exponents if isinstance(exponent, int)]  # NaN has none
        digit = 10.0 ** min(_MAX_EXPONENT, *printed) if printed else 0.0
        return digit * abs(self.layout.units["time"].to_si)


def _is_text(row: Cells, layout: Layout) -> bool:
    """Tell a row of words from one of numbers in which something is wrong.

    The first channel's cell is a word, 'Maximum load', '8.12', 'N': one without digits, or that
    begins with two letters. If it stands alone in its row, it is text if it is no number.
    """
    first = "".join(row[min(layout.columns.values()) :][:1]).strip()
    full = [cell.strip() for cell in row if cell.strip()]
    word = len(full) == 1 or not any(map(str.isdigit, first)) or first[:2].isalpha()
    return word and not all(map(is_value, full))


def _compare_time_column(table: _Table, rate_hz: float) -> str:
    """Compare a column of time that is not read with the stated rate; a note if it differs."""
    for index in guess_columns(table.layout.header, "time")[:1]:
        with suppress(DataError):  # it holds more than numbers
            unit = split_unit(table.layout.header[index], "time")[1]
            time_s = table.column(index) * (factor_to_si(unit, "time", "") if unit else 1.0)
            counted_s = np.arange(len(time_s)) / rate_hz
            mismatched = np.flatnonzero(np.abs(time_s - time_s[:1] - counted_s) > 0.5 / rate_hz)
            if len(mismatched):
                first, rows = mismatched[0], counted_noun(len(mismatched), "row")
                return (
                    f", not read from column {index + 1}, which differs in {rows} from row "
                    f"{table.rows[first]} on: there it says {time_s[first] - time_s[0]:g} s after "
                    f"the first row, the count {counted_s[first]:g} s"
                )
    return ""
