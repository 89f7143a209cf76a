"""Excel workbooks (.xlsx): each sheet with a table is a recording, understood as a CSV file is."""

import json
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.csv.csv_text import read_csv
from springpot.trainer.recordings.formats.file_format import FileRequest
from springpot.trainer.recordings.formats.raw_channels import RawChannels
from springpot.trainer.recordings.reader_limits import read_apart

_MODULE = "springpot.host.formats.workbook_process"


def read_workbook(path: Path, request: FileRequest) -> tuple[list[RawChannels], str]:
    """Read a recording from each sheet that holds one, and say which sheets do not.

    Raises DataError naming sheet and row, that of the first sheet, where no sheet does.
    """
    if find_spec("openpyxl") is None:
        raise ModuleNotFoundError("workbooks are read by openpyxl", name="openpyxl")
    raws: list[RawChannels] = []
    guesses, refusals = [], []
    for title, text in json.loads(read_apart(path, _MODULE)):
        source = f"{path}, sheet {title!r}"
        with TemporaryDirectory() as folder:
            file = Path(folder) / "sheet.tsv"
            file.write_text(text, encoding="utf-8")
            try:
                found, guess = read_csv(file, request)
            except DataError as error:
                refusals.append((title, str(error).replace(str(file), source)))
                continue
            for raw in found:
                name = f"{path.stem}-{title}{raw.name.removeprefix(file.stem)}"
                lines = _lines(raw)
                raws.append(replace(raw, name=name, source=source, line_of=lines.__getitem__))
        guesses.append(f"sheet {title!r}: {guess}")
    if not raws:
        empty = f"{path}: no sheet has cells: give a workbook with a table, one row a sample"
        raise DataError(refusals[0][1] if refusals else empty)
    if len(raws) == 1:
        raws = [replace(raws[0], name=path.stem)]
    guesses += [f"sheet {title!r} is no recording, not read" for title, _ in refusals]
    return raws, "Excel workbook: " + "; ".join(guesses)


def _lines(raw: RawChannels) -> list[int]:
    """The rows of all samples: the sheet's text is gone when one has to be named."""
    first, last = raw.line_of(0), raw.line_of(len(raw.time_s) - 1)
    if last - first == len(raw.time_s) - 1:
        return list(range(first, last + 1))
    return [raw.line_of(sample) for sample in range(len(raw.time_s))]
