"""Blocks, text behind numbers, stamps of a clock, thousands and tests side by side in one file."""

import re
import shlex
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import parse_map
from springpot.trainer.recordings.formats.importing import ImportOptions, ImportResult, import_file

HEADER = "Time (s),Position (mm),Force (N)"


def rows(first: int, count: int, mark: str = ",") -> list[str]:
    """Rows at 50 Hz from a sample on: position is its number in mm, force twice that in N."""
    return [f"{k / 50:.2f}{mark}{k}.5{mark}{2 * k}.25" for k in range(first, first + count)]


def load(folder: Path, lines: list[str], options: str = "", end: str = "\n") -> ImportResult:
    file = folder / "press.csv"
    file.write_bytes(end.join([*lines, ""]).encode())
    given = shlex.split(options)
    mapping = parse_map(given[1]) if given[:1] == ["--map"] else None
    decimal = given[1] if given[:1] == ["--decimal"] else None
    return import_file(file, mapping, "none", None, ImportOptions(decimal=decimal))  # type: ignore[arg-type]


def refusal(folder: Path, lines: list[str], options: str = "") -> str:
    with pytest.raises(DataError) as refused:
        load(folder, lines, options)
    message = str(refused.value)
    assert "press.csv" in message
    assert "\n" not in message
    return message


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


@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize("name", ENDS)
def test_text_behind_the_numbers_is_left_out(name: str, end: str, tmp_path: Path) -> None:
    found = load(tmp_path, [HEADER, *rows(0, 30), *ENDS[name]], end=end)
    (recording,) = found.recordings
    assert recording.force_n[[0, -1]].tolist() == [0.25, 58.25]
    first = re.escape(next(line for line in ENDS[name] if line).replace('"', ""))
    row = 32 + (not ENDS[name][0])
    assert re.search(f"left out: (text|other columns) from row {row} on, '{first}", found.guess)


DAMAGED = ["0.2,OVERLOAD,4", "0.2,3.5", "0.2,,4.25", "0.2x,3.5,4.25", "paused", "paused,,",
           "x,3.5,4.25", "operator,pressed,pause", ",3.5,4.25"]  # fmt: skip


@pytest.mark.parametrize("damaged", DAMAGED)
def test_a_damaged_row_is_refused(damaged: str, tmp_path: Path) -> None:
    for behind in (30, 2, 1, 0) if damaged in DAMAGED[:4] else (30, 2, 1):
        text = [HEADER, *rows(0, 10), damaged, *rows(11, behind)]
        assert "row 12" in refusal(tmp_path, text), behind


def test_an_event_between_empty_lines_heads_no_table(tmp_path: Path) -> None:
    text = [HEADER, *rows(0, 10), "", "Event,pause,", "", *rows(11, 30)]
    assert "row 13: 'Event,pause,' stands in the middle of numbers" in refusal(tmp_path, text)


def blocks(second: int, count: int = 30) -> list[str]:
    """Two blocks, each below its title, as testing machines write them."""
    return [
        "[step]", "Ramp", "Time,Position,Force", "s,mm,N", *rows(0, 30),
        "", "[step]", "Hold", "Time,Position,Force", "s,mm,N", *rows(second, count),
    ]  # fmt: skip


def test_blocks_that_count_on_in_time_are_one_test(tmp_path: Path) -> None:
    found = load(tmp_path, blocks(30))
    (recording,) = found.recordings
    np.testing.assert_allclose(recording.position_m, (np.arange(60) + 0.5) * 1e-3)
    assert "2 blocks of numbers, from rows 5, 40 on, which count on in time" in found.guess


@pytest.mark.parametrize("second", [0, 29, 32, 300])
def test_blocks_apart_in_time_are_recordings(second: int, tmp_path: Path) -> None:
    found = load(tmp_path, blocks(second))
    assert [recording.name for recording in found.recordings] == ["press-1", "press-2"]
    assert [each.position_m[0] for each in found.recordings] == pytest.approx(
        [0.5e-3, (second + 0.5) * 1e-3]
    )
    assert [each.details["begins_s"] for each in found.recordings] == [0.0, second / 50]
    assert "from rows 5, 40 on: recordings press-1 to press-2" in found.guess


def test_blocks_of_another_rate_are_not_joined(tmp_path: Path) -> None:
    slow = [f"{0.6 + k / 10:.2f},1,{k}" for k in range(30)]
    found = load(tmp_path, [*blocks(30, 0), *slow])
    assert [recording.rate_hz for recording in found.recordings] == pytest.approx([50.0, 10.0])


def test_blocks_without_a_recording_are_left_out(tmp_path: Path) -> None:
    sweep = ["", "Sweep", "Frequency (Hz),Modulus (MPa),Angle", *rows(0, 5)]
    found = load(tmp_path, [*blocks(0, 2), *sweep])
    (recording,) = found.recordings
    assert recording.name == "press"
    assert "left out: other columns from row 43 on, 'Sweep'" in found.guess
    assert "fewer than 3 rows from row 40 on" in found.guess


def test_a_map_of_numbers_holds_for_all_blocks(tmp_path: Path) -> None:
    text = [line.replace("Time,Position,Force", "a,b,c") for line in blocks(300)]
    text = [line for line in text if line != "s,mm,N"]
    found = load(tmp_path, text, "--map time=1:s,position=2:mm,force=3:N")
    assert [len(recording.force_n) for recording in found.recordings] == [30, 30]


def test_a_long_block_of_other_columns_may_stand_first(tmp_path: Path) -> None:
    sweep = ["[step]", "Frequency (Hz),Modulus (MPa),Angle", *rows(0, 600), ""]
    (recording,) = load(tmp_path, [*sweep, *blocks(30)]).recordings
    assert len(recording.force_n) == 60
    assert "in row 2, which has 'Frequency" in refusal(tmp_path, sweep)


def test_an_unknown_unit_of_a_block_is_said(tmp_path: Path) -> None:
    text = blocks(30)
    text[-31] = "s,mm,furlongs"
    assert "no unit of force" in refusal(tmp_path, text) or "furlongs" in refusal(tmp_path, text)


STAMPS = {
    "clock": "{h:02d}:{m:02d}:{s:06.3f}",
    "a comma before milliseconds": "{h:02d}:{m:02d}:{i:02d}:{ms:03d}",
    "ISO": "2026-11-{day:02d}T{h:02d}:{m:02d}:{s:06.3f}Z",
    "ISO with a space and a zone": "2026-11-{day:02d} {h:02d}:{m:02d}:{s:06.3f}+01:00",
    "month first": "11/{day}/2026 {h:02d}:{m:02d}:{s:06.3f}",
    "day first": "{day}.11.2026 {h:02d}:{m:02d}:{s:06.3f}",
    "half days": "{half}:{m:02d}:{s:06.3f} {am}",
}


@pytest.mark.parametrize("header", ["Time", "Time (hh:mm:ss)", "Date/Time", "Timestamp"])
@pytest.mark.parametrize("form", STAMPS)
def test_stamps_of_a_clock_pass_midnight(form: str, header: str, tmp_path: Path) -> None:
    lines = [f"{header},Position (mm),Force (N)"]
    for k in range(100):
        ms = (24 * 3600 * 1000 - 990 + 20 * k) % 86400000
        h, m = ms // 3600000, ms // 60000 % 60
        s = ms % 60000 / 1000
        stamp = STAMPS[form].format(
            h=h, m=m, s=s, i=int(s), ms=ms % 1000, day=24 + (h == 0),
            half=(h - 1) % 12 + 1, am="AM" if h < 12 else "PM",
        )  # fmt: skip
        lines.append(f"{stamp},{k},{2 * k}")
    found = load(tmp_path, lines)
    assert found.recordings[0].dt_s == pytest.approx(0.02)
    assert "s after its first clock stamp" in found.guess


def test_a_stamp_that_is_none_is_named(tmp_path: Path) -> None:
    lines = [HEADER, *[f"10:12:{k:02d},{k},{k}" for k in range(30)]]
    lines[5] = "10:12,3,3"
    assert "row 6, column 1: '10:12' is no stamp of a clock" in refusal(tmp_path, lines)


LVM = [
    "LabVIEW Measurement\t", "Decimal_Separator\t.", "***End_of_Header***\t", "",
    "Channels\t2\t\t", "Samples\t30\t30\t", "Y_Unit_Label\tmm\tmN\t", "X_Dimension\tTime\tTime\t",
    "X0\t0.0\t0.0\t", "Delta_X\t0.02\t0.02\t", "***End_of_Header***\t\t\t",
    "X_Value\tPosition\tForce\tComment",
]  # fmt: skip


def test_labview_segments_have_the_units_of_their_own_lines(tmp_path: Path) -> None:
    segment = [f"{row}\t" for row in rows(0, 30, "\t")]
    newton = [line.replace("mN", "N") for line in LVM[4:]]
    found = load(tmp_path, [*LVM, *segment, "", *newton, *segment])
    peaks_n = [recording.force_n.max() for recording in found.recordings]
    assert peaks_n == pytest.approx([58.25e-3, 58.25])
    volts = [line.replace("Position\tForce", "Voltage_0\tVoltage_1") for line in LVM]
    message = refusal(tmp_path, [*volts, *segment])
    assert "row 12, which has 'X_Value', 'Voltage_0', 'Voltage_1'" in message


READABLE = [
    (delimiter, decimal, group, quote)
    for delimiter, decimal, group, quote in product(
        ";\t,", ".,", ".,'\u2019 \u00a0\u202f", ["", '"']
    )
    if group != decimal and (quote or delimiter not in (group, decimal))
]


@pytest.mark.parametrize(("delimiter", "decimal", "group", "quote"), READABLE)
def test_certain_separators_of_thousands_are_taken_out(
    delimiter: str, decimal: str, group: str, quote: str, tmp_path: Path
) -> None:
    swap = str.maketrans({",": group, ".": decimal})
    lines = [HEADER.replace(",", delimiter)]
    for k in range(30):
        numbers = (f"{number:,.1f}" for number in (k / 10, k, 1e5 * k + 0.5))
        cells = [f"{quote}{number.translate(swap)}{quote}" for number in numbers]
        lines.append(delimiter.join(cells))
    (recording,) = load(tmp_path, lines).recordings
    np.testing.assert_allclose(recording.force_n, 1e5 * np.arange(30) + 0.5)


@pytest.mark.parametrize(
    ("cells", "decimal"),
    [(["998", "999", "1.000", "1.001"], "comma"), (["998.5", "999.5", "1,000", "1001.5"], "point")],
)
def test_an_uncertain_separator_names_the_option_that_settles_it(
    cells: list[str], decimal: str, tmp_path: Path
) -> None:
    times = ["0,1", "0,2", "0,3", "0,4"] if decimal == "comma" else ["0.1", "0.2", "0.3", "0.4"]
    lines = [HEADER.replace(",", ";"), *map(";".join, zip(times, "1234", cells, strict=True))]
    message = refusal(tmp_path, lines)
    assert f"row 4, column 3: {cells[2]!r} may have a separator of thousands" in message
    option = re.search(r"--decimal \w+", message)
    (recording,) = load(tmp_path, lines, option[0]).recordings
    assert recording.force_n[2] == 1000.0


@pytest.mark.parametrize("end", [",,,", ""])  # spreadsheets leave out delimiters at a row's end
def test_tests_side_by_side_come_in_by_the_maps_that_are_named(end: str, tmp_path: Path) -> None:
    side = [f"{row},{row}" for row in rows(0, 20)] + [row + end for row in rows(20, 10)]
    lines = ["gel 1,,,gel 2,,", f"{HEADER},{HEADER}", *side]
    message = refusal(tmp_path, lines)
    maps = re.findall(r"--map [^ ,]+(?:,[^ ,]+)*", message)
    assert "2 tests side by side" in message
    found = [load(tmp_path, lines, option).recordings[0] for option in maps]
    assert [len(recording.force_n) for recording in found] == [30, 20]
    lines[5] = side[3].removesuffix(rows(3, 1)[0]).rstrip(",") + end
    assert "row 6" in refusal(tmp_path, lines, maps[1])
