"""CSV files: numbers in columns with headers, between marks of `csv_lines`."""

import re
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import stated_rate_hz
from springpot.trainer.recordings.formats.csv.block_times import join_in_time
from springpot.trainer.recordings.formats.csv.csv_blocks import tables_of
from springpot.trainer.recordings.formats.csv.csv_layout import Layout, find_layout
from springpot.trainer.recordings.formats.csv.csv_lines import DELIMITERS, cells, is_value
from springpot.trainer.recordings.formats.csv.csv_missing import MissingColumnsError
from springpot.trainer.recordings.formats.csv.csv_table import UTF8, CsvTable
from springpot.trainer.recordings.formats.file_request import FileRequest
from springpot.trainer.recordings.formats.raw_channels import RawChannels
from springpot.trainer.recordings.formats.sampling import MIN_ROWS
from springpot.trainer.recordings.formats.units import QUANTITIES

_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")
_WINDOWS = "cp1252"
_NAMED = {"utf-16": "; UTF-16 text", _WINDOWS: "; not UTF-8, read as Windows-1252"}
_HEAD_LINES, _HEAD_LETTERS = 400, 1 << 18
_WORD = re.compile(r"\W*[^\W\d]")
_CHUNK_BYTES = 1 << 24


def read_csv(path: Path, request: FileRequest) -> tuple[list[RawChannels], str]:
    """Read the recordings of a file, one for most files, and how the file was understood.

    Blocks with headers of their own are recordings, those that count on in time are one.
    Raises DataError naming file and row for bytes that are no text, missing columns or units, rows
    of another length and cells without a number.
    """
    encoding = _encoding(path)
    with path.open(encoding=encoding) as file:
        head = _head(file)
    if not any(line.strip() for line in head):
        raise DataError(f"{path}: the file is empty: give one with a header and rows of numbers")
    table = CsvTable(path, _layout(path, head, encoding, request), encoding)
    guess = table.layout.guess + _NAMED.get(encoding, "")
    rate_hz = stated_rate_hz(request.columns)
    numbers = table.all_numbers()
    tables, left_out = ([table], "") if numbers is not None else tables_of(table, request)
    if rate_hz is not None:
        beside = tables[0].beside(rate_hz)
        guess = f"time = rows counted at the stated {rate_hz:g} Hz{beside}; {guess}"
    raws = [_channels(each, numbers, rate_hz, guess) for each in tables]
    raws, joined = join_in_time(raws)
    return raws, guess + joined + left_out


def _layout(path: Path, head: list[str], encoding: str, request: FileRequest) -> Layout:
    """The first layout among the first lines, or below a longer table of other columns."""
    try:
        return find_layout(path, head, request)
    except MissingColumnsError:
        with path.open(encoding=encoding) as file:
            lines = list(file)
        words = [k for k in range(len(head), len(lines)) if _WORD.match(lines[k])]
        if not words:
            raise
        with suppress(MissingColumnsError):
            return find_layout(path, lines, request, words)
        raise


def _channels(
    table: CsvTable, numbers: NDArray[np.float64] | None, rate_hz: float | None, guess: str
) -> RawChannels:
    """One table's channels in SI units. numbers: those of all columns, if they are read already."""
    layout = table.layout
    options = [quantity for quantity in QUANTITIES if quantity in layout.columns]
    chosen = [layout.columns[quantity] for quantity in options]
    found = table.numbers(chosen) if numbers is None else numbers[:, chosen]
    scaled = {q: found[:, k] * layout.units[q].to_si for k, q in enumerate(options)}
    units: dict[str, Any] = {q: unit.metadata() for q, unit in layout.units.items()}
    if rate_hz is not None:
        scaled["time"] = np.arange(len(found)) / rate_hz
        units["time"] = {"unit": f"{rate_hz:g} Hz", "from": "map"}
    return RawChannels(
        name=table.path.stem,
        time_s=scaled["time"],
        position_m=scaled["position"],
        force_n=scaled["force"],
        time_digit_s=table.printed_digit_s(),
        source=str(table.path),
        line_of=lambda sample: next(islice(table.rows(), sample, None))[0],
        details={"columns": guess, "units": units},
        place_m=table.place_m(),
    )


def has_numbers(path: Path) -> bool:
    """Return whether lines enough for a recording have two cells of numbers: prose has none."""
    with path.open("rb") as file:
        encoding = "utf-16" if file.read(2) in _UTF16_MARKS else "latin-1"
    with path.open(encoding=encoding, errors="replace") as text:
        found = (line for line in text if any(_has_two(line, mark) for mark in DELIMITERS))
        return len(list(islice(found, MIN_ROWS))) == MIN_ROWS


def _has_two(line: str, delimiter: str) -> bool:
    row = cells(line, delimiter)
    return 1 < sum(map(is_value, row)) >= (len(row) if delimiter == " " else 0)


# First bytes of files that are no text of numbers, and what they are.
_OTHER_FILES = {
    b"\xd0\xcf\x11\xe0": "an old Excel or Office file",
    b"{\\rtf": "formatted text (RTF)",
    b"%PDF": "a PDF",
}


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
    """Read the bytes once: NumPy names no row for a NUL byte or another encoding.

    Bytes that are no UTF-8 are Windows-1252 where nothing before them speaks for UTF-8.
    """
    with path.open("rb") as file:
        start = file.read(8)
    for begin, name in _OTHER_FILES.items():
        if start.startswith(begin):
            raise DataError(f"{path}: {name}: save it as CSV, one row a sample, in its program")
    if start[:2] in _UTF16_MARKS:
        _check_utf16(path)
        return "utf-16"
    wrong = _not_decoded(path, "utf-8")
    if wrong is None:
        return UTF8
    row, byte, ascii_before = wrong
    if ascii_before and _not_decoded(path, _WINDOWS) is None:
        return _WINDOWS
    raise DataError(
        f"{path}, row {row}: byte 0x{byte:02x} is not UTF-8 text: save the file in UTF-8"
    )


def _check_utf16(path: Path) -> None:
    try:
        text = path.read_text("utf-16")
    except UnicodeError as error:
        raise DataError(f"{path}: not whole UTF-16 text ({error}): save it in UTF-8") from None
    if "\0" in text:
        row = text[: text.index("\0")].count("\n") + 1
        raise DataError(f"{path}, row {row}: a NUL character: export it as CSV in UTF-8")


def _not_decoded(path: Path, encoding: str) -> tuple[int, int, bool] | None:
    """Row and value of the first byte that is none of the encoding's, and whether all are ASCII
    before it."""
    row, ascii_before = 1, True
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
                chunk.decode(encoding)
            except UnicodeDecodeError as error:
                before = chunk[: error.start]
                ascii_before = ascii_before and before.isascii()
                return row + before.count(b"\n"), chunk[error.start], ascii_before
            ascii_before = ascii_before and chunk.isascii()
            row += chunk.count(b"\n")
    return None
