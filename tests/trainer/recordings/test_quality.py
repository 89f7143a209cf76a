"""The quality report: each fault, a delay, the noise floor: found, and not where there is none."""

import itertools
from dataclasses import replace
from math import gamma
from pathlib import Path

import numpy as np
import pytest
from support.files.mach1 import mach1_recordings
from support.presses.structures import recorded
from support.small import DT_S, press, recording, training

import springpot
from springpot import Recording, check_recordings
from springpot.trainer.recordings.quality.repeats import (
    Skew,
    find_cycles,
    find_noise_floor,
    skew_findings,
)
from springpot.trainer.recordings.signals import sensor_noise_n

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


def kinds(*recordings: Recording) -> list[str]:
    return [finding.kind for finding in check_recordings(recordings).findings]


def test_a_good_recording_has_no_findings(tmp_path: Path) -> None:
    assert kinds(sine("a", 0.5), sine("b", 2.0), sine("c", 5.0)) == [] and kinds(*training()) == []
    protocol = tmp_path / "p.toml"
    press = "[[profile]]\namplitude_n = {}\nfrequency_hz = {}\n"
    protocol.write_text("".join(press.format(n, hz) for n in (4, 9) for hz in (1, 4)))
    recordings = springpot.record("sim://dragon-skin-10", str(protocol), tmp_path / "out")
    assert kinds(*recordings) == []


@pytest.mark.parametrize("channel", ["position_m", "force_n"])
def test_a_constant_channel_is_refused(channel: str) -> None:
    report = check_recordings([replace(sine(), **{channel: np.full(len(TIME_S), 3.0)})])
    assert (report.refused, [found.kind for found in report.findings]) == (True, ["constant"])


def test_one_cause_is_one_line() -> None:
    position_m = 2.5e-3 * (1.0 - np.cos(2.0 * np.pi * TIME_S))
    force_n = 38.6 * (position_m / 5e-3) ** 1.6
    for x, f, found in (
        (position_m, np.minimum(force_n, 12.0), ["clipping"]),
        (np.minimum(position_m, 4e-3), force_n, ["clipping"]),
        (-position_m, -force_n, ["sign"]),
        (position_m, force_n, []),
    ):
        assert kinds(Recording("a", x, f, 1e-3)) == found


@pytest.mark.parametrize("noise_n", [0.01, 0.05, 0.2])
def test_a_hold_is_not_clipping(noise_n: float) -> None:
    """Nor is it if noise rises and falls meanwhile by a tenth of the force."""
    position_m = 5e-3 * np.clip(TIME_S, 0, 1) * np.clip(4.0 - TIME_S, 0, 1)
    relaxing = position_m * (800 + 200 * np.exp(-TIME_S)) + noise(noise_n)
    assert "clipping" not in kinds(Recording("a", position_m, relaxing, 1e-3))


@pytest.mark.parametrize(("step_n", "coarse"), [(0.25, True), (0.01, False)])
def test_quantisation(step_n: float, coarse: bool) -> None:
    rounded_n = np.round(sine().force_n / step_n) * step_n
    assert ("quantisation" in kinds(replace(sine(), force_n=rounded_n))) == coarse


@pytest.mark.parametrize("seed", range(4))
def test_wraps(seed: int) -> None:
    """Of any size from 0.45 of the travel on, anywhere in the stroke, at any speed."""
    rng = np.random.default_rng(seed)
    rate_hz = float(rng.choice([100.0, 500.0, 1000.0]))
    time_s = np.arange(0.0, 10.0, 1.0 / rate_hz)
    cycles = rng.uniform(0.2, 2.0) * time_s
    x = 5e-3 * (1.0 - np.cos(2.0 * np.pi * cycles))
    f = 1e3 * x + rng.normal(0.0, 0.02, len(time_s))
    size = rng.uniform(0.5, 0.8)
    wrapped_n = np.mod(f + 0.3 * size * np.ptp(f), size * np.ptp(f))
    drawn_back_m = 1e-3 * np.tile(np.linspace(0.0, 6.0, 20), 50)
    held_n = 3.0 * (1.0 + time_s) ** -0.2 + rng.normal(0.0, 0.002, len(time_s))
    for position_m, force_n, wraps in (
        (x, f, False),
        (np.mod(x, size * 10e-3), f, True),
        (x, wrapped_n, True),
        (drawn_back_m, 800.0 * drawn_back_m, False),
        (2e-3 + rng.normal(0.0, 1e-6, len(time_s)), held_n, False),
        (x, f * (1.0 - 0.7 * (cycles % 1.0 > 0.4)), False),  # cracks, and heals in the air
    ):
        assert ("wrap" in kinds(Recording("a", position_m, force_n, 1.0 / rate_hz))) == wraps


def test_cycles_of_a_sine() -> None:
    cycles = find_cycles(sine(hz=2.0, noise_n=0.03))
    assert cycles.metadata()["count"] == 7 and cycles.frequency_hz == pytest.approx(2.0, rel=1e-3)
    assert cycles.stiffness_npm == pytest.approx(1000.0, rel=1e-2)
    assert cycles.lead_rad == pytest.approx(0.1, abs=2e-3)
    ramp_m = np.linspace(0, 10e-3, 4000)
    assert find_cycles(Recording("a", ramp_m, 500 * ramp_m, 1e-3)) is None


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


@pytest.mark.parametrize("hz", [0.1, 1.0, 10.0])
def test_cycles_are_found_behind_an_approach_and_before_a_retreat(hz: float) -> None:
    """A ramp, a rest at depth, cycles about it, or up to it without a rest, a way back."""
    depth_m, dt_s = 1.5e-3, 1.0 / max(100.0, 40.0 * hz)
    draw = np.random.default_rng(1)
    for share, cycles, wait_s, back in itertools.product(
        (0.07, 0.2, 0.7), (6, 30), (0, 1, 20), (False, True)
    ):
        phase = 2 * np.pi * hz * np.arange(0, cycles / hz, dt_s)
        about = np.sin(phase) if wait_s else np.cos(phase) - 1.0
        to = [np.linspace(0.0, depth_m, round(1.5 / dt_s)), np.full(round(wait_s / dt_s), depth_m)]
        parts = [*to, depth_m * (1 + share / 2 * about)]
        parts += [np.linspace(parts[-1][-1], -5e-4, round(2.0 / dt_s))] if back else []
        x = np.concatenate(parts)
        x += draw.normal(0, 1e-6, len(x))
        f = 3000 * np.maximum(x, 0.0) + 10 * np.gradient(x, dt_s) + draw.normal(0, 4e-3, len(x))
        found = find_cycles(Recording("x", x, f, dt_s))
        assert found.frequency_hz == pytest.approx(hz, rel=0.02), (share, cycles, wait_s, back)
        assert found.stiffness_npm == pytest.approx(abs(3000 + 20j * np.pi * hz), rel=0.02)


def test_stiffness_of_the_real_sinusoids(mach1_file: Path) -> None:
    """Published with the data: stiffness rises from about 912 to 1035 N/mm."""
    report = check_recordings(mach1_recordings(mach1_file, "first"))
    cycles = [metadata["cycles"] for metadata in report.recordings]
    assert [round(c["frequency_hz"], 1) for c in cycles] == [0.1, 0.2, 0.5, 1.0, 2.0]
    stiffness = [c["stiffness_npm"] * 1e-3 for c in cycles]
    assert stiffness == sorted(stiffness)
    assert stiffness[::4] == pytest.approx([912, 1035], abs=1) and report.findings == []
    assert cycles[-1]["loss"]["angle_uncertainty_rad"] < 0.2


@pytest.mark.parametrize("skew_ms", [-2, 0, 2, 6])
def test_skew_is_estimated_with_its_uncertainty(skew_ms: int) -> None:
    recordings = []
    for hz in (0.75, 1.0, 2.0, 3.0, 5.0, 8.0):
        lead_rad = 0.06 + 0.01 * np.log(hz) - 2 * np.pi * hz * skew_ms * 1e-3
        recordings.append(sine(f"{hz}", hz, lead_rad))
    report = check_recordings(recordings)
    assert abs(report.skew.delay_s * 1e3 - skew_ms) < report.skew.uncertainty_s * 1e3
    assert report.skew.uncertainty_s < 3e-3
    found = [finding for finding in report.findings if finding.kind == "alignment"]
    assert bool(found) == (abs(skew_ms) > 2)
    delays_s = {"force_delay_s": (skew_ms + 3) * 1e-3, "position_delay_s": 3e-3}
    stated = check_recordings([replace(r, **delays_s) for r in recordings])
    assert "alignment" not in {finding.kind for finding in stated.findings}
    for metadata in stated.recordings:
        loss = metadata["cycles"]["loss"]
        true_rad = 0.06 + 0.01 * np.log(metadata["cycles"]["frequency_hz"])
        assert abs(loss["angle_rad"] - true_rad) < min(loss["angle_uncertainty_rad"], 0.02)
    if not skew_ms:  # nothing is late, whatever was stated
        wrong = check_recordings([replace(r, force_delay_s=9e-3) for r in recordings])
        assert "alignment" not in {finding.kind for finding in wrong.findings}
    # Of one frequency nothing can be told, and no loss is quoted.
    alone = check_recordings(recordings[:1])
    assert alone.skew is None and alone.recordings[0]["cycles"]["loss"] is None


@pytest.mark.slow
@pytest.mark.parametrize("structure", ["left-out-depth", "third-repeat"])
@pytest.mark.parametrize("name", ["bergstrom-boyce", "stiffening-tissue", "mullins",
                                  "poro-viscoelastic", "ecoflex-00-10"])  # fmt: skip
def test_presses_without_a_delay_are_not_said_to_have_one(
    name: str, structure: str, tmp_path: Path
) -> None:
    """The first press of an object that settles loses more than a cycle does, at each speed."""
    rest = "?rest=2" if structure == "third-repeat" else ""
    presses = recorded(f"sim://{name}{rest}", structure, tmp_path / "a")
    assert "alignment" not in {found.kind for found in check_recordings(presses).findings}


FIRST = recording("press", press(0.5))


def normal(sd: float, seed: int, samples: int = len(FIRST.force_n)) -> np.ndarray:
    return np.random.default_rng(seed).normal(0, sd, samples)


def repeats(count: int, sd_n: float) -> list[Recording]:
    return [
        replace(FIRST, name=f"r{k}", force_n=FIRST.force_n + normal(sd_n, k)) for k in range(count)
    ]


@pytest.mark.parametrize("count", [2, 3, 8])
def test_noise_alone_gives_its_own_rms(count: int) -> None:
    found = find_noise_floor(repeats(count, 0.05))
    assert found.rms_n == pytest.approx(0.05, rel=0.05)
    assert (found.source, found.words) == ("repeats", f"from {count} repeats of one press")


def test_a_softer_object_under_the_same_force_is_no_explanation_of_itself() -> None:
    """The second press goes 6 % deeper: at equal depth its force differs by that much stiffness."""
    depth_m = np.maximum(press(0.5), 0.0)
    force_n = 500.0 * depth_m
    presses = [
        Recording(f"p{k}", depth_m * (1 + 0.06 * k), force_n + normal(0.002, k), DT_S)
        for k in range(2)
    ]
    found = find_noise_floor(presses)
    # Half the difference stands for each of two, and their mean depth is 3 % deeper.
    expected_n = 0.06 / 1.03 * float(np.sqrt(np.mean(force_n**2))) / np.sqrt(2)
    assert found.source == "repeats" and found.rms_n == pytest.approx(expected_n, rel=0.03)


@pytest.mark.parametrize("hz", [2.0, 3.17])  # of whole samples, and between them
def test_cycles_stand_in_for_repeats(hz: float) -> None:
    cycles = recording("cycles", press(hz, cycles=8))
    noisy = replace(cycles, force_n=cycles.force_n + normal(0.05, 0, len(cycles.force_n)))
    found = find_noise_floor([noisy])
    assert (found.source, found.rms_n) == ("cycles", pytest.approx(0.05, rel=0.1))
    assert found.words == "from the repeated cycles within one recording"


@pytest.mark.parametrize(("lost", "warned"), [(15, False), (25, True)])
def test_samples_filled_by_the_last_one_are_seen_from_20_ms_on(lost: int, warned: bool) -> None:
    rows = np.arange(len(FIRST.force_n))
    rows[100 : 100 + lost] = 100
    noisy_n = FIRST.force_n + normal(0.01, 0)
    filled = replace(FIRST, position_m=FIRST.position_m[rows], force_n=noisy_n[rows])
    assert ("gap" in [each.kind for each in check_recordings([filled]).findings]) is warned


@pytest.mark.parametrize("held", [1, 10])
def test_the_sensor_is_seen_through_the_press(held: int) -> None:
    """Also where it is slower than the recording, and holds its value."""
    force_n = FIRST.force_n + normal(0.03, 0)
    slow_n = np.repeat(force_n[::held], held)[: len(force_n)]
    assert 0.02 < sensor_noise_n(slow_n) < 0.06


def test_no_noise_is_said_not_divided_by() -> None:
    found = find_noise_floor([FIRST])
    assert (found.rms_n, found.source) == (None, None)
    assert found.words == "no press is repeated, and the force shows no noise"
    assert find_noise_floor([]).rms_n is None
    still = Recording("still", np.zeros(100), np.full(100, 3.0), DT_S)
    assert find_noise_floor([still, replace(still, name="again")]).rms_n is None


def test_an_object_that_settles_within_its_cycles_is_no_noise() -> None:
    """A model with a memory predicts how the cycles' mean and height settle."""
    cycles = recording("cycles", press(2.0, cycles=20))
    left = np.exp(-np.arange(len(cycles.force_n)) * DT_S / 2.0)
    settling_n = cycles.force_n * (1.0 + 0.1 * left) + normal(0.01, 0, len(left))
    found = find_noise_floor([replace(cycles, force_n=settling_n)])
    assert found.source == "cycles" and 0.009 < found.rms_n < 0.03


def test_repeats_of_one_session_are_no_noise() -> None:
    noisy = repeats(4, 0.05)
    timed = [replace(each, session="s", start_s=10.0 * k) for k, each in enumerate(noisy)]
    assert find_noise_floor(noisy).source == "repeats"
    assert find_noise_floor(timed).source != "repeats"
    apart = [replace(each, session=f"{k}") for k, each in enumerate(timed)]
    assert find_noise_floor(apart).source == "repeats"


@pytest.mark.parametrize("taken_s", [0.0, 0.002])
def test_the_delay_that_is_named_is_the_whole_one(taken_s: float) -> None:
    """Of what was taken out at the import already, and of what is left of it."""
    late = Recording("a", np.zeros(9), np.zeros(9), 1e-3, details={"aligned_s": taken_s})
    skew = Skew(delay_s=0.006, uncertainty_s=0.001)
    (finding,) = skew_findings([late, late], skew)
    assert f"--force-delay-s {0.006 + taken_s:.2g} --align" in finding.to_do
