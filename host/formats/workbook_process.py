"""Read the sheets of an Excel workbook as text: run as a process of its own, within its limits.

Prints JSON: a list of title and text of each sheet that has cells, cells between tabs.
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from zipfile import ZipFile

from springpot.trainer.recordings.reader_limits import require_unpacked, run_reader


def sheets_as_json(path: Path) -> bytes:
    """Title and text of each sheet; row k of a sheet is line k of its text."""
    import openpyxl

    with ZipFile(path) as archive:
        unpacked = sum(part.file_size for part in archive.infolist())
    require_unpacked(path, unpacked, "MiB of sheets")
    book = openpyxl.load_workbook(path, read_only=True, data_only=True)
    found = [(sheet.title, _text(sheet.iter_rows(values_only=True))) for sheet in book.worksheets]
    return json.dumps([(title, text) for title, text in found if text.strip()]).encode()


def _text(rows: Iterator[tuple[object, ...]]) -> str:
    """Lines of as many cells as the longest row has, so that a missing cell is an empty one."""
    table = [["" if cell is None else _cell(cell) for cell in row] for row in rows]
    width = max((k + 1 for row in table for k, cell in enumerate(row) if cell), default=0)
    lines = ["\t".join((row + [""] * width)[:width]) if any(row) else "" for row in table]
    return "\n".join(lines) + "\n"


def _cell(value: object) -> str:
    if isinstance(value, int | float):
        return repr(value)
    return " ".join(str(value).replace('"', "'").split())


if __name__ == "__main__":
    run_reader(Path(sys.argv[1]), sheets_as_json)
