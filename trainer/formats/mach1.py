"""Mach-1 text files: the sinusoid blocks that Biomomentum's Mach-1 Motion software writes.

A file is a row of blocks: `<INFO>` with facts of the set-up, then one block a function, such as
`<Sinusoid>`, with its parameters and, between `<DATA>` and `<END DATA>`, a table with a header.
Both signs are springpot's already: the stage's position grows downwards, into the sample, and the
force along the same axis grows in compression.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from springpot.runtime_c.errors import DataError
from springpot.trainer.formats.sampling import RawChannels
from springpot.trainer.formats.units import Quantity, factor_to_si

MAGIC = b"<Mach-1 File>"
_BLOCK = "Sinusoid"
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


def read_mach1(path: Path) -> tuple[list[RawChannels], str]:
    """Read every sinusoid block, and say which ones came out and which were left out.

    Raises DataError naming file and row for a file without such a block and for a damaged table.
    """
    sinusoids, left_out = [], []
    for block in _blocks(path):
        if block.kind == _BLOCK:
            sinusoids.append(block)
        else:
            left_out.append(f"<{block.kind}> in row {block.line}")
    others = f"; left out, only <{_BLOCK}> is read: {', '.join(left_out)}" if left_out else ""
    if not sinusoids:
        raise DataError(
            f"{path}: no <{_BLOCK}> block{others}: export such a block, or import the others as CSV"
        )
    recordings = [_channels(path, block) for block in sinusoids]
    names = ", ".join(f"{raw.details['frequency_hz']:g} Hz" for raw in recordings)
    return recordings, f"Mach-1 text, {len(recordings)} <{_BLOCK}> blocks: {names}{others}"


def _blocks(path: Path) -> Iterator[_Block]:
    """Split the file into blocks; `<INFO>` belongs to all blocks up to the next one."""
    info: dict[str, str] = {}
    block: _Block | None = None
    in_info = in_data = False
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
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
    if in_data:
        raise DataError(f"{path}: ends without <END DATA>: the file is cut short, export it again")
    if block:
        yield block


def _channels(path: Path, block: _Block) -> RawChannels:
    where = f"{path}, <{block.kind}> in row {block.line}"
    header = block.table[0].split("\t") if block.table else []
    columns = _columns(where, header, block.parameters.get("Stage Axis", "Position (z)"))
    numbers = _numbers(path, block, len(header))
    scaled = {
        quantity: numbers[:, index]
        * factor_to_si(header[index].rpartition(",")[2], quantity, where)
        for quantity, index in columns.items()
    }
    frequency_hz = _value(where, block.parameters, "Frequency, Hz")
    decimals = _TIME_DECIMALS.match(block.table[-1])
    return RawChannels(
        name=f"{path.stem}-{frequency_hz:g}Hz",
        time_s=scaled["time"],
        position_m=scaled["position"],
        force_n=scaled["force"],
        time_digit_s=10.0 ** -len(decimals[1]) if decimals else 0.0,
        source=f"{path}, {frequency_hz:g} Hz",
        line_of=lambda sample: block.table_line + 1 + sample,
        details={"frequency_hz": frequency_hz} | _details(where, block),
    )


def _columns(where: str, header: list[str], axis: str) -> dict[Quantity, int]:
    """Find time, the moving axis and the force along it: other axes may stand beside them."""
    letter = _AXIS.fullmatch(axis)
    labels = [cell.rpartition(",")[0].strip() for cell in header]
    wanted: dict[Quantity, str] = {
        "time": "Time",
        "position": axis,
        "force": f"F{letter[1] if letter else 'z'}",
    }
    for quantity, label in wanted.items():
        if labels.count(label) != 1:
            raise DataError(
                f"{where}: needs one column {label!r} of {quantity}, its table has {header}: "
                "export that channel"
            )
    return {quantity: labels.index(label) for quantity, label in wanted.items()}


def _numbers(path: Path, block: _Block, width: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    rows = []
    for number, line in enumerate(block.table[1:], block.table_line + 1):
        try:
            rows.append([float(cell) for cell in line.split("\t")])
        except ValueError as error:
            raise DataError(f"{path}, row {number}: {error}: correct it in the source") from None
        if len(rows[-1]) != width:
            raise DataError(
                f"{path}, row {number}: {len(rows[-1])} cells, the header has {width}: "
                "correct that row in the source"
            )
    return np.array(rows, dtype=np.float64).reshape(len(rows), width)


def _details(where: str, block: _Block) -> dict[str, Any]:
    """Carry what tells how far the samples can be trusted: the load cell's filter delays force."""
    details: dict[str, Any] = {
        "amplitude_m": _value(where, block.parameters, "Amplitude, mm") * 1e-3
    }
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
        return float(values[key])
    except KeyError:
        raise DataError(f"{where}: no {key!r}: export the block with its parameters") from None
    except ValueError:
        raise DataError(f"{where}: {key!r} is {values[key]!r}, not a number") from None
