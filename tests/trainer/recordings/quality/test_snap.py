"""Snap-through is said; stops, friction, relaxation and noise without it are not."""

import numpy as np
import pytest
from support.derivatives import fir_derivatives
from support.small import soft_force

from springpot import Recording, check_recordings
from springpot.trainer.features.fractional import gl_taps
from springpot.trainer.recordings.quality.snap import snap_findings

DEPTH_M = 5e-3


def motion(hz: float, rate_hz: float, ramp: bool, depth_m: float) -> np.ndarray:
    phase = hz * np.arange(0.0, 4.0 / hz, 1.0 / rate_hz) % 1.0
    rise = 1.0 - np.abs(1.0 - 2.0 * phase) if ramp else 0.5 * (1 - np.cos(2 * np.pi * phase))
    return depth_m * rise


def dome_n(position_m: np.ndarray, fall: float, at: float) -> np.ndarray:
    """Force rises to a peak, falls by a share of it over a fifth of the travel, and rises again."""
    x = position_m / DEPTH_M
    knots = np.array([0.0, 0.6 * at, at, at + 0.2, 1.0])
    heights = np.array([0.0, 0.8, 1.0, 1.0 - fall, 1.0])
    smooth = np.interp(x, knots, heights)
    return 6.0 * smooth


def recorded(force_of, seed: int, noise_n: float, rate_hz: float, ramp: bool) -> list[Recording]:  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(seed)
    found = []
    for hz in (0.25, 1.0):
        position_m = motion(hz, rate_hz, ramp, DEPTH_M)
        force_n = force_of(position_m, 1.0 / rate_hz) + noise_n * rng.standard_normal(
            len(position_m)
        )
        found.append(Recording(f"{hz}", position_m, force_n, 1.0 / rate_hz))
    return found


def kinds(recordings: list[Recording]) -> list[str]:
    return [found.kind for found in check_recordings(recordings).findings]


@pytest.mark.parametrize("seed", range(20))
def test_a_snap_is_said(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    fall, at = rng.uniform(0.11, 0.3), rng.uniform(0.2, 0.5)
    rate_hz, ramp = float(rng.choice([100.0, 200.0, 1000.0])), bool(seed % 2)

    def force_of(position_m: np.ndarray, dt_s: float) -> np.ndarray:
        return dome_n(position_m, fall, at) + 20.0 * np.gradient(position_m, dt_s)

    assert kinds(recorded(force_of, seed, 0.02, rate_hz, ramp)).count("snap") == 1


def stop_n(position_m: np.ndarray, dt_s: float) -> np.ndarray:
    return 300.0 * position_m + 2e4 * np.maximum(0.0, position_m - 4e-3)


def friction_n(position_m: np.ndarray, dt_s: float) -> np.ndarray:
    moved_m = np.cumsum(np.abs(np.diff(position_m, prepend=0.0)))
    slips = 0.1 * (moved_m / 3.7e-4 % 1.0)
    return 500.0 * position_m + (0.4 + slips) * np.tanh(np.gradient(position_m, dt_s) / 1e-4)


def relaxation_n(order: float):  # type: ignore[no-untyped-def]
    def force_of(position_m: np.ndarray, dt_s: float) -> np.ndarray:
        taps = gl_taps(order, min(len(position_m), 2000), dt_s)[:, None]
        return 5.0 * position_m + 300.0 * fir_derivatives(position_m, taps)[:, 0]

    return force_of


WITHOUT = {
    "a stop": stop_n,
    "friction and slips": friction_n,
    "a soft object": lambda position_m, dt_s: soft_force(position_m),
    **{f"a springpot of {order}": relaxation_n(order) for order in (0.1, 0.2, 0.3, 0.4, 0.5)},
    "a dashpot": lambda position_m, dt_s: 100.0 * position_m + 60.0 * np.gradient(position_m, dt_s),
    "a fall of 4 %": lambda position_m, dt_s: dome_n(position_m, 0.04, 0.4),
}


@pytest.mark.parametrize("name", WITHOUT)
@pytest.mark.parametrize("ramp", [False, True])
def test_what_does_not_snap_is_not_said_to(name: str, ramp: bool) -> None:
    for seed, (noise_n, rate_hz) in enumerate(((0.02, 1000.0), (0.15, 200.0))):
        assert "snap" not in kinds(recorded(WITHOUT[name], seed, noise_n, rate_hz, ramp)), rate_hz


def test_no_snap_is_seen_in_weak_presses_by_noise_that_wanders() -> None:
    """Ramps to 0.1 N, 2 kHz, noise of 0.03 to 0.1 N that is alike for some milliseconds."""
    said = []
    for seed in range(30):
        rng = np.random.default_rng(seed)
        position_m = motion(rng.uniform(0.1, 0.4), 2000.0, True, DEPTH_M)
        noise_n, stays = rng.uniform(0.03, 0.1), rng.choice([0.5, 0.9])
        noise = rng.standard_normal(len(position_m))
        for i in range(1, len(noise)):
            noise[i] = stays * noise[i - 1] + np.sqrt(1.0 - stays**2) * noise[i]
        force_n = 0.1 * (position_m / DEPTH_M) ** 2 + noise_n * noise
        said += list(snap_findings([Recording(f"{seed}", position_m, force_n, 5e-4)]))
    assert said == []
