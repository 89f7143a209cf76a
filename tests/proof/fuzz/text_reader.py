"""Text to import: CSV of several dialects."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from proof.fuzz.reader import Reader
from support.files.malformed import TIME_S

from springpot.trainer.recordings.formats.importing import import_file


def _rows(delimiter: str) -> str:
    values = zip(TIME_S[:12], 5.0 * (1 - np.cos(9 * TIME_S[:12])), 3 * TIME_S[:12], strict=True)
    return "\n".join(f"{t:.2f}{delimiter}{x:.4f}{delimiter}{f:.5f}" for t, x, f in values)


def seeds() -> Iterator[tuple[str, bytes]]:
    """Each dialect once."""
    yield "csv", ("time_s,position_mm,force_N\n" + _rows(",")).encode()
    lines = "Rig;7\nTime (s);Extension [mm];Load / N\n" + _rows(";").replace(".", ",")
    yield "semicolons", lines.encode("utf-8-sig")
    yield "tabs", ("time\tposition\tforce\ns\tmm\tN\n" + _rows("\t")).encode("utf-16")
    yield "text", (b'"time_s","position_mm","force_N","note"\n0,0,0,"a, b"\n0.1,1,1,""\n')


def read_import(content: bytes, folder: Path, name: str) -> None:
    """Import it, every other length resampled."""
    file = folder / name
    file.write_bytes(content)
    resample_hz = 50.0 if len(content) % 2 else None
    import_file(file, None, "none", resample_hz)


def read(content: bytes, folder: Path) -> None:
    read_import(content, folder, "a.csv")


READER = Reader(
    seeds,
    read,
    words=(
        "time_s", "position_mm", "force_N", "Time (s)", "Extension [mm]", "Load / N", "1e999",
        "nan", "inf", "-1e308", "1e-320", "\\xff\\xfe", "\\xef\\xbb\\xbf", "#", "\\x22", ";",
        "\\x09",
        "\\xc2\\xb5m", "%", "1_0", "\\x0b", "\\x1c", "\\xc2\\x85",
        "10:12:00.5", "1,007.5", "1.007,5", "End of test", "Time,x,force",
    ),
)  # fmt: skip
