"""The force of a hand that rests on the object: noise of the encoder must not tear it.

An account of energy once did: each step of noise costs a spring in ticks K dx^2/2, so that a
balance that only sinks ended at 0 after minutes, and cut the force from then on.
"""

import numpy as np
import pytest
from support.c import golden_forces
from support.small import scene

from springpot.codegen.make_plan import make_plan
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import build_and_load

ENCODER_M = 10e-6
PRESS_TICKS = 500


def resting(depth_m: float, noise_steps: int, ticks: int) -> np.ndarray:
    """Press for half a second, then hold; position by an encoder whose noise is some steps, m."""
    rng = np.random.default_rng(noise_steps)
    hold_m = depth_m + ENCODER_M * rng.integers(-noise_steps, noise_steps, ticks, endpoint=True)
    press_m = depth_m * (1.0 - np.cos(np.linspace(0.0, np.pi, PRESS_TICKS))) / 2.0
    return np.concatenate([press_m, ENCODER_M * np.round(hold_m / ENCODER_M)])


@pytest.mark.parametrize("noise_steps", [1, 2, 4])
@pytest.mark.parametrize(
    "ticks", [400_000, pytest.param(1_800_000, marks=pytest.mark.slow)], ids=["7 min", "30 min"]
)
def test_noise_of_an_encoder_moves_a_resting_force_as_the_model_says(
    noise_steps: int, ticks: int
) -> None:
    """All that stands between model and hand changes nothing: the bits are the model's."""
    plan = make_plan(golden_forces.model("hammerstein"), scene())
    position_m = resting(0.6 * plan.model.trained.max_m, noise_steps, ticks).astype(plan.dtype)
    force_n, notes = Replay(build_and_load(plan)).run(position_m, np.zeros_like(position_m))
    settled_n, slope_npm = force_n[PRESS_TICKS + 50_000 :], plan.stiffness_npm
    assert not notes[PRESS_TICKS:].any()
    step_n = np.abs(np.diff(settled_n)).max()
    assert 0.0 < step_n <= 1.1 * slope_npm * 2 * noise_steps * ENCODER_M
