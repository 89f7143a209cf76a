"""Presses of one object with one fault each: it is named, and a printed remedy mends it."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter
from support.in_process import spring

import springpot
from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.conditioning import Conditioning, condition
from springpot.trainer.recordings.contact_point import find_contact
from springpot.trainer.recordings.quality import signs
from springpot.trainer.recordings.quality.channels import channel_findings
from springpot.trainer.recordings.recording import Recording, Zero

DEPTH_M, PEAK_N, NOISE_N, COUNT_N, DT_S = 5e-3, 8.0, 0.01, 0.012, 5e-3
SURFACE_M = 12e-3
AUTO = Conditioning(contact_force="auto")
Fault = Callable[[Samples, Samples, int], tuple[Samples, Samples]]


def press(number: int, surface_m: float = 0.0) -> tuple[Samples, Samples]:
    """Ramps from the air, at several depths and speeds, of an object that relaxes; N and m."""
    random = np.random.default_rng(number)
    depths = DEPTH_M * random.uniform(0.5, 1.0, 5)
    corners = [(0.0, -1e-3)]
    for depth in depths:
        for wait_s, to_m in ((0.5, -1e-3), (random.uniform(0.2, 1.0), depth), (0.5, depth)):
            corners.append((corners[-1][0] + wait_s, to_m))
        corners.append((corners[-1][0] + random.uniform(0.2, 1.0), -1e-3))
    corners.append((corners[-1][0] + 0.5, -1e-3))
    at_s, at_m = np.array(corners).T
    position_m = np.interp(np.arange(0.0, at_s[-1], DT_S), at_s, at_m)
    elastic_n = PEAK_N * (np.maximum(position_m, 0.0) / DEPTH_M) ** 1.4
    left = (1.0 + np.arange(len(elastic_n)) * DT_S / 0.05) ** -0.2  # relaxes by a power of time
    force_n = np.convolve(np.diff(elastic_n, prepend=0.0), 0.6 + 0.4 * left)[: len(elastic_n)]
    force_n = np.where(position_m > 0.0, np.maximum(force_n, 0.0), 0.0)
    force_n += NOISE_N * random.standard_normal(len(force_n))
    return position_m + surface_m, COUNT_N * np.round(force_n / COUNT_N)


def presses(fault: Fault, surface_m: float = 0.0) -> list[Recording]:
    return [
        Recording(f"p{number}", *fault(*press(number, surface_m), number), DT_S)
        for number in range(3)
    ]


def right(position_m: Samples, force_n: Samples, _number: int) -> tuple[Samples, Samples]:
    return position_m, force_n


def drifts(position_m: Samples, force_n: Samples, number: int) -> tuple[Samples, Samples]:
    return position_m, force_n + 0.2 * number + 0.1 * DT_S * np.arange(len(force_n))


def wraps(position_m: Samples, force_n: Samples, number: int) -> tuple[Samples, Samples]:
    low_m = position_m.min()
    return low_m + np.mod(position_m - low_m, 0.7 * float(np.ptp(position_m))), force_n


def loses_the_sign(position_m: Samples, force_n: Samples, number: int) -> tuple[Samples, Samples]:
    return position_m, np.where(force_n < 0.0, 0.6 * PEAK_N - force_n, force_n)


def sticks(position_m: Samples, force_n: Samples, number: int) -> tuple[Samples, Samples]:
    stuck_m = position_m.copy()
    for begin in (150, 500):
        stuck_m[begin : begin + 90] = stuck_m[begin]
    return stuck_m, force_n


def stands_still(position_m: Samples, force_n: Samples, number: int) -> tuple[Samples, Samples]:
    last = int(np.flatnonzero(force_n > 0.5 * PEAK_N)[200])
    return position_m, np.append(force_n[:last], np.full(len(force_n) - last, force_n[last]))


def comes_off(position_m: Samples, force_n: Samples, number: int) -> tuple[Samples, Samples]:
    off = int(np.flatnonzero(force_n > 0.3 * PEAK_N)[200 + 40 * number])
    noise_n = NOISE_N * np.random.default_rng(number).standard_normal(len(force_n) - off)
    return position_m, np.append(force_n[:off], noise_n)


def spikes(position_m: Samples, force_n: Samples, number: int) -> tuple[Samples, Samples]:
    random = np.random.default_rng(number)
    at = random.random(len(force_n)) < 0.02
    at[0] = False
    return position_m, np.where(at, 2.5 * PEAK_N, force_n)


def error(recordings: list[Recording]) -> float:
    """RMSE on a press without a fault, of the peak."""
    fit = springpot.train(recordings, "hammerstein")
    position_m, force_n = press(7)
    return (
        float(np.sqrt(np.mean((springpot.predict(fit, position_m, DT_S) - force_n) ** 2))) / PEAK_N
    )


def kinds(recordings: list[Recording]) -> set[str]:
    return {finding.kind for finding in springpot.check_recordings(recordings).findings}


def test_right_ones_have_no_finding(recwarn: pytest.WarningsRecorder) -> None:
    assert kinds(presses(right)) == set() and error(presses(right)) < 0.006 and not recwarn.list


@pytest.mark.filterwarnings("always::UserWarning")
def test_a_drift_is_named_with_its_bound_and_taken_off() -> None:
    drifting = presses(drifts)
    findings = springpot.check_recordings(drifting).findings
    drift = [finding for finding in findings if finding.kind == "drift"]
    assert len(drift) == 3 and drift[0].to_do == "import with --tare auto"
    slope, bound = (float(drift[0].what.split()[at]) for at in (-4, -2))
    assert abs(slope - 6.0) < bound < 0.2 and error(drifting) > 0.05
    mended = [condition(each, Conditioning(tare="auto"))[0] for each in drifting]
    assert "drift" not in kinds(mended)
    assert mended[2].details["tare_n"] == pytest.approx(0.4, abs=0.02) and error(mended) < 0.006


def test_a_sensor_that_stands_still_is_named_and_no_drift() -> None:
    found = kinds(presses(stands_still))
    assert "stuck" in found and "drift" not in found


@pytest.mark.parametrize(
    ("fault", "cause"),
    [
        (wraps, "wraps"),
        (loses_the_sign, "two levels in the air"),
        (sticks, "position stands still"),
    ],
)
def test_what_hides_the_surface_is_named(fault: Fault, cause: str) -> None:
    with pytest.raises(DataError, match=cause):
        for recording in presses(fault, SURFACE_M):
            condition(recording, AUTO)


def test_a_clipped_force_is_named_where_its_drift_is_taken_off() -> None:
    position_m, force_n = drifts(*press(1), 1)
    clipped = Recording("p", position_m, np.minimum(force_n, 0.5 * PEAK_N), DT_S)
    mended, line = condition(clipped, Conditioning(tare="auto"))
    assert "drift" in line[0] and "clipping" in kinds([mended])


def test_a_mass_is_no_exchange_of_columns() -> None:
    """Force comes and goes while the tool starts and stops in the air, noisier than position."""
    position_m, force_n = press(1)
    smooth_m = np.convolve(
        np.pad(position_m, 20, mode="edge"), np.hanning(43)[1:-1] / 21.0, "valid"
    )
    inertia_n = 0.6 * PEAK_N * (bent := np.gradient(np.gradient(smooth_m))) / np.abs(bent).max()
    massive = Recording("p", smooth_m, force_n + inertia_n, DT_S)
    assert "exchanged" not in kinds([massive])


def test_a_cable_that_comes_off_is_named_and_no_object_that_flows() -> None:
    cut = []
    for number, recording in enumerate(presses(comes_off)):
        (found,) = springpot.check_recordings(recording).findings
        off_s = DT_S * int(np.flatnonzero(press(number)[1] > 0.3 * PEAK_N)[200 + 40 * number])
        at_s = float(found.what.split(" s")[0].split()[-1])
        assert found.kind == "tear" or (found.kind == "gone" and off_s <= at_s < off_s + 2.0)
        x, f = (its[: int(at_s / DT_S)] for its in (recording.position_m, recording.force_n))
        cut.append(Recording(recording.name, x, f, DT_S))
    assert kinds(cut) == set() and error(cut) < 0.006
    time_s = np.arange(0.0, 250.0, DT_S)
    turns = np.where(time_s < 8.0, time_s / 4.0, 2.0 + (time_s - 8.0) / 256.0)
    both = 0.5 * DEPTH_M * (1.0 - np.cos(2.0 * np.pi * turns))
    pushed_n = np.maximum(np.diff(both, prepend=0.0), 0.0)
    flows = Recording("putty", both, PEAK_N * pushed_n / pushed_n.max(), DT_S)
    assert "gone" not in {finding.kind for finding in channel_findings(flows)}


@pytest.mark.parametrize("power", [2.3, 2.6])
@pytest.mark.parametrize("preload_m", [1e-3, 1.5e-3])
def test_a_press_that_begins_inside_shows_no_surface(power: float, preload_m: float) -> None:
    """A curved law hides a preload in the noise; its surface would lie above all positions."""
    position_m = DEPTH_M * np.maximum(0.0, np.sin(0.5 * np.pi * np.arange(0.0, 16.0, DT_S)))
    force_n = PEAK_N * ((position_m + preload_m) / (DEPTH_M + preload_m)) ** power
    for seed in range(3):
        noise_n = 5 * NOISE_N * np.random.default_rng(seed).standard_normal(len(force_n))
        with pytest.raises(DataError, match="never leaves the object"):
            find_contact(Recording("inside", position_m, force_n + noise_n, DT_S))


@pytest.mark.slow
@pytest.mark.filterwarnings("always::UserWarning")
def test_presses_of_another_object_are_named() -> None:
    another = presses(lambda x, force_n, k: (x, force_n * (1.6 if k == 2 else 1.0)))
    fit = springpot.train(another, "hammerstein")
    (line,) = [line for line in fit.warnings if "at equal motion" in line]
    assert line.startswith("p2: ") and "try --model rf-fd" in line
    assert not springpot.train(presses(right), "hammerstein").warnings


@pytest.mark.filterwarnings("always::UserWarning")
@pytest.mark.parametrize("kind", ["hammerstein", pytest.param("auto", marks=pytest.mark.slow)])
def test_what_misses_a_third_of_the_force_is_no_model(kind: str, tmp_path: Path) -> None:
    time_s = np.arange(0.0, 4.0, DT_S)
    position_m = DEPTH_M * np.clip(np.minimum(time_s, 4.0 - time_s) / 0.3, 0.0, 1.0)
    found = [
        Recording(f"p{k}", position_m, (100.0, 2e3)[k % 2] * position_m, DT_S) for k in range(4)
    ]
    springpot.write_recordings(tmp_path / "rec", found)
    words = "train", tmp_path / "rec", "--model", kind, "--out", tmp_path / "m.spm"
    refused = spring(*words)
    assert refused.returncode == 1 and not (tmp_path / "m.spm").exists()
    assert re.search("missed by 60 % of the largest force.*--accept-misfit", refused.stderr)
    assert spring(*words, "--accept-misfit").returncode == 0
    accepted = springpot.train(found, kind, accept_misfit=True)
    assert accepted.metadata["cv_rmse_n"] > 0.0
    unlike = "p1: at equal motion, its force is 20 times that of p0"
    assert kind == "auto" or any(unlike in line for line in accepted.warnings)


def test_spikes_move_no_zero_and_no_surface() -> None:
    for recording in presses(spikes, SURFACE_M):
        found = condition(recording, AUTO)[0].details
        assert abs(found["contact_position_m"] - SURFACE_M) <= found["contact_uncertainty_m"] < 4e-4
        zeroed = condition(recording, Conditioning(), "min")[0]
        assert np.ptp(zeroed.force_n) < 1.2 * PEAK_N
    many = presses(lambda x, f, _: (x, np.where(np.arange(len(f)) % 9 == 4, 3 * PEAK_N, f)))
    with pytest.raises(DataError, match="too many to be replaced"):
        condition(many[0], AUTO)


@pytest.mark.parametrize("lost", [0.002, 0.03])
def test_short_gaps_are_interpolated_where_a_rate_is_given(lost: float) -> None:
    position_m, force_n = press(1)
    keep = np.random.default_rng(3).random(len(force_n)) > lost
    keep[:25], keep[40:48] = True, False  # 0.045 s without a sample
    time_s = DT_S * np.arange(len(force_n))
    table = {"time_s": time_s[keep], "position_m": position_m[keep], "force_n": force_n[keep]}
    with pytest.raises(DataError, match=r"gap of .*: to interpolate there, pass --resample-hz 200"):
        Recording.from_frame(table)
    filled = Recording.from_frame(table, resample_hz=200.0)
    assert np.abs(filled.position_m - position_m[: len(filled.position_m)]).max() < 1e-4
    assert "interpolated" in filled.details["notes"][0]
    long = np.r_[0:300, 320 : len(time_s)]
    cut = {"time_s": time_s[long], "position_m": position_m[long], "force_n": force_n[long]}
    with pytest.raises(DataError, match=r"gap of 0\.1\d* s .*: cut the recording there"):
        Recording.from_frame(cut, resample_hz=200.0)


def test_rows_that_a_logger_wrote_twice_count_once() -> None:
    position_m, force_n = press(1)
    rows = np.sort(np.append(np.arange(len(force_n)), [40, 41, 90]))
    table = {"time_s": rows * DT_S, "position_m": position_m[rows], "force_n": force_n[rows]}
    once = Recording.from_frame(table)
    assert np.array_equal(once.force_n, force_n)
    assert once.details["notes"] == ["3 rows left out, equal to the row before"]
    table["force_n"] = table["force_n"] + np.where(np.arange(len(rows)) == 41, 1.0, 0.0)
    with pytest.raises(DataError, match="time stands still"):
        Recording.from_frame(table)


def test_a_load_that_one_of_the_recordings_has_is_no_refusal() -> None:
    one_loaded = presses(lambda x, f, number: (x, f + 3.0 * (number == 1)))
    findings = springpot.check_recordings(one_loaded).findings
    its = [(each.where, each.severity) for each in findings if each.kind == "tare"]
    assert its == [("p1", "warning")]


@pytest.mark.slow
def test_a_load_that_all_recordings_share_is_refused_unless_stated() -> None:
    loaded = presses(lambda x, f, _: (x, f + 3.0))
    with pytest.raises(DataError, match=r"N without contact: .*--tare auto"):
        springpot.train(loaded, "hammerstein")
    assert error([condition(each, Conditioning(tare=3.0))[0] for each in loaded]) < 0.006
    inside = presses(lambda x, f, _: (x[x > 1e-3] - 1e-3, f[x > 1e-3]))
    with pytest.warns(UserWarning, match=r"no recording leaves the object: .*tare=LOAD_N"):
        springpot.train(inside, "hammerstein")
    stated = [condition(each, Conditioning(tare=0.0))[0] for each in inside]
    assert springpot.train(stated, "hammerstein").model.contact == "always"


def cycles(seconds: float = 24.0, rate_hz: float = 100.0) -> Samples:
    """Positions at three paces from 1 mm above the surface to 4 mm, m."""
    time_s = np.arange(round(seconds * rate_hz)) / rate_hz
    pace_hz = np.array([0.3, 0.7, 1.2])[np.minimum(3 * time_s / seconds, 2).astype(int)]
    phase = np.concatenate([[0.0], np.cumsum(pace_hz[:-1] / rate_hz)])
    return 5e-3 * (0.5 - 0.5 * np.cos(2.0 * np.pi * phase)) - 1e-3


def soft_n(position_m: Samples, seed: int = 1) -> Samples:
    """Force of a stiffening object that relaxes, N, at 100 Hz."""
    depth = np.maximum(position_m, 0.0)
    branch = lfilter([6.0e2, -6.0e2], [1.0, -0.95], depth)
    noise_n = np.random.default_rng(seed).normal(0.0, 0.003, len(depth))
    return np.maximum(500.0 * depth + 6e4 * depth**2 + branch, 0.0) * (depth > 0.0) + noise_n


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(
    ("gain", "slip_m", "times"),
    [(1.0, 0.0, None), (0.6, 0.0, 0.55), (0.75, 0.0, 0.75), (1.3, 0.0, 1.3), (1.6, 0.0, 1.5),
     (1.0, 0.8e-3, 0.75), (1.0, -0.8e-3, 1.3)],
)  # fmt: skip
def test_another_force_at_equal_motion_is_named_with_its_time(
    gain: float, slip_m: float, times: float | None
) -> None:
    position_m = cycles()
    later = np.arange(len(position_m)) >= 1200
    force_n = soft_n(position_m - slip_m * later) * np.where(later, gain, 1.0)
    fit = springpot.train(Recording("a", position_m, force_n, 0.01), "hammerstein")
    said = [re.search(r"from (\S+) s on, force is about (\S+) times", w) for w in fit.warnings]
    found = [(float(one[1]), float(one[2])) for one in said if one]
    assert len(found) == (times is not None)
    for at_s, factor in found:
        assert at_s == pytest.approx(12.0, abs=1.5) and factor == pytest.approx(times, rel=0.12)
    where = re.search(r"most, (\S+) %, in a from (\S+) to (\S+) s", fit.metadata["residual_where"])
    assert where and (float(where[1]) < 0.5) == (times is None)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_residual_above_the_floor_of_cycles_is_said() -> None:
    """A force that is late by 30 ms: its cycles repeat, and no model follows them."""
    late_n = np.interp(np.arange(2400) - 3.0, np.arange(2400), soft_n(cycles()))
    for force_n, said in ((soft_n(cycles()), 0), (late_n, 1)):
        fit = springpot.train(Recording("a", cycles(), force_n, 0.01), "hammerstein")
        assert sum("times their noise floor" in line for line in fit.warnings) == said


def test_a_position_that_stands_still_is_named() -> None:
    position_m, force_n = cycles(), soft_n(cycles())
    stuck_m = position_m.copy()
    for begin in (310, 760, 1290, 1850):
        stuck_m[begin : begin + 45] = stuck_m[begin]
    held_m = np.interp(np.arange(2400), [0, 300, 400, 900, 1000, 2400], [-1, -1, 4, 4, -1, -1])
    for x, f, named in (
        (stuck_m, force_n, True),
        (np.round(position_m, 4), force_n, False),
        (1e-3 * held_m, soft_n(1e-3 * held_m), False),
    ):
        assert ("stuck" in kinds([Recording("a", x, f, 0.01)])) == named


@pytest.mark.parametrize("hz", [0.2, 0.5])
def test_a_force_that_falls_on_the_way_in_is_named(hz: float) -> None:
    time_s = np.arange(2000) / 100.0
    turning = 0.5 - 0.5 * np.cos(2.0 * np.pi * hz * time_s)
    ramps = np.abs((2.0 * hz * time_s + 1.0) % 2.0 - 1.0)
    for way in (turning, ramps):
        snaps_n = 10.0 * way - 4.0 / (1.0 + np.exp(-(way - 0.5) / 0.02))
        flows_n = 3.0 * way + lfilter([8.0, -8.0], [1.0, -0.9], way)
        heavy_n = 10.0 * way + 2.0 * np.gradient(np.gradient(turning, time_s), time_s)
        for force_n, named in ((snaps_n, True), (flows_n, False), (heavy_n, False)):
            assert ("fall" in kinds([Recording("a", 5e-3 * way, force_n, 0.01)])) == named


def test_exchanged_columns_are_refused_by_what_happens_in_the_air() -> None:
    position_m, noise = cycles(), np.random.default_rng(2).normal(0.0, 0.002, 2400)
    for force_n in (600.0 * np.maximum(position_m, 0.0) + noise, soft_n(position_m)):
        assert "exchanged" not in kinds([Recording("a", position_m, force_n, 0.01)])
        found = Recording("a", 1e-3 * force_n, 1e3 * position_m, 0.01)
        with pytest.raises(
            DataError, match=r"exchange the columns, --map position=COL:m,force=COL:N"
        ):
            springpot.check_recordings(found).refuse()


@pytest.mark.parametrize(("moved", "is_exchanged"), [(5, True), (3, True), (2, False), (1, False)])
def test_most_visits_of_an_end_have_to_tell_that_columns_are_exchanged(
    moved: int, is_exchanged: bool
) -> None:
    """Of five: an object that creeps back under a tool at rest moves in some."""
    swing = np.sin(np.linspace(0.0, np.pi, 40))
    level = np.tile(np.concatenate([np.zeros(40), swing]), 5)
    other = np.concatenate([swing * (visit < moved) for visit in range(5)])
    other = np.stack([other.reshape(5, 40), np.zeros((5, 40))], axis=1).ravel()
    assert signs._comes_and_goes(level, other) == is_exchanged


@pytest.mark.parametrize(("channel", "factor"), [("force_n", 1e3), ("position_m", 1e-3)])
def test_one_recording_in_another_unit_is_refused(channel: str, factor: float) -> None:
    usual = [Recording(f"{k}", cycles(), soft_n(cycles(), k), 0.01) for k in range(3)]
    assert not springpot.check_recordings(usual).refused
    usual[1] = replace(usual[1], **{channel: factor * getattr(usual[1], channel)})
    for several in (usual, usual[:2]):
        report = springpot.check_recordings(several)
        told = [each for each in report.findings if each.severity == "refusal"]
        assert [(each.kind, each.where) for each in told] == [("unit", "1")]
        assert re.search(rf"{1 / factor:.6g}m?N|{1 / factor:.6g}m", told[0].to_do)


def test_a_sign_bit_that_is_read_wrong_is_named_and_a_surface_that_lets_go_is_not() -> None:
    position_m, force_n = cycles(), soft_n(cycles())
    pulls_n = force_n - 0.9 * ((position_m < -1e-4) & (np.gradient(position_m) < 0.0))
    flipped_n = np.where(force_n < 0.0, 2.05 - force_n, force_n)
    for each_n, named in ((force_n, False), (pulls_n, False), (flipped_n, True)):
        assert ("levels" in kinds([Recording("a", position_m, each_n, 0.01)])) == named


def trapezoids(hold_s: float) -> Samples:
    """Eight presses from 5 mm above the surface, at 100 Hz, m."""
    knots_s, knots_m = [0.0], [-5e-3]
    for number in range(8):
        depth_m = (2.5 + 1.5 * (3 * number % 8) / 8) * 1e-3
        for span_s, to_m in ((1.0, -5e-3), (0.4, depth_m), (hold_s, depth_m), (0.4, -5e-3)):
            knots_s.append(knots_s[-1] + span_s)
            knots_m.append(to_m)
    return np.interp(np.arange(0.0, knots_s[-1], 0.01), knots_s, knots_m)


@pytest.mark.parametrize("hold_s", [0.2, 1.0, 3.0])
@pytest.mark.parametrize("per_min", [0.05, 0.2, 0.6, -0.1, -0.3])
def test_a_slow_drift_is_taken_off_and_moves_no_surface(per_min: float, hold_s: float) -> None:
    position_m = trapezoids(hold_s)
    drift_n = per_min / 60.0 * 0.01 * np.arange(len(position_m))
    item = Recording("a", position_m + 20e-3, soft_n(position_m) + drift_n, 0.01)
    (mended, (line,)) = condition(item, Conditioning(tare="auto", contact_force="auto"))
    taken = re.search(r"drift of (\S+) N/min", line)
    assert taken and float(taken[1]) == pytest.approx(per_min, abs=0.02)
    off_m = mended.details["contact_position_m"] - 20e-3
    assert abs(off_m) < mended.details["contact_uncertainty_m"] < 0.4e-3


def test_a_slope_in_the_air_is_named_and_a_preload_is_not_called_one() -> None:
    position_m = trapezoids(1.0)
    sloped_n = soft_n(position_m) + 30.0 * (position_m + 5e-3)
    pressed_n = soft_n(position_m + 6e-3)
    elastic_n = 1e3 * np.maximum(position_m, 0.0) + 50.0 * (position_m + 5e-3)
    for force_n, words in (
        (sloped_n, "0.03.* N/mm over position"),
        (elastic_n, "0.05.* N/mm over position"),
        (pressed_n, "never leaves"),
    ):
        item = Recording("a", position_m, force_n, 0.01)
        try:
            mended = condition(item, Conditioning(contact_force="auto", tare="auto"))[0]
        except DataError as refused:
            assert re.search(words, str(refused))
        else:  # or the surface is found in spite of it
            off_m = mended.details["contact_position_m"]
            assert abs(off_m) < mended.details["contact_uncertainty_m"]


@pytest.mark.parametrize(
    ("low_m", "remedy"), [(-1e-3, "--contact-force auto"), (0.5e-3, "--zero (first|min)")]
)
def test_positions_below_0_all_along_are_refused_with_what_mends_them(
    low_m: float, remedy: str
) -> None:
    """A gap meter, turned round: of an object that is left, and of one that is not."""
    position_m = cycles() * (4e-3 - low_m) / 5e-3 + (low_m + (4e-3 - low_m) / 5.0)
    item = Recording("a", position_m - 11e-3, soft_n(position_m), 0.01)
    with pytest.raises(DataError, match=f"below 0 all along.*; import with {remedy}$"):
        springpot.check_recordings(item).refuse()
    zero: Zero = "none" if "contact" in remedy else "first"
    options = AUTO if zero == "none" else Conditioning()
    assert not springpot.check_recordings(condition(item, options, zero)[0]).refused


def test_all_refusals_of_a_folder_are_said_at_once(tmp_path: Path) -> None:
    for name, force in (("a", "1"), ("b", "x"), ("c", "1"), ("d", "nan")):
        rows = "".join(f"{k / 100},{k},{force if k == 5 else k}\n" for k in range(20))
        (tmp_path / f"{name}.csv").write_text(f"time_s,position_mm,force_N\n{rows}")
    with pytest.raises(DataError, match=r"b\.csv, row 7, .*; also .*d\.csv, row 7: force"):
        springpot.import_recordings(tmp_path)
