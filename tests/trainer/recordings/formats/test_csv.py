"""CSV files -> recordings: what is understood, and what is refused with file and row.

Layouts of public recordings: tests/host/commands/test_mistakes.py.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from support.files.imported import GOOD, load, refusal
from support.small import DT_S, press, soft_force

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import parse_map
from springpot.trainer.recordings.formats.importing import (
    ImportOptions,
    import_file,
    parse_place_option,
)

COMMA, HEAD = GOOD.replace(",", ";").replace(".", ","), "time_s;position_m;force_N\n"
ROWS = GOOD.partition("\n")[2]


@pytest.mark.parametrize(
    ("header", "delimiter", "mapping"),
    [
        ("\ufefftime ms\tdisplacement mm\tforce N", "\t", ""),
        ('"Time, ms","Extension (mm)","Load, N"', ",", ""),
        ("TIME_MS,POSITION_MM,FORCE_N", ",", ""),
        ("Time (Msec),Depth (Millimetres),Load (Newton)", ",", ""),
        ("t,x,f", ",", "time=t:ms,position=x:mm,force=f:N"),
        ("t (s),x (m),f (N)", ",", "time=1:0.001s,position=2:0.001m,force=3:N"),
        ("", ",", "time=1:ms,position=2:mm,force=3:N"),
    ],
)
def test_headers(tmp_path: Path, header: str, delimiter: str, mapping: str) -> None:
    body = [delimiter.join(map(str, row)) for row in [(0, 0, 0), (10, 1, 2), (20, 2, 4)]]
    found = load(tmp_path, "\n".join([header, *body] if header else body), mapping)
    np.testing.assert_allclose(found.position_m, [0.0, 0.001, 0.002])
    assert found.force_n.tolist() == [0.0, 2.0, 4.0] and found.dt_s == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GOOD.replace("0.1,1\n", "nan,1\n"), "row 3: position is empty or not a finite number"),
        (GOOD.replace("0.1,1\n", ",1\n"), "row 3: position is empty or not a finite number"),
        (GOOD.replace("0.001", "\n\n0.001").replace("0.003,", "0.002,"), "row 7: time stands"),
        (GOOD.replace("0.003,", "0.0015,"), "row 5: time goes back from 0.002 s to 0.0015 s"),
        (GOOD.replace("0.002,0.2,2\n", ""), "row 4: gap of 0.002 s"),
        (GOOD.replace(",", ";").replace("0.2;2", "0,2;2"), "row 4, column 2: '0,2' is not a"),
        (GOOD.replace("0.1,1\n", "0.1,1_0\n"), "row 3, column 3: '1_0' is not a number"),
        (COMMA.replace("0,002;0,2", "0,002;1.0,2"), "'1.0,2' is not a number with a decimal comma"),
        (HEAD + "0;1;1,000\n1;2;2,000\n2;3;3,000\n", "row 2: '1,000' may be a decimal comma or"),
        (HEAD + "0;1.5;1 007.5\n1;2.5;9\n2;3.5;9\n", "row 2, column 3: '1 007.5' is not a"),
        (HEAD + "0;1;1\n10:12:01;2;2\n10:12:02;3;3\n", "row 3, column 1: '10:12:01' is not a"),
        (GOOD.replace("0.1,1\n", "0.1,1,7\n"), "row 3: 4 cells, the header and the rows above"),
        (GOOD[: GOOD.index("0.002")], "2 rows of numbers: a recording needs 3"),
        (GOOD[: GOOD.index("0.000")], "0 rows of numbers"),
        ("", "the file is empty"),
        (GOOD.replace("force_N", "stress_Pa"), "found no column of force in row 1"),
        (ROWS, "found no column of time or of position or of force"),
        (GOOD.replace("time_s", "load_N"), "found no column of time"),
        (GOOD.replace("time_s,", "load_N,"), "found no column of time"),
        ("Load Cell,1 kN,,\nTime,Strain,Stress (MPa)\n0,0,0\n", "found row 2, which has 'Time'"),
        (GOOD.replace("force_N", "force_mn"), "--map force=force_mn:UNIT, with"),
        (GOOD.encode().replace(b"0.2", b"0\0002"), "control characters, so no text"),
        (GOOD.encode().replace(b"0.2", b"0\xb52"), "row 4, column 2: '0\u00b52' is not a number"),
        (GOOD.encode().replace(b"0.2", b"0\x812"), "row 4, column 2: '0\ufffd2' is not a number"),
        ("time_s,position_m,load_N,force_N\n0,0,9,0\n", "force may be column 3 'load_N', 4 'fo"),
    ],
)
def test_refused(tmp_path: Path, text: str | bytes, message: str) -> None:
    assert message in refusal(tmp_path, text)


ENDS = {
    "a mark": ['"Ende der Prüfung"'],
    "blank lines and results": ["", "End of test", "Maximum load,8.12,N", "Work (J),0.12"],
    "a table of results": ["", "Maximum (N),Modulus (MPa),Work (J)", "8.12,0.21,3.4", ""],
    "a table below its title": ["Results", "Maximum (N),Modulus (MPa),Work (J)", "8.12,0.21,3.4"],
    "statistics": ["", "Cycle,Peak (N)", "1,8.1", "2,8.0", "3,7.9", "Mean,8.0"],
    "results with numbers in their names": ["Load at 10 %,8.12,N", "Cycle 2,8.0,7.9"],
    "a rule": ["", "-----", "Operator;me"],
    "a date": ["", "Saved,11/24/2026 4:20:01 PM"],
}


def pressed(first: int, count: int) -> list[str]:
    """Rows at 50 Hz from a sample on: position is its number in mm, force twice that in N."""
    return [f"{k / 50:.2f},{k}.5,{2 * k}.25" for k in range(first, first + count)]


@pytest.mark.parametrize("name", ENDS)
def test_text_behind_the_numbers_is_left_out(name: str, tmp_path: Path) -> None:
    lines = ["Time (s),Position (mm),Force (N)", *pressed(0, 30), *ENDS[name], ""]
    (tmp_path / "a.csv").write_text("\n".join(lines))
    recording, guess = import_file(tmp_path / "a.csv")
    assert recording.force_n[[0, -1]].tolist() == [0.25, 58.25]
    row = 32 + (not ENDS[name][0])
    assert re.search(f"left out: (text|other columns) from row {row} on, '", guess)


DAMAGED = ["0.2,OVERLOAD,4", "0.2,3.5", "0.2,,4.25", "0.2x,3.5,4.25", "paused", "paused,,",
           "x,3.5,4.25", "operator,pressed,pause", ",3.5,4.25"]  # fmt: skip


@pytest.mark.parametrize("damaged", DAMAGED)
@pytest.mark.parametrize("behind", [30, 2, 1, 0])
def test_a_damaged_row_is_refused(damaged: str, behind: int, tmp_path: Path) -> None:
    """At the very end, words are text behind the numbers."""
    lines = ["time_s,position_mm,force_N", *pressed(0, 10), damaged, *pressed(11, behind)]
    if behind or damaged in DAMAGED[:4]:
        assert "row 12" in refusal(tmp_path, "\n".join(lines))


@pytest.mark.parametrize(("delimiter", "quote"), [(";", ""), (",", '"')])
def test_a_decimal_comma_can_be_stated(delimiter: str, quote: str, tmp_path: Path) -> None:
    file = tmp_path / "rig.csv"
    rows = "".join(f"{k};{k};{quote}{k + 1},500{quote}\n" for k in range(3))
    file.write_text(f"{HEAD}{rows}".replace(";", delimiter))
    with pytest.raises(DataError, match="pass --decimal comma"):
        import_file(file)
    stated, _ = import_file(file, options=ImportOptions("comma"))
    assert stated.force_n.tolist() == [1.5, 2.5, 3.5]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(
    st.lists(st.floats(-1e9, 1e9), min_size=3, max_size=30),
    st.sampled_from([",", ";", "\t"]),
    st.sampled_from(["\n", "\r\n"]),
)
def test_numbers_arrive_bit_for_bit(
    tmp_path: Path, values: list[float], delimiter: str, newline: str
) -> None:
    table = [("time_s", "position_m", "force_N"), *((k, v, -v) for k, v in enumerate(values))]
    text = newline.join(delimiter.join(map(str, row)) for row in table)
    for more in ("", f"{newline}End of test"):  # in bulk, and cell by cell
        recording = load(tmp_path, text + more)
        assert recording.position_m.tolist() == values
        assert recording.force_n.tolist() == [-v for v in values]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(st.binary(max_size=200))
def test_any_bytes_give_one_line(tmp_path: Path, noise: bytes) -> None:
    refusal(tmp_path, GOOD.encode() + b"0.1,x,\n" + noise)


def test_the_last_printed_digit_is_that_of_the_longest_stamp(tmp_path: Path) -> None:
    written = load(tmp_path, "time_s,position_m,force_N\n0.2,0,0\n0.25,1,1\n0.3,2,2\n")
    assert written.details["sampling"]["stamp_digit_s"] == 0.01


def test_stamps_that_lost_a_digit_need_a_stated_rate(shared_data: Path) -> None:
    """After 40.9 s these files count on with 40.10, 40.11: printed stamps that go back."""
    strain = "position=Engineering Strain:33mm,force=Engineering Stress (MPa):18N"
    files = sorted((shared_data / "elastomer_tension").glob("*.csv"))
    assert len(files) == 5
    for file in files:
        recording, _ = import_file(file, parse_map(f"time=10Hz,{strain}"))
        assert recording.rate_hz == pytest.approx(10.0)
    recording, guess = import_file(files[3], parse_map(f"time=10Hz,{strain}"))
    assert len(recording.position_m) == 705
    assert "differs in 298 rows from row 426 on: there it says 39.8 s" in guess
    with pytest.raises(DataError, match=r"row 426: time goes back .*--map time=RATEHz"):
        import_file(files[3], parse_map(strain))


POSITION_M = press(1.0)
FORCE_N = soft_force(POSITION_M)


def table(header: str, scales: tuple[float, ...], order: str = "txf", end: str = "") -> str:
    """A header, and rows of time, position and force, each divided by the scale of its unit."""
    time_s = np.arange(len(FORCE_N)) / 1000.0
    of = dict(zip("txf", (time_s, POSITION_M, FORCE_N), strict=True))
    columns = [of[name] / scale for name, scale in zip(order, scales, strict=True)]
    rows = [",".join(f"{value:.9g}" for value in row) + end for row in zip(*columns, strict=True)]
    return "\n".join([header, *rows]) + "\n"


GERMAN = str.maketrans(",.", ";,")
EXPORTS = {
    "a logger": table("Zeit (s),Weg (mm),Kraft (mN)", (1.0, 1e-3, 1e-3)).translate(GERMAN),
    "a comma at the header's end": table("time_s,position_mm,force_N,", (1.0, 1e-3, 1.0)),
    "a comma at every line's end": table("time_s,position_mm,force_N,", (1.0, 1e-3, 1.0), end=","),
    "JSON above the table": '{"rig": "4"}\n' + table("time_s,position_mm,force_N", (1, 1e-3, 1)),
    "a sentence above": "time against position and force\nrun 3 of 5, 0.1 mm a s\n"
    + table("time_s,position_mm,force_N", (1.0, 1e-3, 1.0)),
}


@pytest.mark.parametrize("machine", EXPORTS)
def test_exports_come_in_without_a_map(tmp_path: Path, machine: str) -> None:
    """Layouts of public recordings: tests/host/commands/test_mistakes.py."""
    (tmp_path / "press.csv").write_text(EXPORTS[machine], encoding="utf-8")
    found, _ = import_file(tmp_path / "press.csv")
    np.testing.assert_allclose(found.position_m, POSITION_M, atol=1e-9)
    np.testing.assert_allclose(found.force_n, FORCE_N, rtol=1e-6, atol=1e-6)


def rows_of(*columns: list[str], delimiter: str = ",") -> str:
    return "".join(delimiter.join(row) + "\n" for row in zip(*columns, strict=True))


NUMBERS = [[f"{each:.6f}" for each in values] for values in (1e3 * POSITION_M, FORCE_N)]
TIMES_S = DT_S * np.arange(len(POSITION_M))
TA_HEAD = "CLOSED\nSig1\tTime (min)\nSig2\tDisplacement (mm)\nSig3\tForce (N)\nStartOfData\n"
LVM_HEAD = "LabVIEW Measurement\nY_Unit_Label\tmm\tN\nDelta_X\t{0}\t{0}\n***End_of_Header***\n"
WRITTEN = {
    "thousands from 1000 s on": "Time (s),Extension (mm),Load (N)\n"
    + rows_of([f'"{999.5 + t:,.6f}"' for t in TIMES_S], *NUMBERS),
    "whole thousands": "Time (s),Extension (nm),Load (N)\n"
    + rows_of(
        [f"{t:.6f}" for t in TIMES_S], [f'"{1e9 * x:,.0f}"' for x in POSITION_M], NUMBERS[1]
    ),
    "stamps with a date": "stamp,position_mm,force_N\n"
    + rows_of([f"2026-03-14 20:07:{10.0 + t:09.6f}" for t in TIMES_S], *NUMBERS),
    "a clock with a comma past midnight": "Zeit;Weg (mm);Kraft (N)\n"
    + rows_of(
        [f"23:59:{59.5 + t:06.3f}".replace(".", ",") if t < 0.5
         else f"0:00:{t - 0.5:06.3f}".replace(".", ",") for t in TIMES_S],
        *([each.replace(".", ",") for each in column] for column in NUMBERS), delimiter=";",
    ),
    "TA Instruments": TA_HEAD
    + rows_of([f"{t / 60.0:.9f}" for t in TIMES_S], *NUMBERS, delimiter="\t"),
    "LabVIEW without X columns": LVM_HEAD.format(DT_S) + "X_Value\tDisplacement\tForce\tComment\n"
    + rows_of([""] * len(TIMES_S), *NUMBERS, delimiter="\t"),
    "LabVIEW with them": LVM_HEAD.format(DT_S) + "X_Value\tDisplacement\tForce\tComment\n"
    + rows_of([f"{t:.6f}" for t in TIMES_S], *NUMBERS, delimiter="\t"),
}  # fmt: skip


@pytest.mark.parametrize("machine", WRITTEN)
def test_what_a_machine_writes_by_itself(tmp_path: Path, machine: str) -> None:
    (tmp_path / "press.csv").write_text(WRITTEN[machine], encoding="utf-8")
    found, _ = import_file(tmp_path / "press.csv")
    np.testing.assert_allclose(found.position_m, POSITION_M, atol=1e-9)
    np.testing.assert_allclose(found.force_n, FORCE_N, atol=1e-6)
    assert found.dt_s == pytest.approx(DT_S, rel=1e-4)


@pytest.mark.parametrize("delimiter", [",", ";", "\t", " "])
@pytest.mark.parametrize("names", ["x_mm,y_mm", "Stage X (mm),Stage Y (mm)", "across,y_mm"])
def test_columns_of_other_names_are_a_place_if_they_are_named(
    tmp_path: Path, names: str, delimiter: str
) -> None:
    """x and y, in mm, beside z: without them, which column is the position is not known."""
    rows = [[f"{k / 100}", "5", "-10", f"{k % 5}", f"{k % 7}"] for k in range(50)]
    header = ["t_s", *names.split(","), "z_mm", "fz_N"]
    if delimiter == " " and "(" in names:
        header = [f'"{name}"' for name in header]
    (tmp_path / "a.csv").write_text("\n".join(map(delimiter.join, [header, *rows])) + "\n")
    options = ImportOptions(place_m=parse_place_option(names))
    if "across" in names:
        with pytest.raises(DataError, match="no unit of position"):
            import_file(tmp_path / "a.csv", options=options)
        return
    read, _ = import_file(tmp_path / "a.csv", options=options)
    assert read.place_m == pytest.approx((0.005, -0.01))
    with pytest.raises(DataError, match="--place"):
        import_file(tmp_path / "a.csv", options=ImportOptions(place_m=("a", "b")))
