"""Cycles are found behind an approach and before a retreat, as rigs make them."""

from itertools import product

import numpy as np
import pytest

from springpot.trainer.recordings.quality.cycles import find_cycles
from springpot.trainer.recordings.recording import Recording

APPROACH_M = 1.5e-3


def behind_an_approach(
    hz: float, share: float, cycles: int, wait_s: float, back: bool
) -> Recording:
    """A ramp, a rest at depth, cycles about it (or up to it, without a rest), a retreat."""
    dt_s = 1.0 / max(100.0, 40.0 * hz)
    to = np.linspace(0.0, APPROACH_M, round(1.5 / dt_s))
    phase = 2 * np.pi * hz * np.arange(0, cycles / hz, dt_s)
    about = np.sin(phase) if wait_s else np.cos(phase) - 1.0
    parts = [to, np.full(round(wait_s / dt_s), APPROACH_M), APPROACH_M * (1 + share / 2 * about)]
    if back:
        parts.append(np.linspace(parts[-1][-1], -5e-4, round(2.0 / dt_s)))
    noise = np.random.default_rng(1)
    position_m = np.concatenate(parts)
    position_m = position_m + noise.normal(0, 1e-6, len(position_m))
    force_n = 3000 * np.maximum(position_m, 0.0) + 10 * np.gradient(position_m, dt_s)
    return Recording("x", position_m, force_n + noise.normal(0, 4e-3, len(force_n)), dt_s)


@pytest.mark.parametrize("hz", [0.1, 0.3, 1.0, 3.0, 10.0])
def test_cycles_are_found_behind_an_approach(hz: float) -> None:
    for share, cycles, wait_s, back in product(
        (0.07, 0.2, 0.7), (6, 30), (0, 1, 20), (False, True)
    ):
        found = find_cycles(behind_an_approach(hz, share, cycles, wait_s, back))
        assert found is not None, (share, cycles, wait_s, back)
        assert found.frequency_hz == pytest.approx(hz, rel=0.02), (share, cycles, wait_s, back)
        assert found.stiffness_npm == pytest.approx(abs(3000 + 20j * np.pi * hz), rel=0.02)
