"""A CSV table that grows by a row at a time and loses none of them."""

import csv
import io
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.files import sync_path

Row = dict[str, str]


@contextmanager
def growing_table(
    file: Path, columns: Sequence[str]
) -> Iterator[tuple[list[Row], Callable[[Sequence[object]], None]]]:
    """Yield the rows of a table, and what appends one: it is on the disk when that returns.

    A last row that a crash cut is dropped. Raises UsageError while another process has the table,
    DataError where it is damaged.
    """
    import fcntl

    with file.open("a", newline="", encoding="utf-8", errors="backslashreplace") as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise UsageError(f"{file}: in use: close the other window that runs this") from None
        rows = read_table(file, columns)
        stream.truncate(file.read_bytes().rfind(b"\n") + 1)

        def append(row: Sequence[object]) -> None:
            csv.writer(stream, lineterminator="\n").writerow(row)
            stream.flush()
            os.fsync(stream.fileno())

        if not file.stat().st_size:
            append(columns)
            sync_path(file.parent)
        yield rows, append


def read_table(file: Path, columns: Sequence[str]) -> list[Row]:
    """Read a table, no rows where there is no file; a last row that was cut is left out.

    Raises DataError where it has other columns.
    """
    text = file.read_bytes().decode(errors="replace") if file.exists() else ""
    rows = list(csv.reader(io.StringIO(text[: text.rfind("\n") + 1], newline="")))
    for number, row in enumerate(rows, 1):
        if len(row) != len(columns) or (number == 1 and row != list(columns)):
            raise DataError(f"{file}: row {number} is damaged: take the file from your backup")
    return [dict(zip(columns, row, strict=True)) for row in rows[1:]]
