"""A fuzzer of files: good ones of every format, each made bad in one known place."""

import io
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import can
import cantools
import h5py
import numpy as np
from scipy.io import savemat

from springpot.trainer.recordings.journal_blocks import LAST_METADATA, METADATA, SAMPLES, encode

Rng = np.random.Generator
ROWS = 60
TIME_S = np.arange(ROWS) * 0.01
DBC = """VERSION ""
NS_ :
BS_:
BU_: RIG
BO_ 291 Tool: 8 RIG
 SG_ Position : 0|32@1- (0.0001,0) [0|0] "mm" RIG
 SG_ Force : 32|32@1- (0.001,0) [0|0] "N" RIG
"""
GARBAGE = ["x", "--", "#REF!", "0x10", "1e", "1_0", "٣", "1.2.3", "NaN", "inf", "-inf", "1e999", "",
           "1 2", "+-1", "NULL", "1.5mm", "'1'", "1.234.567", "1e5e5"]  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A malformed file. row: where its fault is, 0: the message names no row.

    surely: whether it must be refused; a flipped byte of a format without checksums need not be.
    """

    what: str
    name: str
    content: bytes
    row: int = 0
    surely: bool = True
    options: dict[str, Any] = field(default_factory=dict)


def malformed(rng: Rng) -> Case:
    """Draw a file. Formats that need a process of their own to be read come less often."""
    kinds: list[tuple[float, Callable[[Rng], Case]]] = [
        (0.62, csv_rows), (0.08, csv_head), (0.12, mach1), (0.06, candump), (0.03, blf),
        (0.05, journal), (0.02, mat), (0.02, hdf5),
    ]  # fmt: skip
    weights = np.array([weight for weight, _ in kinds])
    return kinds[int(rng.choice(len(kinds), p=weights / weights.sum()))][1](rng)


def _table(rng: Rng) -> list[list[str]]:
    position_mm = 5.0 * (1 - np.cos(TIME_S * rng.uniform(3, 20))) + rng.normal(0, 1e-3, ROWS)
    force_n = 2 * position_mm + rng.normal(0, 0.01, ROWS)
    return [[f"{t:.2f}", f"{x:.4f}", f"{f:.5f}"]
            for t, x, f in zip(TIME_S, position_mm, force_n, strict=True)]  # fmt: skip


def _damage(rng: Rng, rows: list[list[str]], joint: str) -> tuple[str, int]:
    """Spoil one row in place; return what was done and the index of the row that is to be named."""
    k = int(rng.integers(2, len(rows) - 2))
    column = int(rng.integers(0, 3))
    fault = rng.choice(["cell", "missing row", "twice", "swapped", "short", "long", "jump"])
    match fault:
        case "cell":
            garbage = GARBAGE[int(rng.integers(len(GARBAGE)))]
            rows[k][column] = garbage
            return f"cell {garbage!r} in column {column + 1}", k
        case "missing row":
            del rows[k]
        case "twice":
            rows.insert(k, list(rows[k]))
            return "row twice", k + 1
        case "swapped":
            rows[k], rows[k + 1] = rows[k + 1], rows[k]
            return "rows swapped", k + 1
        case "short":
            del rows[k][-1 if column else 0]
        case "long":
            rows[k].insert(column, "1")
        case "jump":
            for row in rows[k:]:
                row[0] = f"{float(row[0]) + 0.05:.2f}"
    return str(fault), k


def csv_rows(rng: Rng) -> Case:
    """A CSV file of some dialect with one bad row."""
    rows = _table(rng)
    delimiter = str(rng.choice([",", ";", "\t"]))
    what, bad = _damage(rng, rows, delimiter)
    lines = [delimiter.join(row) for row in rows]
    comma = delimiter != "," and rng.random() < 0.5
    if comma:
        lines = [
            line.replace(".", ",") if "cell" not in what or k != bad else
            delimiter.join(c if c in GARBAGE else c.replace(".", ",") for c in rows[k])
            for k, line in enumerate(lines)
        ]  # fmt: skip
    head = [f"Preamble{delimiter}{k}" for k in range(int(rng.integers(0, 9)))]
    if rng.random() < 0.5:
        head.append(delimiter.join(("Time (s)", "Extension [mm]", "Load / N")))
    else:
        head += [delimiter.join(("time", "position", "force")), delimiter.join(("s", "mm", "N"))]
    newline = str(rng.choice(["\n", "\r\n"]))
    text = newline.join(head + lines) + newline * int(rng.integers(0, 2))
    row = len(head) + bad + 1
    content = text.encode(str(rng.choice(["utf-8", "utf-8-sig", "utf-16"], p=[0.6, 0.3, 0.1])))
    if not content.startswith((b"\xff\xfe", b"\xfe\xff")) and rng.random() < 0.1:
        raw = content.split(b"\n")
        row = int(rng.integers(1, bad + len(head)))  # before the fault that is there already
        raw[row - 1] += bytes([int(rng.choice([0, 0x81, 0x9D]))])
        what, content = "a byte that is no text", b"\n".join(raw)
    return Case(f"CSV, {what}, comma {comma}", "a.csv", content, row)


def csv_head(rng: Rng) -> Case:
    """A CSV file whose header cannot be understood."""
    rows = "\n".join(",".join(row) for row in _table(rng))
    heads = {
        "no header": "", "no unit": "time_s,position_mm,force\n",
        "no force": "time_s,position_mm,x\n",
        "unknown unit": "time_s,position (furlong),force_N\n",
        "either case": "time_s,position_mm,force (mn)\n",
        "two forces": "time_s,force_N,load_N\n", "noise": "\x01\x02\x03\n",
    }  # fmt: skip
    what = str(rng.choice([*heads, "empty", "one row", "bytes"]))
    match what:
        case "empty":
            return Case("empty", "a.csv", b"\n" * int(rng.integers(0, 5)))
        case "one row":
            return Case(what, "a.csv", b"time_s,position_mm,force_N\n0,0,0\n")
        case "bytes":
            return Case(what, "a.csv", b"x" + rng.bytes(int(rng.integers(1, 2000))))
    return Case(f"CSV, {what}", "a.csv", (heads[what] + rows).encode())


def mach1(rng: Rng) -> Case:
    """A Mach-1 file with a bad row, parameter or end."""
    head = ["<Mach-1 File>", "<INFO>", "Time:\t10:08", "Load Cell Low-pass filter:\tYes",
            "Load Cell Low-pass filter Order:\t3",
            "Load Cell Low-pass filter Cutoff frequency (Hz):\t20.0", "<END INFO>", "<Sinusoid>",
            "Stage Axis:\tPosition (z)", "Amplitude, mm:\t0.5", "Frequency, Hz:\t1.0",
            "Number of Cycles:\t20", "<DATA>", "Time, s\tPosition (z), mm\tFz, gf"]  # fmt: skip
    rows = _table(rng)
    end = ["<END DATA>"]
    fault = str(rng.choice(["row", "row", "row", "end", "parameter", "axis", "unit"]))
    what, row = fault, 0
    match fault:
        case "row":
            what, bad = _damage(rng, rows, "\t")
            row = len(head) + bad + 1
        case "end":
            end = []
        case "parameter":
            k = int(rng.choice([4, 5, 9, 10, 11]))
            head[k] = (
                head[k].split("\t")[0] + "\t" + str(rng.choice(["", "x", "nan", "inf", "1e999"]))
            )
        case "axis":
            head[8] = "Stage Axis:\tPosition (y)"
        case "unit":
            head[13] = head[13].replace("gf", str(rng.choice(["", "stone", "MN"])))
    lines = head + ["\t".join(row) for row in rows] + end
    return Case(f"Mach-1, {what}", "a.txt", "\r\n".join(lines).encode(), row)


@cache
def can_frames(form: str, **options: int) -> bytes:
    """A good log of CAN frames, as candump's "log" or as "blf"."""
    database = cantools.database.load_string(DBC)
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"a.{form}"
        with can.Logger(path, **options) as logger:
            for t in TIME_S.tolist():
                data = database.encode_message("Tool", {"Position": 100 * t, "Force": 200 * t})
                logger(can.Message(1e9 + t, 291, is_extended_id=False, data=data, channel="v0"))
        return path.read_bytes()


def candump(rng: Rng) -> Case:
    """A candump log with a bad line."""
    lines = can_frames("log").decode().splitlines()
    k = int(rng.integers(2, ROWS - 2))
    fault = str(rng.choice(["mark", "odd", "short", "swapped", "missing", "text"]))
    row = k + 1
    match fault:
        case "mark":
            lines[k] = lines[k].replace("#", "?")
        case "odd":
            lines[k] = lines[k].replace("#", "#0", 1)
        case "short":
            lines[k] = lines[k][: lines[k].index("#") + 5]
        case "swapped":
            lines[k], lines[k + 1] = lines[k + 1], lines[k]
            row = k + 2
        case "missing":
            del lines[k]
            row = k + 1
        case "text":
            lines[k] = "hello"
    return Case(f"candump, {fault}", "a.log", "\n".join(lines).encode(), row, options={"dbc": True})


def _cut_or_flipped(rng: Rng, content: bytes, checked: bool) -> tuple[str, bytes, bool]:
    if rng.random() < 0.5:
        return "cut", content[: int(rng.integers(1, len(content)))], True
    flipped = bytearray(content)
    flipped[int(rng.integers(len(content)))] ^= int(rng.integers(1, 256))
    return "flipped byte", bytes(flipped), checked


def blf(rng: Rng) -> Case:
    """A BLF log cut short, or with a flipped byte."""
    what, content, surely = _cut_or_flipped(rng, can_frames("blf"), False)
    return Case(f"BLF, {what}", "a.blf", content, surely=surely, options={"dbc": True})


def journal(rng: Rng) -> Case:
    """A journal without its metadata, or with a flipped byte in its first block."""
    metadata = (
        b'{"schema": 1, "name": "a", "dt_s": 0.001, "source": "", "details": {}, "block_s": 0.2}'
    )
    blocks = [encode(7, 0, LAST_METADATA, metadata)]
    blocks += [encode(7, k, SAMPLES, rng.bytes(16 * 200)) for k in range(1, 4)]
    match str(rng.choice(["flipped", "only metadata", "half", "no end"])):
        case "flipped":
            first = bytearray(blocks[0])
            first[int(rng.integers(8, len(first)))] ^= int(rng.integers(1, 256))
            blocks[0] = bytes(first)
        case "only metadata":
            blocks = blocks[:1]
        case "half":
            blocks = [blocks[0][: int(rng.integers(8, 4096))]]
        case "no end":
            blocks[0] = encode(7, 0, METADATA, metadata)
    return Case("journal", "a.journal", b"".join(blocks))


@cache
def stored_arrays(form: str) -> bytes:
    """A good file of three arrays, "mat" or "h5"."""
    memory = io.BytesIO()
    arrays = {"time_s": TIME_S, "position_mm": 100 * TIME_S, "force_N": 200 * TIME_S}
    if form == "mat":
        savemat(memory, arrays)
    else:
        with h5py.File(memory, "w") as file:
            for name, values in arrays.items():
                file.create_dataset(name, data=values, fletcher32=True)
    return memory.getvalue()


def mat(rng: Rng) -> Case:
    """A MAT file cut short, or with a flipped byte."""
    what, content, surely = _cut_or_flipped(rng, stored_arrays("mat"), False)
    return Case(f"MAT, {what}", "a.mat", content, surely=surely)


def hdf5(rng: Rng) -> Case:
    """An HDF5 file cut short, or with a flipped byte."""
    what, content, surely = _cut_or_flipped(rng, stored_arrays("h5"), False)
    return Case(f"HDF5, {what}", "a.h5", content, surely=surely)
