"""The real recordings of tests/data/mach1: sinusoids of a Mach-1 tester, in its own text."""

import re
from pathlib import Path

import numpy as np

from springpot import Recording


def mach1_recordings(path: Path, zero: str = "min") -> list[Recording]:
    """One recording a block, named by its frequency."""
    _, *blocks = path.read_text(encoding="utf-8-sig").split("<Sinusoid>")
    found = []
    for block in blocks:
        (frequency_hz,) = re.findall(r"Frequency, Hz:\t(\S+)", block)
        rows = block.partition("<DATA>")[2].partition("<END DATA>")[0].strip().split("\n")
        table = dict(zip(rows[0].strip().split("\t"), np.loadtxt(rows[1:]).T, strict=True))
        found += [Recording.from_frame(
            table, f"{path.stem}-{float(frequency_hz):g}Hz", time="Time, s:s",
            position="Position (z), mm:mm", force="Fz, gf:gf", zero=zero,
        )]  # fmt: skip
    return found
