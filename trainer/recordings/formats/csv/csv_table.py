"""The rows of numbers of a CSV file: read in bulk, and row by row where a row must be named."""

import csv
import io
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from decimal import Decimal, InvalidOperation
from itertools import islice
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import split_unit
from springpot.trainer.recordings.formats.csv.csv_layout import Layout
from springpot.trainer.recordings.formats.csv.csv_lines import cells
from springpot.trainer.recordings.formats.csv.decimals import COMMA_TO_POINT, is_number
from springpot.trainer.recordings.formats.units import factor_to_si

UTF8 = "utf-8-sig"
_TAIL_CHARACTERS = 1 << 16
_MAX_EXPONENT = 300


def _last_exponent(number: str) -> list[int]:
    """Power of ten of the last printed digit, where there is one."""
    try:
        exponent = Decimal(number).as_tuple().exponent
    except InvalidOperation:  # farther from 0 than even decimals go
        return []
    return [exponent] if isinstance(exponent, int) else []


class CsvTable:
    """The rows of numbers below a file's header."""

    def __init__(self, path: Path, layout: Layout, encoding: str) -> None:
        self.path, self.layout, self.encoding = path, layout, encoding

    def numbers(self, options: list[int]) -> NDArray[np.float64]:
        """Some columns of all rows, shape (rows, columns), in the file's units.

        Reading every column in bulk checks the rows' lengths too. Where other columns hold text,
        the lengths are checked first; only reading row by row can name the row in a message.
        """
        numbers = self._in_bulk(None)
        if numbers.shape[1] == self.layout.width:
            return numbers[:, options]
        count = sum(1 for _ in self.rows())
        numbers = self._in_bulk(options)
        if numbers.shape == (count, len(options)):
            return numbers
        values = [[self._number(line, row, i) for i in options] for line, row in self.rows()]
        return np.reshape(values, (len(values), len(options)))

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Yield the 1-based line and the cells of each row of numbers; blank lines are none."""
        width = self.layout.width
        with self.path.open(encoding=self.encoding, newline="") as file:
            above = self.layout.first_line - 1
            reader = csv.reader(islice(file, above, None), delimiter=self.layout.delimiter)
            try:
                for found in reader:
                    # A delimiter at the end of each row begins no cell.
                    ended = len(found) == width + 1 and not found[-1].strip()
                    row = found[:-1] if ended else found
                    line = above + reader.line_num
                    if not any(cell.strip() for cell in row) and len(row) < 2:
                        continue
                    if len(row) != width:
                        raise DataError(
                            f"{self.path}, row {line}: {len(row)} cells, the rows above have "
                            f"{width}: correct or cut that row in the source"
                        )
                    yield line, row
            except csv.Error as error:
                raise DataError(
                    f"{self.path}, row {above + reader.line_num}: {error}: correct that row in the "
                    "source"
                ) from None

    def place_m(self) -> tuple[float, float] | None:
        """Return x and y of the place that columns state, m; None without such columns.

        Raises DataError if the place changes: a recording is of one.
        """
        if not self.layout.place:
            return None
        numbers = self.numbers([column for column, _ in self.layout.place])
        moved = np.flatnonzero((numbers != numbers[:1]).any(axis=1))
        if len(moved):
            line = next(islice(self.rows(), int(moved[0]), None))[0]
            raise DataError(
                f"{self.path}, row {line}: the place changes: a recording is of one place, cut the "
                "file there"
            )
        x, y = (
            float(n) * to_si for n, (_, to_si) in zip(numbers[0], self.layout.place, strict=True)
        )
        return x, y

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
            f"{found}, which differs in {len(off)} rows from row {line} on: there it says "
            f"{stamps_s[off[0]]:g} s after the first row, the count {off[0] / rate_hz:g} s"
        )

    def printed_digit_s(self) -> float:
        """Return one unit in the last printed digit of the time column, s; 0 without one.

        Looks at the file's end: with a fixed number of significant digits it is the coarser one.
        """
        column = self.layout.columns.get("time")
        if column is None:
            return 0.0
        tail = self.path.read_bytes()[-_TAIL_CHARACTERS:]
        if self.encoding == "utf-16":
            tail = self.path.read_text(self.encoding)[-_TAIL_CHARACTERS:].encode()
        exponents = []
        for line in tail.decode("utf-8", errors="ignore").splitlines():
            row = cells(line, self.layout.delimiter)
            if len(row) == self.layout.width and is_number(row[column], self.layout.decimal):
                exponents += _last_exponent(self._plain(row[column]))
        digit = 10.0 ** min(_MAX_EXPONENT, *exponents) if exponents else 0.0
        return digit * abs(self.layout.units["time"].to_si)

    def _factor_of(self, label: str) -> float:
        try:
            return factor_to_si(split_unit(label, "time")[1] or "s", "time", "")
        except DataError:
            return 1.0

    def _plain(self, cell: str) -> str:
        return cell.translate(COMMA_TO_POINT) if self.layout.decimal == "comma" else cell

    def _number(self, line: int, row: list[str], index: int) -> float:
        cell = row[index].strip()
        if is_number(cell, self.layout.decimal):
            return float(self._plain(cell))
        what = f"{cell!r} is not a number" if cell else "the cell is empty"
        if self.layout.decimal == "comma":
            what += " with a decimal comma, as the others are" if cell else ""
        elif is_number(cell.replace(",", ".")):
            what += " (decimal comma? write a point)"
        raise DataError(
            f"{self.path}, row {line}, column {index + 1}: {what}: correct it in the source"
        )

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
                    skiprows=self.layout.first_line - 1,
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
        if self.layout.decimal == "point":
            yield self.path
        elif self.encoding != "utf-16":
            plain = self.path.read_bytes().translate(bytes.maketrans(b",.", b".!"))
            yield io.TextIOWrapper(io.BytesIO(plain), encoding=self.encoding)
        else:
            yield io.StringIO(self.path.read_text(self.encoding).translate(COMMA_TO_POINT))
