"""Files as machines of other trades write them: understood, or one line that says what they are."""

from pathlib import Path

import numpy as np
import pytest
from support.small import press, soft_force

from springpot.trainer.recordings.formats.importing import import_file

POSITION_M = press(1.0)
FORCE_N = soft_force(POSITION_M)


def table(header: str, scales: tuple[float, ...], order: str = "txf", end: str = "") -> str:
    """A header, and rows of time, position and force, each divided by the scale of its unit."""
    time_s = np.arange(len(FORCE_N)) / 1000.0
    of = dict(zip("txf", (time_s, POSITION_M, FORCE_N), strict=True))
    columns = [of[name] / scale for name, scale in zip(order, scales, strict=True)]
    rows = [",".join(f"{value:.9g}" for value in row) + end for row in zip(*columns, strict=True)]
    return "\n".join([header, *rows]) + "\n"


def german(text: str) -> str:
    return text.replace(",", ";").replace(".", ",")


EXPORTS = {
    "a logger": german(table("Zeit (s),Weg (mm),Kraft (mN)", (1.0, 1e-3, 1e-3))),
    "a comma at the header's end": table("time_s,position_mm,force_N,", (1.0, 1e-3, 1.0)),
    "a comma at every line's end": table("time_s,position_mm,force_N,", (1.0, 1e-3, 1.0), end=","),
    "JSON above the table": '{"rig": "4"}\n' + table("time_s,position_mm,force_N", (1, 1e-3, 1)),
    "a sentence above": "time against position and force\nrun 3 of 5, 0.1 mm a s\n"
    + table("time_s,position_mm,force_N", (1.0, 1e-3, 1.0)),
}


@pytest.mark.parametrize("machine", EXPORTS)
def test_exports_come_in_without_a_map(tmp_path: Path, machine: str) -> None:
    """Layouts of public recordings: tests/host/commands/test_real_layouts.py."""
    (tmp_path / "press.csv").write_text(EXPORTS[machine], encoding="utf-8")
    found, _ = import_file(tmp_path / "press.csv")
    np.testing.assert_allclose(found.position_m, POSITION_M, atol=1e-9)
    np.testing.assert_allclose(found.force_n, FORCE_N, rtol=1e-6, atol=1e-6)
