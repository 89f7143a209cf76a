"""A fuzzer of files in rows: good ones of each format, each made bad in one known place."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Rng = np.random.Generator
ROWS = 60
TIME_S = np.arange(ROWS) * 0.01
GARBAGE = ["x", "--", "#REF!", "0x10", "1e", "1_0", "٣", "1.2.3", "NaN", "inf", "-inf", "1e999", "",
           "1 2", "+-1", "NULL", "1.5mm", "'1'", "1.234.567", "1e5e5"]  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A malformed file. row: where its fault is, 0: the message names no row."""

    what: str
    name: str
    content: bytes
    row: int = 0


def malformed(rng: Rng) -> Case:
    """Draw a file; those with a bad row in a table come most often."""
    kinds: list[tuple[float, Callable[[Rng], Case]]] = [
        (0.9, csv_rows), (0.1, csv_head),
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
