"""CSV files -> recordings: what is understood, and what is refused with file and row."""

import shlex
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from springpot import Recording
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import parse_map
from springpot.trainer.recordings.formats.importing import ImportOptions, import_file
from springpot.trainer.recordings.formats.uneven_tail import tail_note

GOOD = "time_s,position_m,force_N\n0.000,0,0\n0.001,0.1,1\n0.002,0.2,2\n0.003,0.3,3\n0.004,0.4,4\n"
COMMA, HEAD = GOOD.replace(",", ";").replace(".", ","), "time_s;position_m;force_N\n"
BESIDE = "\n".join(f"{line},{'stage_x_mm' if line[0] == 't' else 5}" for line in GOOD.split())


def load(
    path: Path, text: str | bytes, mapping: str = "", resample_hz: float | None = None
) -> Recording:
    file = path / "press 1.csv"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    result = import_file(file, parse_map(mapping) if mapping else None, "none", resample_hz)
    assert str(file) in result.guess
    assert ("'stage_x_mm'" in result.guess) == ("stage_x_mm" in str(text)), "columns not read"
    return result.recordings[0]


def refusal(path: Path, text: str | bytes, mapping: str = "", rate: float | None = None) -> str:
    with pytest.raises(DataError) as error:
        load(path, text, mapping, rate)
    message = str(error.value)
    assert "press 1.csv" in message
    assert "\n" not in message
    return message


def rows(time_s: list[float] | np.ndarray, form: str = "%.6f") -> str:
    lines = [f"{form % t},{k * 1e-4!r},{k * 0.1!r}" for k, t in enumerate(time_s)]
    return "\n".join(["time_s,position_m,force_N", *lines]) + "\n"


def test_columns_that_are_not_read_are_named(tmp_path: Path) -> None:
    assert np.array_equal(load(tmp_path, BESIDE).force_n, load(tmp_path, GOOD).force_n)


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
    """Layouts of public recordings: tests/host/commands/test_real_layouts.py."""
    body = [delimiter.join(map(str, row)) for row in [(0, 0, 0), (10, 1, 2), (20, 2, 4)]]
    found = load(tmp_path, "\n".join([header, *body] if header else body), mapping)
    np.testing.assert_allclose(found.position_m, [0.0, 0.001, 0.002])
    assert found.force_n.tolist() == [0.0, 2.0, 4.0]
    assert found.dt_s == pytest.approx(0.01)
    units = [found.details["units"][q]["unit"] for q in ("time", "position", "force")]
    assert units == ["ms", "mm", "N"] or "0.001" in mapping


@pytest.mark.parametrize("unit", ["N", "-1N", "2kN"])
def test_a_map_that_contradicts_the_header_is_refused(tmp_path: Path, unit: str) -> None:
    text = GOOD.replace("force_N", "Force [mN]")
    message = refusal(tmp_path, text, f"force=Force [mN]:{unit}")
    assert f"column 3 'Force [mN]': its header says mN, --map says {unit}: leave the" in message
    remedy = shlex.split(message.rpartition("--map ")[2])
    factor = {"N": 1.0, "-1N": -1.0, "2kN": 2000.0}[unit]
    assert load(tmp_path, text, *remedy).force_n.tolist() == [k * factor for k in range(5)]


def test_all_that_a_map_has_to_say_is_said_at_once(tmp_path: Path) -> None:
    text = GOOD.replace("time_s,position_m,force_N", "Time,Depth, mm,Load").replace(", mm", "")
    message = refusal(tmp_path, text, "position=Depth:mm")
    assert "column 1 'Time', column 3 'Load': no unit of time, of force: pass --map " in message
    option = message.partition("--map ")[2].partition(", with")[0]
    stated = option.replace("UNIT", "s", 1).replace("UNIT", "N", 1)
    assert load(tmp_path, text, *shlex.split(stated)).position_m[-1] == pytest.approx(0.4e-3)
    assert stated == "time=Time:s,position=Depth:mm,force=Load:N"
    counted = refusal(tmp_path, text, "time=10Hz")
    assert "--map time=10Hz,position=Depth:UNIT,force=Load:UNIT, with a unit such as" in counted


def test_a_map_that_contradicts_the_row_of_units_is_refused(tmp_path: Path) -> None:
    text = GOOD.replace("time_s,position_m,force_N", "time,position,force\ns,mm,kN")
    assert "its row of units says kN, --map says N" in refusal(tmp_path, text, "force=force:N")
    same = load(tmp_path, text, "force=force:-1000N,position=position:0.1cm")
    assert same.force_n.tolist() == [0.0, -1000.0, -2000.0, -3000.0, -4000.0]
    assert load(tmp_path, text).details["units"]["force"] == {
        "unit": "kN", "to_si": 1000.0, "from": "row of units", "column": "force"
    }  # fmt: skip


@pytest.mark.parametrize(
    ("encoding", "said"),
    [("cp1252", "not UTF-8, read as Windows-1252"), ("utf-16", "UTF-16"), ("utf-8-sig", "time")],
)
def test_text_of_windows_is_read(encoding: str, said: str, tmp_path: Path) -> None:
    text = "time (s);Prüfweg (µm);force (N)" + GOOD[GOOD.index("\n") :].replace(",", ";")
    for numbers in (text, text.replace(".", ","), text.replace("\n", "\r\n")):
        file = tmp_path / "press.csv"
        file.write_bytes(numbers.encode(encoding))
        result = import_file(file, parse_map("position=Prüfweg (µm)"), "none", None)
        assert result.recordings[0].position_m[-1] == pytest.approx(0.4e-6)
        assert said in result.guess
        assert ("decimal comma" in result.guess) == ("," in numbers)


@pytest.mark.parametrize("delimiter", [",", ";", "|", "\t", " "])
@pytest.mark.parametrize("names", ["time_s position_mm force_N", "t x f", "t[s] x[mm] F[N]"])
@pytest.mark.parametrize("mark", ["# ", "#", "## "])
@pytest.mark.parametrize("above", ["", "pressed by me, twice\n"])
def test_a_header_that_numpy_savetxt_writes(
    tmp_path: Path, delimiter: str, names: str, mark: str, above: str
) -> None:
    """A mark of comments is no part of a header, nor of what a map names."""
    header = above + names.replace(" ", delimiter).replace("[", " [")
    table = np.c_[np.arange(4.0), np.arange(4.0), np.arange(4.0)]
    np.savetxt(tmp_path / "a.csv", table, "%.18e", delimiter, header=header, comments=mark)
    text = (tmp_path / "a.csv").read_text()
    maps = ["time=t:s,position=x:mm,force=f:N", f"time={mark}t:s,position=x:mm,force=f:N"]
    for mapping in maps if names == "t x f" else [""]:
        found = load(tmp_path, text, mapping)
        np.testing.assert_array_equal(found.position_m, np.arange(4.0) * 1e-3)
        np.testing.assert_array_equal(found.force_n, np.arange(4.0))


def test_a_mark_above_numbers_of_its_own_is_a_header(tmp_path: Path) -> None:
    text = "# time_s position_m force_N\n" + "".join(f"{k} {k}.5 {k} {2 * k}\n" for k in range(4))
    assert load(tmp_path, text).position_m.tolist() == [0.0, 1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            GOOD.replace("0.1,1\n", "nan,1\n"),
            "row 3: position is empty or not a finite number (1 such row)",
        ),
        (
            GOOD.replace("0.001", "\n\n0.001").replace("0.003,", "0.002,"),
            "row 7: time stands still",
        ),
        (
            GOOD.replace(",", ";").replace("0.2;2", "0,2;2"),
            "row 4, column 2: '0,2' is not a",
        ),
        (GOOD.replace("0.1,1\n", ",1\n"), "row 3: position is empty or not a finite"),
        (GOOD.replace("0.1,1\n", "0.1,1_0\n"), "row 3, column 3: '1_0' is not a number"),
        (GOOD.replace("0.003,", "0.0015,"), "row 5: time goes back from 0.002 s to 0.0015 s"),
        (GOOD.replace("0.002,0.2,2\n", ""), "row 4: gap of 0.002 s"),
        (GOOD.replace("0.1,1\n", "0.1,1,7\n"), "row 3: 4 cells, the rows above have 3"),
        (GOOD[: GOOD.index("0.002")], "2 rows of numbers: a recording needs 3"),
        ("time_s,position_m,force_N\n", "0 rows of numbers"),
        ("", "the file is empty"),
        (GOOD.replace("force_N", "force"), "column 3 'force': no unit of force"),
        (GOOD.replace("force_N", "stress_Pa"), "found no column of force in row 1"),
        (GOOD.split("\n", 1)[1], "found no column of time or of position or of force"),
        (GOOD.replace("time_s", "load_N"), "found no column of time"),
        (GOOD.encode().replace(b"0.2", b"0\0002"), "row 4: a NUL byte"),
        (GOOD.encode().replace(b"0.2", b"0\xb52"), "row 4, column 2: '0\u00b52' is not a number"),
        (GOOD.encode().replace(b"0.2", b"0\x812"), "row 4: byte 0x81 is not UTF-8"),
        (("mü," + GOOD.replace("\n", "\n0,")).encode() + b"\xb5", "row 7: byte 0xb5 is not UTF-8"),
        (GOOD.replace("force_N", "force_mn"), "--map force=force_mn:UNIT, with"),
        (COMMA.replace("0,002;0,2", "0,002;1.0,2"), "'1.0,2' is not a number with a decimal comma"),
        (HEAD + "0;1;1,000\n1;2;2,000\n2;3;3,000\n", "row 2: '1,000' may be a decimal comma or"),
    ],
)
def test_refused(tmp_path: Path, text: str | bytes, message: str) -> None:
    assert message in refusal(tmp_path, text)


def test_two_columns_that_could_be_the_force_are_refused(tmp_path: Path) -> None:
    text = "time_s,position_m,load_N,force_N\n0,0,9,0\n1,1,9,1\n2,2,9,2\n"
    assert "force may be column 3 'load_N', 4 'force_N'" in refusal(tmp_path, text)
    assert load(tmp_path, text, "force=4").force_n.tolist() == [0.0, 1.0, 2.0]
    assert "force ('Last')" in refusal(tmp_path, text, "force=Last:N")


@pytest.mark.parametrize("rate_hz", [3.0, 7.0, 30.0, 60.0, 70.0])
@pytest.mark.parametrize("form", ["%.2f", "%.6f", "%.12g", "%.9e"])
def test_rounded_stamps_pass(tmp_path: Path, rate_hz: float, form: str) -> None:
    recording = load(tmp_path, rows((1 + np.arange(300)) / rate_hz, form))
    assert recording.rate_hz == pytest.approx(rate_hz, rel=5e-3)


def test_jitter_needs_resampling(tmp_path: Path) -> None:
    time_s = np.arange(100) * 0.01
    time_s[42] += 0.001
    message = refusal(tmp_path, rows(time_s))
    assert "row 44: the time step is 0.011 s" in message
    assert "--resample-hz 100" in message
    found = load(tmp_path, rows(time_s), resample_hz=100.0)
    assert (found.dt_s, found.details["resampled_hz"], found.details["source_rows"]) == (
        0.01, 100.0, 100
    )  # fmt: skip
    np.testing.assert_allclose(found.position_m[42], np.interp(0.42, time_s, np.arange(100) * 1e-4))
    assert "more than 20 times" in refusal(tmp_path, GOOD, rate=1e6)


def test_a_rate_that_changes_within_rounding_is_refused(tmp_path: Path) -> None:
    steps_s = np.where(np.arange(1000) < 500, 0.010, 0.011)
    message = refusal(tmp_path, rows(np.cumsum(steps_s), "%.3f"))
    assert "the mean of the last 100 time steps" in message


@pytest.mark.parametrize("seed", range(10))
def test_a_gap_is_found_at_any_row_and_a_logger_that_slows_down_has_none(
    tmp_path: Path, seed: int
) -> None:
    """A relaxation has fewer rows later: the rate that is named is that of the first ones."""
    draw = np.random.default_rng(seed)
    slows = np.cumsum(0.01 * draw.uniform(1.01, 1.08) ** np.arange(draw.integers(60, 160)))
    message = refusal(tmp_path, rows(slows))
    assert "--resample-hz" in message and "gap of" not in message
    rate_hz = float(message.rpartition(" ")[2])
    assert 25.0 < rate_hz <= 100.0
    resampled = load(tmp_path, rows(slows), resample_hz=rate_hz)
    assert resampled.duration_s == pytest.approx(slows[-1] - slows[0], abs=0.05)
    row = int(draw.integers(10, 90))
    even = np.arange(100) * 0.01
    even[row:] += draw.uniform(0.01, 5.0)
    assert f"row {row + 2}: gap of" in refusal(tmp_path, rows(even), rate=100.0)


@pytest.mark.parametrize("seed", range(6))
def test_what_is_missing_can_be_mended_as_the_message_says(tmp_path: Path, seed: int) -> None:
    """Rows at an end are cut, few between others are filled, many make two recordings."""
    draw = np.random.default_rng(seed)
    begin, many = int(draw.integers(20, 60)), int(draw.integers(1, 20))
    lines = rows(np.arange(100) * 0.01).splitlines()
    for first in (0, begin, 100 - many):
        bad = range(first + 1, first + many + 1)
        cell = "nan" if seed % 2 else ""
        text = [
            f"{line.rpartition(',')[0]},{cell}" if k in bad else line
            for k, line in enumerate(lines)
        ]
        message = refusal(tmp_path, "\n".join(text))
        assert f"row {first + 2}: force is empty or not a finite number ({many} such row" in message
        whole = [line for k, line in enumerate(lines) if k not in bad]
        if first != begin:
            assert message.endswith("cut those rows in the source")
            assert len(load(tmp_path, "\n".join(whole)).force_n) == 100 - many
            continue
        assert ("fill what is missing" in message) == (many < 5)
        assert message.endswith("cut the recording there and import the parts")
        assert message.endswith(refusal(tmp_path, "\n".join(whole)).rpartition("): ")[2])
        for part in (whole[: begin + 1], [whole[0], *whole[begin + 1 :]]):
            load(tmp_path, "\n".join(part))


@pytest.mark.parametrize("cell", ["", " ", "nan"])
@pytest.mark.parametrize("every", [2, 3, 5])
def test_a_slower_channel_is_imported_without_its_blank_rows(
    tmp_path: Path, cell: str, every: int
) -> None:
    lines = rows(np.arange(100) * 0.01).splitlines()
    blank = [
        f"{line.rpartition(',')[0]},{cell}" if k % every else line
        for k, line in enumerate(lines[1:])
    ]
    message = refusal(tmp_path, "\n".join([lines[0], *blank]))
    many = sum(k % every > 0 for k in range(100))
    assert f"row 3: force is empty or not a finite number ({many} such rows): cut" in message
    found = load(tmp_path, "\n".join([lines[0], *lines[1::every]]))
    assert found.dt_s == pytest.approx(every * 0.01)


@pytest.mark.parametrize("many", [1, 2, 3])
def test_rows_at_an_end_out_of_step_are_counted_in_words(tmp_path: Path, many: int) -> None:
    time_s = np.arange(400) * 0.01
    time_s[-many:] += 0.004 * np.arange(1, many + 1)
    found = load(tmp_path, rows(time_s))
    counted = f"{many} row{'s' * (many > 1)} from row {402 - many} on"
    assert counted in tail_note(found)


@pytest.mark.parametrize("seed", range(6))
def test_late_stamps_and_a_second_rate_are_resampled_and_are_no_gaps(
    tmp_path: Path, seed: int
) -> None:
    """A logger in a loop stamps late, one of a machine holds at a lower rate."""
    draw = np.random.default_rng(seed)
    late = np.sort(np.arange(300) * 0.01 + draw.normal(0.0, draw.uniform(0.001, 0.002), 300))
    hold = np.cumsum(np.repeat([0.01, 0.01 * draw.uniform(2.0, 25.0)], [200, 30]))
    for time_s in (late, hold):
        message = refusal(tmp_path, rows(time_s))
        rate_hz = float(message.rpartition("pass --resample-hz ")[2])
        assert 60.0 < rate_hz < 110.0  # at most that of the finest steps, at least the mean
        found = load(tmp_path, rows(time_s), resample_hz=rate_hz)
        expected = np.interp(np.arange(len(found.force_n)) / rate_hz, time_s - time_s[0],
                             0.1 * np.arange(len(time_s)))  # fmt: skip
        np.testing.assert_allclose(found.force_n, expected, atol=1e-3)


@pytest.mark.parametrize(("zero", "position"), [("first", [0.0, -1.0, 1.0]), ("min", [1, 0, 2])])
def test_zero(tmp_path: Path, zero: str, position: list[float]) -> None:
    file = tmp_path / "a.csv"
    file.write_text("time_s,position_m,force_N\n0,5,1\n1,4,2\n2,6,3\n")
    recording = import_file(file, None, zero, None).recordings[0]  # type: ignore[arg-type]
    assert recording.zero == zero
    assert recording.position_m.tolist() == position
    assert recording.force_n.tolist() == [0.0, 1.0, 2.0]
    assert recording.details["zero_position_m"] == (5.0 if zero == "first" else 4.0)


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
    recording = load(tmp_path, text)
    assert recording.position_m.tolist() == values
    assert recording.force_n.tolist() == [-v for v in values]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(st.binary(max_size=200))
def test_any_bytes_give_one_line(tmp_path: Path, noise: bytes) -> None:
    refusal(tmp_path, GOOD.encode() + b"0.1,x,\n" + noise)


@pytest.mark.parametrize(("delimiter", "quote"), [(";", ""), (",", '"')])
def test_a_decimal_mark_can_be_stated(delimiter: str, quote: str, tmp_path: Path) -> None:
    file = tmp_path / "rig.csv"
    rows = "".join(f"{k};{k};{quote}{k + 1},500{quote}\n" for k in range(3))
    file.write_text(f"time_s;position_m;force_N\n{rows}".replace(";", delimiter))
    with pytest.raises(DataError, match="--decimal comma, or --decimal point if"):
        import_file(file, None, "none", None)
    for mark, scale in (("comma", 1.0), ("point", 1000.0)):
        stated = import_file(file, None, "none", None, ImportOptions(decimal=mark))  # type: ignore[arg-type]
        assert stated.recordings[0].force_n.tolist() == [1.5 * scale, 2.5 * scale, 3.5 * scale]


@pytest.mark.parametrize(
    ("text", "rate_hz"), [("10Hz", 10.0), ("1 kHz", 1000.0), ("2.5e3Hz", 2500)]
)
def test_a_stated_rate_takes_the_place_of_time(tmp_path: Path, text: str, rate_hz: float) -> None:
    recording = load(tmp_path, GOOD.replace("time_s", "row_"), f"time={text}")
    assert recording.rate_hz == pytest.approx(rate_hz)
    assert recording.details["units"]["time"]["from"] == "map"


def test_stamps_that_lost_a_digit_need_a_stated_rate(shared_data: Path) -> None:
    """After 40.9 s these files count on with 40.10, 40.11: printed stamps that go back."""
    strain = "position=Engineering Strain:33mm,force=Engineering Stress (MPa):18N"
    files = sorted((shared_data / "elastomer_tension").glob("*.csv"))
    assert len(files) == 5
    for file in files:
        result = import_file(file, parse_map(f"time=10Hz,{strain}"), "none", None)
        (recording,) = result.recordings
        assert recording.rate_hz == pytest.approx(10.0)
        assert recording.details["units"]["time"] == {"unit": "10 Hz", "from": "map"}
        assert "rows counted at the stated 10 Hz, not read from column 1 'Time (s)'" in result.guess
    file = files[3]
    assert file.name == "Ecoflex 00-30.csv"
    result = import_file(file, parse_map(f"time=10Hz,{strain}"), "none", None)
    assert len(result.recordings[0].position_m) == 705
    assert "differs in 298 rows from row 426 on: there it says 39.8 s" in result.guess
    with pytest.raises(DataError, match=r"row 426: time goes back .*--map time=10Hz"):
        import_file(file, parse_map(strain), "none", None)


def test_compression_files_of_another_laboratory(shared_data: Path) -> None:
    """The machine ends its tests between two samples, and one series on another rule."""
    files = sorted((shared_data / "ecoflex_compression").glob("*/*.csv"))
    assert len(files) == 30
    for file in files:
        result = import_file(file, None, "none", None)
        (recording,) = result.recordings
        assert recording.rate_hz == pytest.approx(10.0)
        assert len(recording.position_m) == 1201
        assert recording.position_m[-1] == pytest.approx(20e-3, rel=1e-3)
        assert recording.force_n[-1] > 400.0
        tail = recording.details["sampling"]["tail"]
        assert tail["rows"] == (1 if "EF10_0T_B" not in file.name else pytest.approx(25, abs=4))
        assert "not in step with the rows before: interpolated onto their 10 Hz" in result.guess
    first = import_file(files[0], None, "none", None).recordings[0]
    resampled = import_file(files[0], None, "none", 10.0).recordings[0]
    np.testing.assert_allclose(first.force_n, resampled.force_n, rtol=0, atol=1e-9)
