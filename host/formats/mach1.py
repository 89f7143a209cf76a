"""Mach-1 text files, as Biomomentum's Mach-1 Motion software writes them: every block with samples.

A file is a row of blocks: `<INFO>` with metadata of the set-up, then one block a function, such as
`<Sinusoid>`, with its parameters and, between `<DATA>` and `<END DATA>`, a table with a header.
`<divider>` lines cut a table into steps whose time begins anew: each is a recording.
Both signs are springpot's already: the stage's position grows downwards, into the sample, and the
force along the same axis grows in compression.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.formats.column_map import ColumnMap, stated_rate_hz
from springpot.trainer.recordings.formats.csv.decimals import is_number
from springpot.trainer.recordings.formats.file_format import FileRequest
from springpot.trainer.recordings.formats.raw_channels import RawChannels
from springpot.trainer.recordings.formats.sampling import MIN_ROWS
from springpot.trainer.recordings.formats.units import Quantity, Unit, choose_unit

_SINUSOID = "Sinusoid"
_FREQUENCY = "Frequency, Hz"
_DIVIDER = "<divider>"
Table = np.ndarray[Any, np.dtype[np.float64]]
_TAG = re.compile(r"<([^<>]+)>")
_AXIS = re.compile(r"Position \((\w+)\)")
_TIME_DECIMALS = re.compile(r"\d+\.?(\d*)")


@dataclass
class _Block:
    """One function of the file: its parameters, and its table as lines of text."""

    kind: str
    line: int
    info: Mapping[str, str]
    parameters: dict[str, str] = field(default_factory=dict)
    table: list[str] = field(default_factory=list)
    table_line: int = 0
    stopped: bool = False  # by hand: there is no <END DATA>


def read_mach1(path: Path, request: FileRequest) -> tuple[list[RawChannels], str]:
    """Read every block with samples, and say which ones came out and which were left out.

    Columns are named for channels that are not the stage's own axis, or whose sign is turned.
    Raises DataError naming file and row for a file without such a block and for a damaged table,
    UsageError for a stated time.
    """
    kind, columns = request.block, request.columns
    if stated_rate_hz(columns) is not None:
        raise UsageError(f"{path}: a Mach-1 file has its own time: leave time= out of --map")
    read, left_out = [], []
    for block in _blocks(path):
        if kind is not None and block.kind.casefold() != kind.casefold():
            left_out.append(f"<{block.kind}> in row {block.line} (--block)")
        elif sum(1 for line in block.table if line.strip()) <= MIN_ROWS:
            left_out.append(f"<{block.kind}> in row {block.line} ({_too_short(block)})")
        else:
            read.append(block)
    others = f"; left out: {', '.join(left_out)}" if left_out else ""
    if not read:
        options = f"<{kind}> block" if kind else "block"
        raise DataError(f"{path}: no {options} with samples{others}: export one with its data")
    recordings = [step for block in read for step in _steps(path, block, columns)]
    names = ", ".join(
        f"<{block.kind}> in row {block.line}"
        + (" (stopped: no <END DATA>, its rows are whole)" if block.stopped else "")
        for block in read
    )
    return recordings, f"Mach-1 text, {len(read)} blocks: {names}{others}"


def _too_short(block: _Block) -> str:
    rows = max(0, len(block.table) - 1)
    return f"{rows} rows of samples" if rows else "no samples"


def _blocks(path: Path) -> Iterator[_Block]:
    """Split the file into blocks; `<INFO>` belongs to all blocks up to the next one."""
    info: dict[str, str] = {}
    block: _Block | None = None
    in_info = in_data = False
    try:
        lines = path.read_text(encoding="utf-8-sig").split("\n")  # as editors count rows
    except UnicodeDecodeError as error:
        raise DataError(f"{path}: not UTF-8 text ({error.reason}): export it again") from None
    for number, line in enumerate(lines, 1):
        tag = _TAG.fullmatch(line.strip())
        if tag and tag[1] == "END DATA":
            in_data = False
        elif in_data and block:
            block.table.append(line)
        elif tag and tag[1] in ("INFO", "END INFO"):
            in_info = tag[1] == "INFO"
            info = {} if in_info else info
        elif tag and tag[1] == "DATA" and block:
            in_data, block.table_line = True, number + 1
        elif tag and number > 1:
            if block:
                yield block
            block = _Block(tag[1], number, info)
        elif ":" in line:
            key, _, value = line.partition(":")
            target = info if in_info or block is None else block.parameters
            target[key.strip()] = value.strip()
    if block and in_data:
        _require_whole(path, block)
        block.stopped = True
    if block:
        yield block


def _require_whole(path: Path, block: _Block) -> None:
    """Refuse a table without an end mark if its last row may be cut through."""
    rows = [line for line in block.table if line.strip()]
    ended = bool(rows) and not block.table[-1].strip()  # by the end of a line
    if not ended or len(rows[-1].split("\t")) < len(rows[0].split("\t")):
        raise DataError(
            f"{path}: ends without <END DATA>, within a row: the file is cut short, export it again"
        )


def _steps(path: Path, block: _Block, columns: ColumnMap) -> list[RawChannels]:
    """One recording for a block, or for each part between its dividers."""
    where = f"{path}, <{block.kind}> in row {block.line}"
    header = block.table[0].split("\t")
    first = block.table_line + 1
    parts: list[list[tuple[int, str]]] = [[]]
    for number, line in enumerate(block.table[1:], first):
        if line.strip() == _DIVIDER:
            parts.append([])
        elif line.strip():
            parts[-1].append((number, line))
    parts = [part for part in parts if part]
    name = f"{path.stem}-{_label(where, block)}"
    steps = []
    for k, part in enumerate(parts, 1):
        step = f"-{k}" if len(parts) > 1 else ""
        steps.append(_channels(path, where, block, header, part, name + step, columns))
    return steps


def _label(where: str, block: _Block) -> str:
    """Name a sinusoid by its frequency, anything else by its kind."""
    if block.kind == _SINUSOID:
        return f"{_value(where, block.parameters, _FREQUENCY):g}Hz"
    return block.kind.replace(" ", "-")


def _channels(
    path: Path,
    where: str,
    block: _Block,
    header: list[str],
    rows: list[tuple[int, str]],
    name: str,
    columns: ColumnMap,
) -> RawChannels:
    axis = block.parameters.get("Stage Axis", "Position (z)")
    chosen = _columns(where, header, axis, columns)
    numbers = _numbers(path, rows, len(header))
    units = {q: _unit(where, q, header[index], columns) for q, index in chosen.items()}
    scaled = {q: numbers[:, index] * units[q].to_si for q, index in chosen.items()}
    decimals = _TIME_DECIMALS.match(rows[-1][1])
    return RawChannels(
        name=name,
        time_s=scaled["time"],
        position_m=scaled["position"],
        force_n=scaled["force"],
        time_digit_s=10.0 ** -len(decimals[1]) if decimals else 0.0,
        source=f"{path}, {name.removeprefix(f'{path.stem}-')}",
        line_of=lambda sample: rows[sample][0],
        details=_details(where, block) | {"units": {q: u.metadata() for q, u in units.items()}},
    )


def _unit(where: str, quantity: Quantity, header: str, columns: ColumnMap) -> Unit:
    label, _, text = header.rpartition(",")
    stated = columns[quantity].unit if quantity in columns else None
    return choose_unit({"map": stated, "header": text.strip()}, quantity, where, label.strip())


def _columns(where: str, header: list[str], axis: str, columns: ColumnMap) -> dict[Quantity, int]:
    """Find time, the moving axis and the force along it: other axes may stand beside them."""
    letter = _AXIS.fullmatch(axis)
    labels = [cell.rpartition(",")[0].strip() for cell in header]
    options: dict[Quantity, str] = {
        "time": "Time",
        "position": axis,
        "force": f"F{letter[1] if letter else 'z'}",
    }
    options |= {q: str(column.header_or_number) for q, column in columns.items()}
    for quantity, label in options.items():
        if labels.count(label) != 1:
            raise DataError(
                f"{where}: needs one column {label!r} of {quantity}, its table has {header}: "
                "export that channel"
            )
    return {quantity: labels.index(label) for quantity, label in options.items()}


def _numbers(path: Path, lines: list[tuple[int, str]], width: int) -> Table:
    rows = []
    for number, line in lines:
        cells = line.split("\t")
        wrong = next((cell for cell in cells if not is_number(cell)), None)
        if wrong is not None:
            raise DataError(
                f"{path}, row {number}: {wrong!r} is not a number: correct it in the source"
            )
        rows.append([float(cell) for cell in cells])
        if len(rows[-1]) != width:
            raise DataError(
                f"{path}, row {number}: {len(rows[-1])} cells, the header has {width}: "
                "correct that row in the source"
            )
    return np.array(rows, dtype=np.float64).reshape(len(rows), width)


def _details(where: str, block: _Block) -> dict[str, Any]:
    """Metadata that limit how far samples can be trusted: the load cell's filter delays force."""
    details: dict[str, Any] = {"block": block.kind}
    if block.kind == _SINUSOID:
        details["frequency_hz"] = _value(where, block.parameters, _FREQUENCY)
        details["amplitude_m"] = _value(where, block.parameters, "Amplitude, mm") * 1e-3
    if "Number of Cycles" in block.parameters:
        details["cycles"] = int(_value(where, block.parameters, "Number of Cycles"))
    if block.info.get("Load Cell Low-pass filter") == "Yes":
        low_pass = "Load Cell Low-pass filter"
        details["load_cell_low_pass_order"] = int(_value(where, block.info, f"{low_pass} Order"))
        details["load_cell_low_pass_hz"] = _value(
            where, block.info, f"{low_pass} Cutoff frequency (Hz)"
        )
    return details


def _value(where: str, values: Mapping[str, str], key: str) -> float:
    try:
        value = float(values[key])
    except KeyError:
        raise DataError(f"{where}: no {key!r}: export the block with its parameters") from None
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise DataError(f"{where}: {key!r} is {values[key]!r}, not a number: correct it")
    return value
