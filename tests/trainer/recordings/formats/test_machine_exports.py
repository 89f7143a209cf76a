"""Files as machines of other trades write them: understood, or one line that says what they are."""

import re
from pathlib import Path

import numpy as np
import pytest
from support.messages import refusing
from support.small import press, soft_force

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import guess_column, parse_map, split_unit
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
    (found,) = import_file(tmp_path / "press.csv", None, "none", None).recordings
    np.testing.assert_allclose(found.position_m, POSITION_M, atol=1e-9)
    np.testing.assert_allclose(found.force_n, FORCE_N, rtol=1e-6, atol=1e-6)


def test_a_known_word_goes_before_one_of_another_trade() -> None:
    """Files that came in before come in as before."""
    assert guess_column(["Time", "Position", "Distance", "Load"], "position") == [1]
    assert guess_column(["Zeit", "Weg", "Kraft", "Kraft max"], "force") == [2]
    assert guess_column(["Travel rate", "Gewicht", "X_Value"], "position") == []
    assert guess_column(["Standardweg [mm]", "Stauchung [%]"], "position") == [0]
    assert guess_column(["Prüfzeit [s]", "Stauchung [mm]"], "position") == [1]


@pytest.mark.parametrize("header", [
    "Time (s)\tPd (µm)\tFn (µN)\tFnRef (µN)\tSegmentID", "Temps (s);Charge (N);Déplacement (mm)",
    "Tiempo (s),Carga (N),Desplazamiento (mm)", "Prüfzeit [s];Standardkraft [N];Traverse abs. [mm]",
    "t [s];F [N];s [mm]", "Time (s),Indentation depth (mm),Indentation force (N)",
    "elapsed_s,z_actual_mm,F_ext_z_N", "Time (s),Gap rate (mm/s),Stroke (mm),Load (kN)",
])  # fmt: skip
def test_each_channel_of_a_header_is_one_column(header: str) -> None:
    """Words of several trades; a column in newtons, or of a force by its words, is no position."""
    row = re.split("[\t;,]", header)
    for quantity, unit in (("time", "s"), ("position", "m"), ("force", "N")):
        (index,) = guess_column(row, quantity)
        assert split_unit(row[index], quantity)[1].endswith(unit)


@pytest.mark.parametrize("map_text", ["time=1,position=2,force=3", ""])
def test_an_indenter_s_table_stands_below_a_blank_line(tmp_path: Path, map_text: str) -> None:
    head = "Indentation\n\n   Pause :\t30.0 s\n\nTime :8:00:16 AM\n\nMeasured values\n"
    rows = "".join(f"{k / 10}\t{k / 5}\t{k}\t5.35\n" for k in range(60))
    text = f"{head}Time (s)\tPd (µm)\tFn (µN)\tFnRef (µN)\n\n{rows}"
    (tmp_path / "a.TXT").write_text(text, encoding="cp1252")
    mapping = parse_map(map_text) if map_text else None
    (found,) = import_file(tmp_path / "a.TXT", mapping, "none", None).recordings
    assert found.position_m[-1] == pytest.approx(11.8e-6)
    assert found.force_n[-1] == pytest.approx(59e-6)


REFUSED = {
    "other words": ("a;b;c\n1,5;2;3\n1,6;3;4\n", ("'a', 'b', 'c'", "--map")),
    "an old workbook": ("\xd0\xcf\x11\xe0", ("Excel", "CSV")),
    "RTF": ("{\\rtf1 1,2,3}", ("RTF", "CSV")),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_no_recording_is_named(tmp_path: Path, what: str) -> None:
    text, said = REFUSED[what]
    file = tmp_path / "press.csv"
    file.write_text(text, encoding="latin-1")
    with refusing(DataError, file, *said):
        import_file(file, None, "none", None)
    with refusing(DataError, tmp_path, "a folder: name its files"):
        import_file(tmp_path, None, "none", None)
