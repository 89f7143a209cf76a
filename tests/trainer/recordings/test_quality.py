"""The quality report: each fault is found, said in one line, and not found where it is not."""

import itertools
import json
import re
from dataclasses import replace
from math import gamma
from pathlib import Path
from subprocess import CompletedProcess

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.files.mach1 import mach1_recordings
from support.in_process import spring
from support.small import training

import springpot
from springpot import Recording, check_recordings
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.quality.cycles import find_cycles
from springpot.trainer.recordings.quality.finding import Finding, three_digits
from springpot.trainer.recordings.quality.motion import find_strokes
from springpot.trainer.recordings.quality.plausible import glance
from springpot.trainer.recordings.quality.sensors.channels import channel_findings
from springpot.trainer.recordings.recording_file import write_recording

TIME_S = np.arange(4000) * 1e-3


def noise(sd: float, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(0, sd, len(TIME_S))


def sine(
    name: str = "a", hz: float = 1.0, lead_rad: float = 0.1, noise_n: float = 0.01
) -> Recording:
    phase = 2 * np.pi * hz * TIME_S
    position_m = 5e-3 * (1 - np.cos(phase)) + noise(1e-7, 1)
    force_n = 5 * (1 - np.cos(phase + lead_rad)) + noise(noise_n, 2)
    return Recording(name, position_m, force_n, 1e-3, zero="first")


def findings(*recordings: Recording) -> dict[str, Finding]:
    found = {finding.kind: finding for finding in check_recordings(recordings).findings}
    for finding in found.values():
        assert "\n" not in finding.line
        assert finding.line.startswith(f"{finding.severity}: ")
    return found


def test_good_recordings_have_no_findings() -> None:
    assert findings(sine("a", 0.5), sine("b", 2.0), sine("c", 5.0)) == {}
    assert check_recordings(training()).findings == []


def test_a_simulated_object_has_no_findings(tmp_path: Path) -> None:
    protocol = tmp_path / "p.toml"
    press = "[[profile]]\namplitude_n = {}\nfrequency_hz = {}\n"
    protocol.write_text("".join(press.format(n, hz) for n in (4, 9) for hz in (1, 4)))
    recordings = springpot.record("sim://dragon-skin-10", str(protocol), tmp_path / "out")
    assert findings(*recordings) == {}


@pytest.mark.parametrize("channel", ["position_m", "force_n"])
def test_a_constant_channel_is_refused(channel: str) -> None:
    flat = replace(sine(), **{channel: np.full(len(TIME_S), 3.0)})
    assert findings(flat)["constant"].severity == "refusal"
    with pytest.raises(DataError, match="all along"):
        check_recordings([flat]).refuse()


def test_clipping() -> None:
    good = sine()
    clipped = replace(good, force_n=np.minimum(good.force_n, 8.0))
    assert "force stays at its maximum value, 8 N" in findings(clipped)["clipping"].what
    deep = replace(good, position_m=np.minimum(good.position_m, 8e-3))
    assert "position stays at its maximum value" in findings(deep)["clipping"].what
    position_m = 2.5e-3 * (1.0 - np.cos(2.0 * np.pi * TIME_S))  # one cause is one line
    force_n = 38.6 * (position_m / 5e-3) ** 1.6
    assert one_line_each(position_m, np.minimum(force_n, 12.0)) == ["clipping"]
    assert one_line_each(-position_m, -force_n) == ["sign"]
    assert one_line_each(position_m, force_n) == []


@pytest.mark.parametrize("noise_n", [0.01, 0.05, 0.2])
def test_a_hold_is_not_clipping(noise_n: float) -> None:
    """Nor is it if noise rises and falls meanwhile by a tenth of the force."""
    position_m = 5e-3 * np.clip(TIME_S, 0, 1) * np.clip(4.0 - TIME_S, 0, 1)
    relaxing = position_m * (800 + 200 * np.exp(-TIME_S)) + noise(noise_n)
    assert "clipping" not in findings(Recording("a", position_m, relaxing, 1e-3))


def test_lost_samples_that_were_filled_are_gaps() -> None:
    good = sine()
    position_m, force_n = good.position_m.copy(), good.force_n.copy()
    position_m[700:760], force_n[700:760] = position_m[700], force_n[700]
    found = findings(replace(good, position_m=position_m, force_n=force_n))["gap"]
    assert "longest 59 samples at 0.700 s" in found.what


def test_quantisation() -> None:
    good = sine()
    coarse = replace(good, force_n=np.round(good.force_n / 0.25) * 0.25)
    assert "force has steps of 0.25 N, 2.5 % of its range" in findings(coarse)["quantisation"].what
    fine = replace(good, force_n=np.round(good.force_n / 0.01) * 0.01)
    assert "quantisation" not in findings(fine)


def ramps(step_m: float, speeds: tuple[int, ...] = (1,), samples: int = 60) -> np.ndarray:
    """Rest, ramps in at speeds in steps a sample, a hold after each, and the way out."""
    steps = [np.zeros(50)]
    for speed in speeds:
        steps += [np.full(samples, speed), np.zeros(300)]
    steps += [np.full(samples * sum(speeds), -1)]
    return step_m * np.cumsum(np.concatenate(steps))


@pytest.mark.parametrize("samples", [4, 10, 60])
@pytest.mark.parametrize("speeds", [(1,), (1, 2), (2, 1, 4)])
def test_ramps_of_constant_speed_are_no_coarse_sensor(
    speeds: tuple[int, ...], samples: int
) -> None:
    """20 um a sample are 1 mm/s at 50 Hz, not a sensor's step."""
    position_m = np.round(ramps(20e-6, speeds, samples), 8)
    item = Recording("a", position_m, 3e3 * position_m + noise(0.01)[: len(position_m)], 0.02)
    assert "quantisation" not in findings(item)


def test_repeats_that_warm_up_drift() -> None:
    first = sine(noise_n=0.0)
    repeats = [
        replace(first, name=f"r{k}", force_n=first.force_n + noise(0.05, k)) for k in range(5)
    ]
    (group,) = check_recordings(repeats).figures["repeats"]
    assert group["noise_floor_n"] == pytest.approx(0.05, rel=0.05)
    assert "drift" not in findings(*repeats)
    warming = [replace(r, force_n=r.force_n + 0.1 * k) for k, r in enumerate(repeats)]
    assert "mean force changes by 0.4" in findings(*warming)["drift"].what


def test_cycles_give_the_noise_floor() -> None:
    cycles = find_cycles(sine(hz=2.0, noise_n=0.03))
    assert cycles.count == 8
    assert cycles.frequency_hz == pytest.approx(2.0, rel=1e-3)
    assert cycles.stiffness_npm == pytest.approx(1000.0, rel=1e-2)
    assert cycles.lead_rad == pytest.approx(0.1, abs=2e-3)
    assert cycles.energy_j == pytest.approx(np.pi * 5e-3 * 5 * np.sin(0.1), rel=0.02)
    assert cycles.skew_rad_per_s == pytest.approx(-2 * np.pi * 2.0, rel=0.02)
    assert cycles.noise_n == pytest.approx(0.03, rel=0.1)


def test_ramps_and_holds_are_no_cycles() -> None:
    ramp_m = np.linspace(0, 10e-3, 4000)
    assert find_cycles(Recording("a", ramp_m, 500 * ramp_m, 1e-3)) is None


def test_an_offset_of_the_cell_is_a_tare_and_no_surface() -> None:
    """Leave where force begins to quality/test_contact.py."""
    good = sine()
    in_air_n = 800 * np.maximum(good.position_m - 2e-3, 0.0) + noise(0.01)
    offset = replace(good, position_m=good.position_m - 2e-3, force_n=in_air_n + 1.0, zero="none")
    assert set(findings(offset)) == {"tare", "speeds"}


def run_import(tmp_path: Path, text: str, *arguments: str) -> CompletedProcess[str]:
    (tmp_path / "a.csv").write_text(text)
    return spring("import", tmp_path / "a.csv", "--out", tmp_path / "out", *arguments)


def rows(scale: float, force: float = 1.0) -> str:
    motion = 1 - np.cos(2 * np.pi * TIME_S)
    table = np.column_stack([TIME_S, scale * motion, force * motion])
    return "time_s,position_m,force_N\n" + "".join(
        "{:.3f},{:.9g},{:.9g}\n".format(*row) for row in table
    )


def test_a_guessed_unit_that_looks_wrong_is_refused_a_stated_one_warned_of(tmp_path: Path) -> None:
    result = run_import(tmp_path, rows(5.0))  # millimetres under a header that says metres
    assert result.returncode == 3
    assert "its unit looks wrong ('m' was read off the file)" in result.stderr
    assert "state it if it is right: --map position=COL:m" in result.stderr
    assert not (tmp_path / "out").exists()
    stated = run_import(tmp_path, rows(5.0), "--map", "position=position_m:m", "--json")
    assert "warning: a: 10 m of travel: its unit looks wrong" in stated.stderr
    assert "unit" in [finding["kind"] for finding in json.loads(stated.stdout)["findings"]]


@pytest.mark.parametrize(
    ("channel", "wrong", "count"),
    [("position", "m", 1e3), ("position", "m", 1e6), ("force", "kN", 1e3), ("force", "N", 1e6),
     ("time", "s", 1e6), ("time", "ms", 1e-6)],
)  # fmt: skip
def test_a_wrong_header_is_overridden_as_the_refusal_says(
    tmp_path: Path, channel: str, wrong: str, count: float
) -> None:
    """Numbers that count smaller or larger units than the header says."""
    column = {"time": 0, "position": 1, "force": 2}[channel]
    lines = [line.split(",") for line in rows(2e-3, 40.0).splitlines()]
    lines[0][column] = f"{channel}_{wrong}"
    for line in lines[1:]:
        line[column] = repr(float(line[column]) * count)
    result = run_import(tmp_path, "\n".join(",".join(line) for line in lines))
    assert result.returncode == 3
    told = re.findall(rf"--map ({channel}=COL:\S+?)(?:;|$)", result.stderr.strip())
    assert told[-1] == f"{channel}=COL:{wrong}"
    assert "if the header is wrong" in result.stderr
    again = run_import(tmp_path, "\n".join(",".join(line) for line in lines), "--map",
                       told[0].replace("COL", f"{column + 1}"))  # fmt: skip
    assert again.returncode == 0, again.stderr


def test_micrometres_and_millinewtons_are_real(tmp_path: Path) -> None:
    text = rows(20.0, 4.0).replace("position_m", "position_um").replace("force_N", "force_mN")
    result = run_import(tmp_path, text)
    assert (result.returncode, "unit" in result.stderr) == (0, False)


def test_check_refuses_with_status_3_after_its_report(tmp_path: Path) -> None:
    write_recording(tmp_path / "a.h5", replace(sine(), force_n=-sine().force_n))
    done = spring("check", tmp_path, "--json")
    assert done.returncode == 3
    answer = json.loads(done.stdout)
    assert answer["refused"] is True
    keys = {"kind", "severity", "where", "what", "so_what", "to_do", "line"}
    assert set(answer["findings"][0]) == keys


def test_stiffness_of_the_real_sinusoids(mach1_file: Path) -> None:
    """Published with the data: stiffness rises from about 912 to 1035 N/mm."""
    report = check_recordings(mach1_recordings(mach1_file, "first"))
    cycles = [metadata["cycles"] for metadata in report.recordings]
    assert [round(c["frequency_hz"], 1) for c in cycles] == [0.1, 0.2, 0.5, 1.0, 2.0]
    stiffness = [c["stiffness_npm"] * 1e-3 for c in cycles]
    assert stiffness == sorted(stiffness)
    assert stiffness[::4] == pytest.approx([912, 1035], abs=1)
    assert report.findings == []  # the data exclude the filter's delay: position has the same
    assert cycles[-1]["loss"]["angle_uncertainty_rad"] < 0.2


@pytest.mark.parametrize("frequency_hz", [0.1, 0.3, 1.0, 3.0])
def test_the_press_before_cycles_and_creep_under_them_are_no_loss(frequency_hz: float) -> None:
    """A fractional solid, pressed for two seconds, then cycled: the loss angle of its law."""
    dt_s, stiffness_npm, coefficient, order = 0.005, 2000.0, 800.0, 0.2
    time_s = np.arange(0.0, 50.0, dt_s)
    tone_m = 4e-4 * np.sin(2.0 * np.pi * frequency_hz * time_s)
    x = np.concatenate([np.zeros(200), np.linspace(0.0, 1e-3, 400), 1e-3 + tone_m])
    past = np.arange(len(x) + 1.0) ** (1.0 - order)  # exact for a path of straight pieces
    weights = dt_s**-order / gamma(2.0 - order) * np.concatenate([[1.0], np.diff(past, 2)])
    force_n = stiffness_npm * x + coefficient * np.convolve(weights, x)[: len(x)]
    found = find_cycles(Recording("cycles", x, force_n, dt_s, source="test"))
    assert found.frequency_hz == pytest.approx(frequency_hz, rel=2e-3)
    law = stiffness_npm + coefficient * (2j * np.pi * frequency_hz) ** order
    assert found.lead_rad == pytest.approx(np.angle(law), rel=0.02)
    assert found.stiffness_npm == pytest.approx(abs(law), rel=0.01)


def one_line_each(position_m: np.ndarray, force_n: np.ndarray) -> list[str]:
    item = Recording("a", position_m, force_n, 1e-3)
    return [found.kind for found in check_recordings([item]).findings if found.kind != "speeds"]


def test_a_motion_that_seldom_comes_back_to_the_surface_leaves_it() -> None:
    """A sum of sines that begins at the surface, as `record` makes it."""
    turns = np.outer([0.9, 1.7, 3.1], 2.0 * np.pi * TIME_S)
    position_m = 1e-3 * np.sum(1.0 - np.cos(turns), axis=0)
    assert np.mean(position_m < 0.02 * position_m.max()) < 0.05
    assert one_line_each(position_m, 2e3 * position_m) == []


def test_an_object_that_is_pulled_too_keeps_its_zero() -> None:
    position_m = 4e-3 * np.sin(2.0 * np.pi * TIME_S)
    item = Recording("a", position_m, 5e3 * position_m + 2.0 * np.cos(2 * np.pi * TIME_S), 1e-3)
    found = findings(item)["contact"]
    assert "is bonded to the tool and pulls" in found.so_what
    assert "--zero" not in found.line


@pytest.mark.parametrize(
    ("form", "dt_s", "rows", "options", "doubted"),
    [
        ("{:.2f}", 0.5, 200, [], False),
        ("{:.2f}", 0.5, 9000, [], False),
        ("{:.2f}", 1.0, 200, [], False),
        ("{:.2f}", 1.0, 9000, [], True),  # milliseconds, in the digits of the other columns
        ("{:.2f}", 1.0, 9000, ["--resample-hz", "1"], False),
        ("{:.0f}", 1.0, 200, [], True),  # sample numbers, or milliseconds
        ("{:.0f}", 1.0, 200, ["--resample-hz", "1"], False),
    ],
)
def test_a_slow_test_is_logged_slowly(
    form: str, dt_s: float, rows: int, options: list[str], doubted: bool, tmp_path: Path
) -> None:
    position_mm = 2.0 * np.sin(np.arange(rows) / 40.0) ** 2
    lines = [f"{form.format(k * dt_s)},{x:.6f},{3 * x:.6f}" for k, x in enumerate(position_mm)]
    text = "\n".join(["time_s,position_mm,force_N", *lines]) + "\n"
    result = run_import(tmp_path, text, *options)
    assert ("samples a second" in result.stderr) == doubted


@pytest.mark.parametrize("rate_hz", [20, 50, 200])
def test_a_coarse_sensor_that_is_interpolated_loses_no_sample(rate_hz: int) -> None:
    for own_hz, press_hz, step_m, step_n in itertools.product(
        (7, 25, 40, 150), (0.1, 0.5, 2.0), (0.0, 1e-5, 5e-5), (0.0, 0.01, 0.05)
    ):
        own_s = np.arange(0.0, 20.0, 1.0 / own_hz)
        depth_m = 5e-3 * np.sin(np.pi * press_hz * own_s) ** 2
        read_m, read_n = (
            np.round(exact / step) * step if step else exact
            for exact, step in ((depth_m, step_m), (600.0 * depth_m, step_n))
        )
        time_s = np.arange(0.0, own_s[-1], 1.0 / rate_hz)
        resampled = (np.interp(time_s, own_s, read) for read in (read_m, read_n))
        found = channel_findings(Recording("a", *resampled, 1.0 / rate_hz))
        assert [finding.line for finding in found if finding.kind == "gap"] == []


@given(st.floats(1e-8, 1e8))
def test_a_value_has_three_digits_and_no_exponent(value: float) -> None:
    written, _, unit = three_digits(value, "m").partition(" ")
    scale = {"Mm": 1e6, "km": 1e3, "m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}[unit]
    assert float(written) * scale == pytest.approx(value, rel=5.01e-3)
    assert "e" not in written and (1.0 <= float(written) < 1000.0)


@pytest.mark.parametrize("seed", range(5))
def test_the_speed_of_a_staircase_is_that_of_its_ramps(seed: int) -> None:
    """Ramps of one speed between holds of any length: the holds are no part of it."""
    rng = np.random.default_rng(seed)
    steps_m, holds_s = rng.uniform(2e-4, 1e-3, 6), rng.uniform(2.0, 60.0, 6)
    knots = [(0.0, 0.0)]
    for step_m, hold_s in zip(steps_m, holds_s, strict=True):
        time_s, depth_m = knots[-1]
        knots += [(time_s + step_m / 1e-3, depth_m + step_m)] * 2
        knots[-1] = (knots[-2][0] + hold_s, knots[-2][1])
    position_m = np.interp(np.arange(0.0, knots[-1][0], 0.02), *zip(*knots, strict=True))
    ((_, _, speed_mps),) = find_strokes(Recording("stairs", position_m, 1e3 * position_m, 0.02))
    assert speed_mps == pytest.approx(1e-3, rel=0.15)


@pytest.mark.parametrize("samples", [5, 20])
@pytest.mark.parametrize("hold", [200, 5000])
def test_a_glance_has_the_speed_of_a_short_stroke_between_long_holds(
    samples: int, hold: int
) -> None:
    position_m = np.interp(
        np.arange(2 * (samples + hold)),
        np.cumsum([0, hold, samples, hold, samples]), [0.0, 0.0, 1e-3, 1e-3, 0.0],
    )  # fmt: skip
    found = glance(Recording("a", position_m, 2e3 * position_m, 0.01))
    assert found.speed_mps == pytest.approx(1e-3 / samples / 0.01, rel=0.2)
