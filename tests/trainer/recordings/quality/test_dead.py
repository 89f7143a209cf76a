"""A sensor that gives one value for a while: found wherever it is, and no object's doing."""

from dataclasses import replace

import numpy as np
import pytest
from support.small import soft_force

from springpot import Recording, check_recordings
from springpot.trainer.recordings.quality.sensors.jumps import dead_findings


def pressed(seed: int) -> tuple[Recording, np.random.Generator]:
    """Presses of some speed and rate, with noise or with a sensor's steps."""
    draw = np.random.default_rng(seed)
    dt_s, hz = float(draw.choice([0.001, 0.01])), float(draw.uniform(0.1, 0.6))
    time_s = np.arange(round(3.0 / hz / dt_s)) * dt_s
    position_m = 0.004 * (1.0 - np.cos(2.0 * np.pi * hz * time_s))
    force_n = soft_force(position_m)
    step_n = 10.0 ** draw.uniform(-4.0, -2.0) * force_n.max()
    noisy = force_n + draw.normal(0.0, step_n, force_n.shape)
    force_n = noisy if draw.uniform() < 0.5 else step_n * np.round(noisy / step_n)
    return Recording("press", position_m, force_n, dt_s), draw


@pytest.mark.parametrize("seed", range(20))
def test_a_run_of_one_value_far_from_those_beside_it_is_named(seed: int) -> None:
    recording, draw = pressed(seed)
    force_n = recording.force_n.copy()
    begin = int(draw.choice(np.flatnonzero(force_n > 0.6 * force_n.max())))
    end = begin + int(draw.integers(3, 12))
    force_n[begin:end] = draw.choice([0.0, -1.0, 2.5]) * force_n.max()
    (found,) = dead_findings(replace(recording, force_n=force_n))
    assert f"{end - begin} samples from {begin * recording.dt_s:.4g} s" in found.what


@pytest.mark.parametrize("seed", range(20))
def test_rows_that_were_lost_are_named_for_both_channels(seed: int) -> None:
    recording, draw = pressed(seed)
    position_m, force_n = recording.position_m.copy(), recording.force_n.copy()
    begin = int(draw.choice(np.flatnonzero((force_n > 0.6 * force_n.max())[:-40])))
    end = begin + int(draw.integers(3, 12))
    position_m[begin:end], force_n[begin:end] = 0.0, 0.0
    found = dead_findings(replace(recording, position_m=position_m, force_n=force_n))
    assert [finding.what.split(" jumps")[0] for finding in found] == ["position", "force"]


@pytest.mark.parametrize("seed", range(20))
def test_presses_steps_holds_and_strikes_have_none(seed: int) -> None:
    recording, draw = pressed(seed)
    assert not list(dead_findings(recording))
    # A tool that steps within a sample, and rests exactly; one that leaves the object, to 0 N.
    depths_m = np.repeat(draw.uniform(-0.004, 0.004, 8), 40)
    stepped = replace(recording, position_m=depths_m, force_n=soft_force(np.maximum(depths_m, 0.0)))
    assert not list(dead_findings(stepped))


def test_check_says_when_and_what_to_do() -> None:
    recording, _ = pressed(3)
    force_n = recording.force_n.copy()
    peak = int(np.argmax(force_n))
    force_n[peak : peak + 5] = 0.0
    report = check_recordings([replace(recording, force_n=force_n)])
    lines = [finding.line for finding in report.findings if finding.kind == "dead"]
    assert len(lines) == 1 and "force jumps to 0 N and stays there, once, 5 samples" in lines[0]
