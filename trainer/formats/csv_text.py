"""CSV files: numbers in columns with headers, separated by commas, semicolons or tabs."""

import csv
import warnings
from collections.abc import Iterator
from decimal import Decimal
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from springpot.runtime_c.errors import DataError
from springpot.trainer.formats.column_map import ColumnMap
from springpot.trainer.formats.csv_layout import Layout, cells, find_layout, is_number
from springpot.trainer.formats.sampling import RawChannels
from springpot.trainer.formats.units import QUANTITIES

_ENCODING = "utf-8-sig"
_HEAD_LINES = 400
_CHUNK_BYTES = 1 << 24
_TAIL_BYTES = 1 << 16


def read_csv(path: Path, columns: ColumnMap, name: str) -> tuple[RawChannels, str]:
    """Read one recording and say how the file was understood.

    Raises DataError naming file and row for text that is none, missing columns or units, rows of
    another length and cells without a number.
    """
    _check_text(path)
    with path.open(encoding=_ENCODING) as file:
        head = list(islice(file, _HEAD_LINES))
    if not any(line.strip() for line in head):
        raise DataError(f"{path}: the file is empty: give one with a header and rows of numbers")
    layout = find_layout(path, head, columns)
    numbers = _read_numbers(path, layout)
    time_s, position_m, force_n = (
        numbers[:, index] * layout.factors[quantity] for index, quantity in enumerate(QUANTITIES)
    )
    raw = RawChannels(
        name=name,
        time_s=time_s,
        position_m=position_m,
        force_n=force_n,
        time_digit_s=_printed_digit(path, layout) * abs(layout.factors["time"]),
        source=str(path),
        line_of=lambda sample: next(islice(_rows(path, layout), sample, None))[0],
        details={"columns": layout.guess},
    )
    return raw, layout.guess


def _check_text(path: Path) -> None:
    """Read the bytes once: NumPy names no row for a NUL byte or another encoding."""
    row = 1
    with path.open("rb") as file:
        # Whole lines, so that no character is cut in two.
        while chunk := file.read(_CHUNK_BYTES) + file.readline():
            if b"\0" in chunk:
                row += chunk[: chunk.index(b"\0")].count(b"\n")
                raise DataError(
                    f"{path}, row {row}: a NUL byte, so this is not a text file in UTF-8: "
                    "export it as CSV in UTF-8"
                )
            try:
                chunk.decode("utf-8")
            except UnicodeDecodeError as error:
                row += chunk[: error.start].count(b"\n")
                raise DataError(
                    f"{path}, row {row}: byte 0x{chunk[error.start]:02x} is not UTF-8 text: "
                    "save the file in UTF-8"
                ) from None
            row += chunk.count(b"\n")


def _read_numbers(path: Path, layout: Layout) -> NDArray[np.float64]:
    """Read time, position and force of all rows, shape (rows, 3), in the file's units.

    Reading every column in bulk checks the rows' lengths too. Where other columns hold text, the
    lengths are checked first; row by row is the way to the row that the message names.
    """
    wanted = [layout.columns[quantity] for quantity in QUANTITIES]
    numbers = _in_bulk(path, layout, None)
    if numbers.shape[1] == layout.width:
        return numbers[:, wanted]
    count = sum(1 for _ in _rows(path, layout))
    numbers = _in_bulk(path, layout, wanted)
    if numbers.shape == (count, len(wanted)):
        return numbers
    values = [[_number(path, line, row, i) for i in wanted] for line, row in _rows(path, layout)]
    return np.reshape(values, (len(values), len(wanted)))


def _in_bulk(path: Path, layout: Layout, columns: list[int] | None) -> NDArray[np.float64]:
    """Read all or some columns, shape (rows, columns); (0, 0) where a cell holds no number."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a file without rows is refused with the short ones
            return np.loadtxt(
                path,
                dtype=np.float64,
                comments=None,
                delimiter=layout.delimiter,
                skiprows=layout.first_line - 1,
                usecols=columns,
                quotechar='"',
                encoding=_ENCODING,
                ndmin=2,
            )
    except ValueError:
        return np.empty((0, 0))


def _rows(path: Path, layout: Layout) -> Iterator[tuple[int, list[str]]]:
    """Yield the 1-based line and the cells of each row of numbers; blank lines are none."""
    with path.open(encoding=_ENCODING, newline="") as file:
        above = layout.first_line - 1
        reader = csv.reader(islice(file, above, None), delimiter=layout.delimiter)
        try:
            for row in reader:
                line = above + reader.line_num
                if not any(cell.strip() for cell in row) and len(row) < 2:
                    continue
                if len(row) != layout.width:
                    raise DataError(
                        f"{path}, row {line}: {len(row)} cells, the rows above have "
                        f"{layout.width}: correct or cut that row in the source"
                    )
                yield line, row
        except csv.Error as error:
            raise DataError(
                f"{path}, row {above + reader.line_num}: {error}: correct that row in the source"
            ) from None


def _number(path: Path, line: int, row: list[str], index: int) -> float:
    cell = row[index].strip()
    if is_number(cell):
        return float(cell)
    what = f"{cell!r} is not a number" if cell else "the cell is empty"
    hint = " (decimal comma? write a point)" if is_number(cell.replace(",", ".")) else ""
    raise DataError(
        f"{path}, row {line}, column {index + 1}: {what}{hint}: correct it in the source"
    )


def _printed_digit(path: Path, layout: Layout) -> float:
    """Return one unit in the last printed digit of the time column, in the file's unit.

    Looks at the file's end: with a fixed number of significant digits it is the coarser one.
    """
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - _TAIL_BYTES))
        lines = file.read().decode("utf-8", errors="ignore").splitlines()
    column = layout.columns["time"]
    exponents = []
    for row in (cells(line, layout.delimiter) for line in lines):
        if len(row) == layout.width and is_number(row[column]):
            exponent = Decimal(row[column]).as_tuple().exponent
            exponents += [exponent] if isinstance(exponent, int) else []
    return 10.0 ** min(exponents) if exponents else 0.0
