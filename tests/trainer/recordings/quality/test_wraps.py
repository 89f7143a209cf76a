"""A counter of position that wraps is refused; a tool that is drawn back at once is not."""

import numpy as np
import pytest

from springpot import Recording, check_recordings


def kinds(position_m: np.ndarray, force_n: np.ndarray, rate_hz: float) -> set[str]:
    recording = Recording("a", position_m, force_n, 1.0 / rate_hz)
    return {finding.kind for finding in check_recordings([recording]).findings}


@pytest.mark.parametrize("seed", range(8))
def test_wraps(seed: int) -> None:
    """Of any size from 0.45 of the travel on, anywhere in the stroke, at any speed."""
    rng = np.random.default_rng(seed)
    rate_hz = float(rng.choice([100.0, 500.0, 1000.0]))
    time_s = np.arange(0.0, 10.0, 1.0 / rate_hz)
    position_m = 5e-3 * (1.0 - np.cos(2.0 * np.pi * rng.uniform(0.2, 2.0) * time_s))
    force_n = 1e3 * position_m + rng.normal(0.0, 0.02, len(time_s))
    assert "wrap" not in kinds(position_m, force_n, rate_hz)
    assert "wrap" in kinds(np.mod(position_m, rng.uniform(0.5, 0.8) * 10e-3), force_n, rate_hz)


@pytest.mark.parametrize("seed", range(3))
def test_wraps_of_force_and_wraps_that_chatter(seed: int) -> None:
    """A converter that overflows; a counter that rests where it wraps, in noise."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(0.0, 12.0, 2e-3)
    turns = np.interp(time_s, (0.0, 3.0, 5.0, 8.0, 12.0), (0.0, 1.5, 1.5, 3.5, 4.5))
    position_m = 5e-3 * (1.0 - np.cos(2.0 * np.pi * turns))
    force_n = 1e3 * position_m**1.2 + rng.normal(0.0, 0.005, len(time_s))
    size_n = rng.uniform(0.5, 0.8) * np.ptp(force_n)
    assert "wrap" in kinds(position_m, np.mod(force_n + 0.3 * size_n, size_n), 500.0)
    rests_at_m = 5e-3 * (1.0 - np.cos(3.0 * np.pi))
    noisy_m = position_m + rng.normal(0.0, 2e-5, len(time_s))
    size_m = rng.uniform(0.5, 0.8) * 10e-3
    assert "wrap" in kinds(np.mod(noisy_m - rests_at_m, size_m), force_n, 500.0)


@pytest.mark.parametrize("samples", [7, 20, 200])
def test_a_tool_that_is_drawn_back_within_a_sample_is_no_wrap(samples: int) -> None:
    position_m = 1e-3 * np.tile(np.linspace(0.0, 6.0, samples), 2000 // samples)
    assert "wrap" not in kinds(position_m, 800.0 * position_m, 100.0)


@pytest.mark.parametrize("seed", range(20))
def test_noise_in_a_hold_alone_is_no_counter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    time_s = 1e-2 * np.arange(rng.integers(200, 5000))
    position_m = 2e-3 + rng.normal(0.0, 1e-6, len(time_s))
    if seed % 2:
        position_m = np.round(position_m, 6)
    force_n = 3.0 * (1.0 + time_s) ** -0.2 + rng.normal(0.0, 0.002, len(time_s))
    assert "wrap" not in kinds(position_m, force_n, 100.0)
