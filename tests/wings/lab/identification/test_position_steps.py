"""The step of a position, of what a sensor gave."""

import numpy as np
import pytest

from springpot.host.wings.lab.identification.estimate import position_step

MOTION_M = 0.01 * np.sin(np.linspace(0, 40, 8000)) + 0.0123


@pytest.mark.parametrize("step_m", [1e-6, 12.3e-6, 50e-6])
@pytest.mark.parametrize("noise_m", [0.0, 5e-6])
def test_a_step_is_found(step_m: float, noise_m: float) -> None:
    noisy_m = MOTION_M + noise_m * np.random.default_rng(0).standard_normal(len(MOTION_M))
    found = position_step(step_m * np.round(noisy_m / step_m))
    assert found.value == pytest.approx(step_m, rel=1e-4)
    assert found.low <= step_m * (1 + 1e-4)
    assert found.high >= step_m * (1 - 1e-4)


def test_no_step_is_made_up() -> None:
    smooth = position_step(MOTION_M)
    assert smooth.value is None
    assert smooth.high < 1e-5
    assert "multiples of no step" in smooth.why
    assert position_step(np.array([0.0, 1e-5, 0.0])).value is None
