"""The rows of numbers of a CSV file: read in bulk, and row by row where a row must be named."""

import csv
import io
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.errors import DataError
from springpot.codegen.plurals import number_of
from springpot.trainer.recordings.formats.column_map import split_unit
from springpot.trainer.recordings.formats.csv.csv_cells import column_numbers, last_digit
from springpot.trainer.recordings.formats.csv.csv_layout import Layout
from springpot.trainer.recordings.formats.csv.decimals import COMMA_TO_POINT
from springpot.trainer.recordings.formats.units import factor_to_si
from springpot.trainer.recordings.places import require_one_place

UTF8 = "utf-8-sig"
_TAIL_CHARACTERS, _TAIL_LINES = 1 << 16, 1000


class CsvTable:
    """The rows of numbers below a header.

    lines: those of a block, from the layout's first line of numbers on; None: to the file's end.
    """

    def __init__(
        self, path: Path, layout: Layout, encoding: str, lines: Sequence[str] | None = None
    ) -> None:
        self.path, self.layout, self.encoding, self.lines = path, layout, encoding, lines

    def all_numbers(self) -> NDArray[np.float64] | None:
        """Numbers in all columns, shape (rows, columns); None where some cell holds none."""
        numbers = self._in_bulk(None)
        return numbers if numbers.shape[1] == self.layout.width else None

    def numbers(self, options: list[int]) -> NDArray[np.float64]:
        """Some columns of all rows, shape (rows, columns), in the file's units.

        Reading every column in bulk checks the rows' lengths too. Where other columns hold text,
        the lengths are checked first; only reading row by row can name the row in a message.
        """
        plain = self.all_numbers()
        if plain is not None:
            return plain[:, options]
        count = sum(1 for _ in self.rows())
        numbers = self._in_bulk(options)
        if numbers.shape == (count, len(options)):
            return numbers
        rows = list(self.rows())
        found = [column_numbers(self.path, self.layout, rows, index) for index in options]
        return np.array(found).T

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Yield the 1-based line and the cells of each row of numbers; blank lines are none."""
        width, above = self.layout.width, self.layout.first_line - 1
        shortest = max(self.layout.columns.values()) + 1 if self.layout.beside else width
        with self.path.open(encoding=self.encoding, newline="") as file:
            lines = islice(file, above, None) if self.lines is None else self.lines
            reader = csv.reader(lines, delimiter=self.layout.delimiter)
            try:
                for found in reader:
                    # A delimiter at the end of each row begins no cell.
                    ended = len(found) == width + 1 and not found[-1].strip()
                    row = found[:-1] if ended else found
                    line = above + reader.line_num
                    if len(row) < 2 and not any(cell.strip() for cell in row):
                        continue
                    if not shortest <= len(row) <= width:
                        raise DataError(
                            f"{self.path}, row {line}: {number_of(len(row), 'cell')}, the rows "
                            f"above have {width}: correct or cut that row in the source"
                        )
                    yield line, row
            except csv.Error as error:
                raise DataError(
                    f"{self.path}, row {above + reader.line_num}: {error}: correct that row in the "
                    "source"
                ) from None

    def place_m(self) -> tuple[float, float] | None:
        """Return x and y of the place that columns state, m; None without such columns.

        Raises DataError if the place changes from sample to sample.
        """
        options = self.layout.place
        if not options:
            return None
        found = self.numbers([column for column, _ in options]) * [to_si for _, to_si in options]
        return require_one_place(str(self.path), found)

    def beside(self, rate_hz: float) -> str:
        """Compare the column of time that is not read with the stated rate; return a message."""
        if self.layout.unread_time is None:
            return ", its header names no column of time"
        index, label = self.layout.unread_time
        found = f", not read from column {index + 1} {label!r}"
        numbers = self._in_bulk([index])
        if not numbers.size:
            return found + ", which holds more than numbers"
        stamps_s = (numbers[:, 0] - numbers[0, 0]) * self._factor_of(label)
        off = np.flatnonzero(np.abs(stamps_s - np.arange(len(stamps_s)) / rate_hz) > 0.5 / rate_hz)
        if not len(off):
            return found + ", which agrees"
        line = next(islice(self.rows(), int(off[0]), None))[0]
        return (
            f"{found}, which differs in {number_of(len(off), 'row')} from row {line} on: there "
            f"it says {stamps_s[off[0]]:g} s after the first row, the count {off[0] / rate_hz:g} s"
        )

    def printed_digit_s(self) -> float:
        """Return one unit in the last printed digit of the time column, s; 0 without one.

        Looks at the file's end: with a fixed number of significant digits it is the coarser one.
        """
        if "time" not in self.layout.columns:
            return 0.0
        return last_digit(self._last_lines(), self.layout) * abs(self.layout.units["time"].to_si)

    def _last_lines(self) -> Sequence[str]:
        if self.lines is not None:
            return self.lines[-_TAIL_LINES:]
        tail = self.path.read_bytes()[-_TAIL_CHARACTERS:]
        if self.encoding == "utf-16":
            tail = self.path.read_text(self.encoding)[-_TAIL_CHARACTERS:].encode()
        return tail.decode("utf-8", errors="ignore").splitlines()

    def _factor_of(self, label: str) -> float:
        try:
            return factor_to_si(split_unit(label, "time")[1] or "s", "time", "")
        except DataError:
            return 1.0

    def _in_bulk(self, columns: list[int] | None) -> NDArray[np.float64]:
        """Read all or some columns, shape (rows, columns); (0, 0) where a cell holds no number."""
        try:
            with warnings.catch_warnings(), self._source() as source:
                warnings.simplefilter("ignore")  # a file without rows is refused with short ones
                return np.loadtxt(
                    source,
                    dtype=np.float64,
                    comments=None,
                    delimiter=self.layout.delimiter,
                    skiprows=self.layout.first_line - 1 if self.lines is None else 0,
                    usecols=columns,
                    quotechar='"',
                    encoding=self.encoding,
                    ndmin=2,
                )
        except ValueError:
            return np.empty((0, 0))

    @contextmanager
    def _source(self) -> Iterator[Path | IO[str]]:
        """The file itself, which is fastest, or its text with points in place of commas."""
        comma = self.layout.decimal == "comma"
        if self.lines is not None:
            text = "".join(self.lines)
            yield io.StringIO(text.translate(COMMA_TO_POINT) if comma else text)
        elif not comma:
            yield self.path
        elif self.encoding != "utf-16":
            plain = self.path.read_bytes().translate(bytes.maketrans(b",.", b".!"))
            yield io.TextIOWrapper(io.BytesIO(plain), encoding=self.encoding)
        else:
            yield io.StringIO(self.path.read_text(self.encoding).translate(COMMA_TO_POINT))
