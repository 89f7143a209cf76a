"""Rows that were lost without a gap in time: found amid a motion, and no motion taken for them."""

from dataclasses import replace

import numpy as np
import pytest
from support.files.recording_files import PressedObject

from springpot import Recording
from springpot.trainer.recordings.quality.sensors.lost_rows import lost_findings


def measured(position_m: np.ndarray, dt_s: float, draw: np.random.Generator) -> Recording:
    """What a rig reads of a press: noise in both channels, and steps of the encoder."""
    law = PressedObject(0.008, 8.0, draw.uniform(1.0, 2.2), draw.uniform(0.0, 0.5))
    force_n = law.force(position_m, dt_s) + draw.normal(0.0, 0.01, len(position_m))
    step_m = draw.choice([1e-9, 1e-6, 1e-5])
    position_m = np.round((position_m + draw.normal(0.0, 5e-7, len(position_m))) / step_m) * step_m
    return Recording("press", position_m, force_n, dt_s)


def multi_sine(time_s: np.ndarray, draw: np.random.Generator) -> np.ndarray:
    """Presses of several depths at several speeds, as a hand does them."""
    hz = draw.uniform(0.2, 1.5) * np.array([1.0, 1.7, 3.1])
    sums = np.cos(2.0 * np.pi * np.outer(time_s, hz) + draw.uniform(0.0, 6.28, 3)).sum(axis=1)
    return 0.008 * (sums - sums.min()) / np.ptp(sums)


@pytest.mark.parametrize("seed", range(40))
def test_rows_lost_in_a_press_are_named_where_they_were(seed: int) -> None:
    draw = np.random.default_rng(seed)
    rate_hz = 10.0 ** draw.uniform(2.5, 3.3)
    hz = draw.uniform(0.3, 1.5)
    time_s = np.arange(0.0, 8.0, 1.0 / rate_hz)
    whole = measured(0.004 * (1.0 - np.cos(2.0 * np.pi * hz * time_s)), 1.0 / rate_hz, draw)
    # On the way in, so that force differs too; at a turn it may not.
    depth_m = whole.position_m
    within = np.flatnonzero((depth_m > 0.0025) & (depth_m < 0.0045) & (np.gradient(depth_m) > 0.0))
    begin = int(draw.choice(within[(within > 100) & (within < len(time_s) - 400)]))
    end = begin + round(draw.uniform(0.06, 0.12) / hz * rate_hz)
    kept = np.delete(np.arange(len(time_s)), np.arange(begin, end))
    cut = replace(whole, position_m=whole.position_m[kept], force_n=whole.force_n[kept])
    assert not list(lost_findings(whole))
    (found,) = lost_findings(cut)
    assert found.kind == "gap" and f"at {begin * whole.dt_s:.4g} s" in found.what


@pytest.mark.parametrize("rate_hz", [5.0, 10.0, 30.0, 100.0, 1000.0])
def test_a_motion_is_no_loss(rate_hz: float) -> None:
    """By hand, in steps, in triangles of many speeds, in saw teeth, held and struck."""
    dt_s = 1.0 / rate_hz
    time_s = np.arange(0.0, 3000.0 * dt_s, dt_s)[:3000]
    for seed in range(40):
        draw = np.random.default_rng(seed)
        ends_s = np.cumsum(10.0 ** draw.uniform(0.5, 2.5, 60) * dt_s)
        levels_m = 0.008 * draw.uniform(0.0, 1.0, 60)
        saw = (time_s * draw.uniform(0.01, 0.05) * rate_hz) % 1.0
        hit_s = draw.uniform(0.2, 0.8) * time_s[-1]
        strike = np.where(time_s < hit_s, 0.1 * time_s / hit_s, 0.9)
        motions = {
            "by hand": multi_sine(time_s * min(1.0, rate_hz / 30.0), draw),
            "steps": levels_m[np.minimum(np.searchsorted(ends_s, time_s), 59)],
            "ramps": np.interp(time_s, ends_s, levels_m),
            "saw teeth": 0.008 * saw,
            "saw teeth out": 0.008 * (1.0 - saw),
            "a strike": 0.008 * strike,
        }
        for name, position_m in motions.items():
            found = list(lost_findings(measured(position_m, dt_s, draw)))
            assert not found, (name, seed, found[0].what)
