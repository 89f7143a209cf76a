"""CSV files: numbers in columns with headers, separated by commas, semicolons or tabs."""

from itertools import islice
from pathlib import Path
from typing import IO, Any

import numpy as np

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import ColumnMap, stated_rate_hz
from springpot.trainer.recordings.formats.csv_layout import find_layout
from springpot.trainer.recordings.formats.csv_table import UTF8, CsvTable
from springpot.trainer.recordings.formats.decimals import DecimalMark
from springpot.trainer.recordings.formats.sampling import RawChannels
from springpot.trainer.recordings.formats.units import QUANTITIES

_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")
_HEAD_LINES, _HEAD_LETTERS = 400, 1 << 18
_CHUNK_BYTES = 1 << 24


def read_csv(
    path: Path, columns: ColumnMap, name: str, decimal: DecimalMark | None = None
) -> tuple[RawChannels, str]:
    """Read one recording, and how the file was understood.

    decimal: what marks the decimals; None guesses from the first rows.
    Raises DataError naming file and row for bytes that are no text, missing columns or units, rows
    of another length and cells without a number.
    """
    encoding = _encoding(path)
    _check_text(path, encoding)
    with path.open(encoding=encoding) as file:
        head = _head(file)
    if not any(line.strip() for line in head):
        raise DataError(f"{path}: the file is empty: give one with a header and rows of numbers")
    table = CsvTable(path, find_layout(path, head, columns, decimal), encoding)
    layout = table.layout
    options = [quantity for quantity in QUANTITIES if quantity in layout.columns]
    numbers = table.numbers([layout.columns[quantity] for quantity in options])
    scaled = {q: numbers[:, k] * layout.units[q].to_si for k, q in enumerate(options)}
    guess = layout.guess + ("; UTF-16 text" if encoding == "utf-16" else "")
    rate_hz = stated_rate_hz(columns)
    if rate_hz is not None:
        scaled["time"] = np.arange(len(numbers)) / rate_hz
        guess = f"time = rows counted at the stated {rate_hz:g} Hz{table.beside(rate_hz)}; {guess}"
    units: dict[str, Any] = {q: unit.metadata() for q, unit in layout.units.items()}
    if rate_hz is not None:
        units["time"] = {"unit": f"{rate_hz:g} Hz", "from": "map"}
    raw = RawChannels(
        name=name,
        time_s=scaled["time"],
        position_m=scaled["position"],
        force_n=scaled["force"],
        time_digit_s=table.printed_digit_s(),
        source=str(path),
        line_of=lambda sample: next(islice(table.rows(), sample, None))[0],
        details={"columns": guess, "units": units},
    )
    return raw, guess


def _head(file: IO[str]) -> list[str]:
    """The lines among which the header is looked for, one at least."""
    head: list[str] = []
    letters = 0
    for line in islice(file, _HEAD_LINES):
        head.append(line)
        letters += len(line)
        if letters > _HEAD_LETTERS:
            break
    return head


def _encoding(path: Path) -> str:
    with path.open("rb") as file:
        return "utf-16" if file.read(2) in _UTF16_MARKS else UTF8


def _check_text(path: Path, encoding: str) -> None:
    """Read the bytes once: NumPy names no row for a NUL byte or another encoding."""
    if encoding == "utf-16":
        try:
            text = path.read_text(encoding)
        except UnicodeError as error:
            raise DataError(f"{path}: not whole UTF-16 text ({error}): save it in UTF-8") from None
        if "\0" in text:
            row = text[: text.index("\0")].count("\n") + 1
            raise DataError(f"{path}, row {row}: a NUL character: export it as CSV in UTF-8")
        return
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
