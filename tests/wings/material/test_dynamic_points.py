"""Moduli that recordings show: of sines and triangles, and not of ramps with holds."""

import numpy as np
import pytest

from springpot.host.wings.material.law.identifiability import _dynamic_points
from springpot.trainer.recordings.recording import Recording

STEP_S, STIFFNESS_NPM, SHARE, TAU_S = 0.02, 2000.0, 0.5, 3.0


def solid(position_m: np.ndarray) -> Recording:
    """A standard linear solid along a path."""
    kept, branch_n, force_n = np.exp(-STEP_S / TAU_S), 0.0, []
    elastic_n = STIFFNESS_NPM * position_m
    for change_n in np.diff(elastic_n, prepend=0.0):
        branch_n = kept * branch_n + SHARE * change_n
        force_n.append(branch_n)
    return Recording("solid", position_m, elastic_n + force_n, STEP_S)


def modulus_npm(frequency_hz: float) -> complex:
    turn = 2j * np.pi * frequency_hz * TAU_S
    return STIFFNESS_NPM * (1.0 + SHARE * turn / (1.0 + turn))


@pytest.mark.parametrize("seed", range(12))
def test_what_ramps_and_holds_lose_is_no_modulus(seed: int) -> None:
    rng = np.random.default_rng(seed)
    levels_mm = np.repeat(np.r_[0.0, rng.uniform(0.3, 2.0, rng.integers(1, 4)), 0.0], 2)
    times_s = np.cumsum(np.r_[0.0, rng.uniform(0.5, 30.0, len(levels_mm) - 1)])
    path_m = 1e-3 * np.interp(np.arange(0.0, times_s[-1], STEP_S), times_s, levels_mm)
    for point in _dynamic_points([solid(path_m)]):
        truth = modulus_npm(point["frequency_hz"])
        assert abs(complex(point["storage_npm"], point["loss_npm"]) - truth) < 0.15 * abs(truth)


@pytest.mark.parametrize("frequency_hz", [0.05, 0.3, 1.1])
def test_what_a_sine_shows_is_quoted(frequency_hz: float) -> None:
    turns = 2.0 * np.pi * frequency_hz * np.arange(0.0, 8.0 / frequency_hz, STEP_S)
    (point,) = _dynamic_points([solid(0.5e-3 * (1.0 - np.cos(turns)))])
    truth = modulus_npm(frequency_hz)
    assert point["storage_npm"] == pytest.approx(truth.real, rel=0.02)
    assert point["loss_npm"] == pytest.approx(truth.imag, rel=0.05)
