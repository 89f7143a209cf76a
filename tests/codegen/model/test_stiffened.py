"""A model of an object so many times stiffer: its force at x is that of the model at factor x."""

from dataclasses import replace

import numpy as np
import pytest
from support.small import DEPTH_M, VARIANTS, fitted, press, scene

from springpot import Model
from springpot.codegen.make_plan import make_plan
from springpot.codegen.scene import Guard
from springpot.host.native.scene_library import built

POWER_OF_TWO = 8.0  # exact, so that every decision is the same


def forces(model: Model, *motions_m: np.ndarray) -> list[np.ndarray]:
    asked = replace(scene(), guard=Guard(outside="fallback"))
    plan = make_plan(model, asked, accept_unsafe=True)
    library = built(plan)
    return [library.new_state().run(x, np.zeros_like(x))[0] for x in motions_m]


@pytest.mark.few(1)
@pytest.mark.parametrize("variant", VARIANTS)
def test_the_emitted_force_of_the_stiffened_model_is_the_models_at_factor_x(variant: str) -> None:
    model = fitted(variant)
    motion = np.concatenate([press(2.0, 0.8 * DEPTH_M), press(4.0, 1.1 * DEPTH_M)])
    soft, wrong = forces(model, motion, motion / POWER_OF_TWO)
    (stiff,) = forces(model.stiffened(POWER_OF_TWO), motion / POWER_OF_TWO)
    assert soft.max() > 1.0
    np.testing.assert_allclose(stiff, soft, rtol=1e-5, atol=2e-6 * soft.max())
    assert np.abs(wrong - soft).max() > 0.2 * soft.max()
