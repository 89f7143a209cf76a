"""The error of the stiffness: right on objects with a known slope, whatever the noise."""

import numpy as np
import pytest
from support.small import DT_S, press

from springpot.codegen.arrays import rms
from springpot.host.metrics import _slopes, press_errors_n, slope_errors
from springpot.trainer.recordings.recording import Recording

DEPTH_M = press(0.5, cycles=3)
FORCE_N = 200.0 * DEPTH_M + 3e4 * DEPTH_M**2


def recorded(noise_n: float = 0.0, seed: int = 1) -> Recording:
    noise = np.random.default_rng(seed).normal(0.0, noise_n, len(DEPTH_M))
    return Recording("x", DEPTH_M, FORCE_N + noise, DT_S)


@pytest.mark.parametrize("noise_n", [0.0, 0.003, 0.03])
def test_a_force_that_is_a_tenth_too_large_is_a_tenth_too_stiff(noise_n: float) -> None:
    found = slope_errors([recorded(noise_n)], [1.1 * FORCE_N])
    assert found.median_percent == pytest.approx(10.0, abs=3.0 * found.floor_percent + 1e-6)
    assert found.floor_percent <= 3.0 and found.windows >= 3 * (16 if noise_n < 0.01 else 2)


def test_the_floor_is_the_error_of_what_is_right() -> None:
    found = [slope_errors([recorded(0.02, seed)], [FORCE_N]) for seed in range(20)]
    ratios = [each.median_percent / each.floor_percent for each in found if each is not None]
    assert len(ratios) == 20
    # The median size of an error is 0.67 of its standard deviation.
    assert np.mean(ratios) == pytest.approx(0.67, rel=0.15)


def test_the_error_of_a_slope_is_known_from_few_samples_too() -> None:
    depth_m, noise_n = np.arange(8.0), np.random.default_rng(1).normal(size=(2000, 8))
    found = np.concatenate([list(_slopes(depth_m, each_n, each_n, 1)) for each_n in noise_n])
    assert rms(found[:, 1]) == pytest.approx(found[:, 0].std(), rel=0.05)


def test_steps_in_the_slope_show_and_an_offset_does_not() -> None:
    edges_m = np.linspace(0.0, DEPTH_M.max(), 9)
    straight = np.interp(DEPTH_M, edges_m, 200.0 * edges_m + 3e4 * edges_m**2)
    offset, stepped = (slope_errors([recorded()], [n]) for n in (FORCE_N + 0.1, straight))
    assert offset.p95_percent < 1e-6 and 2.0 < stepped.median_percent < stepped.p95_percent


def test_slopes_that_noise_hides_are_not_counted() -> None:
    """Only a quarter of the way is noisy: what is known elsewhere is known exactly."""
    hidden, noise = DEPTH_M / DEPTH_M.max(), np.random.default_rng(1).normal(size=len(DEPTH_M))
    noise_n = np.where((hidden > 0.5) & (hidden < 0.75), 0.3 * noise, 0.0)
    found = slope_errors([Recording("x", DEPTH_M, FORCE_N + noise_n, DT_S)], [FORCE_N])
    assert found.p95_percent < 1e-6


def test_the_ramp_at_the_start_is_no_error() -> None:
    ramped = FORCE_N * np.minimum(np.arange(len(FORCE_N)) / 500.0, 1.0)
    counted, not_counted = (slope_errors([recorded()], [ramped], ramps) for ramps in (None, [500]))
    assert counted.p95_percent > 10.0 and not_counted.p95_percent < 1e-6
    assert 0 < not_counted.windows <= counted.windows


def test_first_presses_err_apart_from_later_ones() -> None:
    press_m = 0.005 * (1.0 - np.cos(2.0 * np.pi * np.arange(500) / 500.0))
    item = Recording("three", np.tile(press_m, 3), 1e3 * np.tile(press_m, 3), 1e-3)
    predicted_n = item.force_n + np.repeat([9.0, 0.3, 0.1, 0.1], [100, 400, 500, 500])  # a ramp
    assert press_errors_n([item], [predicted_n], [100]) == pytest.approx((0.3, 0.1), abs=1e-3)
    late_n = item.force_n + np.repeat([9.0, 0.1], [600, 900])  # a ramp into the second press
    both = press_errors_n([item, item], [predicted_n, late_n], [100, 600])
    assert both == pytest.approx((0.3, 0.1), abs=1e-3)
    once = Recording("one", press_m, 1e3 * press_m, 1e-3)
    assert press_errors_n([once], [once.force_n], [0]) is None
