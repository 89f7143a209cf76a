"""Time stamps: what passes as evenly sampled, what is refused, and what resampling gives."""

from pathlib import Path

import numpy as np
import pytest
from support.files.imported import GOOD, load, refusal, rows

from springpot.trainer.recordings.formats.importing import import_file


@pytest.mark.parametrize("rate_hz", [3.0, 7.0, 30.0, 60.0, 70.0])
@pytest.mark.parametrize("form", ["%.2f", "%.6f", "%.12g", "%.9e"])
def test_rounded_stamps_pass(tmp_path: Path, rate_hz: float, form: str) -> None:
    recording = load(tmp_path, rows((1 + np.arange(300)) / rate_hz, form))
    assert recording.rate_hz == pytest.approx(rate_hz, rel=5e-3)


def test_jitter_needs_resampling(tmp_path: Path) -> None:
    time_s = np.arange(100) * 0.01
    time_s[42] += 0.001
    message = refusal(tmp_path, rows(time_s))
    assert "row 44: the time step is 0.011 s" in message and "--resample-hz 100" in message
    found = load(tmp_path, rows(time_s), resample_hz=100.0)
    assert (found.dt_s, found.details["resampled_hz"]) == (0.01, 100.0)
    np.testing.assert_allclose(found.position_m[42], np.interp(0.42, time_s, np.arange(100) * 1e-4))
    assert "give a lower rate, --resample-hz" in refusal(tmp_path, GOOD, rate=1e6)
    assert "give a higher rate, --resample-hz" in refusal(tmp_path, GOOD, rate=1.0)


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
    row, even = int(draw.integers(10, 90)), np.arange(100) * 0.01
    even[row:] += draw.uniform(0.01, 5.0)
    assert f"row {row + 2}: gap of" in refusal(tmp_path, rows(even), rate=100.0)


def test_rows_without_a_number_at_the_ends_are_left_out_with_a_line(tmp_path: Path) -> None:
    time_s = np.arange(100) * 0.01
    lines = rows(time_s, "%.2f").splitlines()
    for k in (1, 50, 99, 100):
        lines[k] = lines[k].rpartition(",")[0] + ","
    found = load(tmp_path, "\n".join(lines) + "\n", resample_hz=100.0)
    assert found.details["notes"][0] == "3 rows without a number at the ends: left out"
    assert len(found.force_n) == 97


@pytest.mark.parametrize("first_s", [2.08e-3, 0.5e-3, 0.3])
def test_a_first_row_that_is_out_of_step_is_cut(first_s: float, tmp_path: Path) -> None:
    """Interpolation onto it would blur every other sample, and lower the noise floor."""
    time_s = np.append(0.0, first_s + 4e-3 * np.arange(399))
    whole, found = (load(tmp_path, rows(its, "%.5f")) for its in (4e-3 * np.arange(400), time_s))
    assert whole.details["notes"] == [] and "row 2 comes" in found.details["notes"][0]
    np.testing.assert_array_equal(found.force_n, whole.force_n[1:])
    assert found.dt_s == pytest.approx(4e-3)


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
    recording = import_file(file, zero=zero)[0]  # type: ignore[arg-type]
    assert recording.zero == zero and recording.position_m.tolist() == position
    assert recording.force_n.tolist() == [0.0, 1.0, 2.0]
    assert recording.details["zero_position_m"] == (5.0 if zero == "first" else 4.0)


def test_compression_files_of_another_laboratory(shared_data: Path) -> None:
    """The machine ends its tests between two samples, and one series on another rule."""
    files = sorted((shared_data / "ecoflex_compression").glob("*/*.csv"))
    assert len(files) == 30
    for file in files:
        recording, _ = import_file(file)
        assert recording.rate_hz == pytest.approx(10.0) and len(recording.position_m) == 1201
        assert recording.position_m[-1] == pytest.approx(20e-3, rel=1e-3)
        assert recording.force_n[-1] > 400.0
        (note,) = recording.details["notes"]
        rows_off = int(note.partition("the end, ")[2].partition(" row")[0])
        assert rows_off == (1 if "EF10_0T_B" not in file.name else pytest.approx(25, abs=4))
    first = import_file(files[0])[0]
    resampled = import_file(files[0], resample_hz=10.0)[0]
    np.testing.assert_allclose(first.force_n, resampled.force_n, rtol=0, atol=1e-9)
