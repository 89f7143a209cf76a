"""A model of an object so many times stiffer: its force at x is that of the model at factor x."""

from dataclasses import replace

import numpy as np
import pytest
from support.small import DEPTH_M, press, scene, training

from springpot import Model
from springpot.codegen.make_plan import make_plan
from springpot.codegen.scene import Guard
from springpot.host.native.scene_library import built
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions

POWER_OF_TWO = 8.0  # exact, so that every decision is the same
OPTIONS = FitOptions(trees=4, leaf=20, n_centers=20, poles=4)
KINDS = {
    "fir": ("rf-fd", OPTIONS),
    "fir quantised": ("rf-fd", replace(OPTIONS, round_features=True)),
    "fir-fast": ("rf-fd", replace(OPTIONS, engine="fir-fast")),
    "fir-fast quantised": ("rf-fd", replace(OPTIONS, engine="fir-fast", round_features=True)),
    "recursive": ("rf-fd", replace(OPTIONS, engine="recursive")),
    "recursive quantised": ("rf-fd", replace(OPTIONS, engine="recursive", round_features=True)),
    "lags": ("rf-fd", replace(OPTIONS, past_positions=True)),
    "lags quantised": ("rf-fd", replace(OPTIONS, past_positions=True, round_features=True)),
    "rbf": ("rbf-fd", OPTIONS),
    "rbf fir-fast": ("rbf-fd", replace(OPTIONS, engine="fir-fast")),
    "position and velocity": ("rbf-pv", OPTIONS),
    "passive": ("hammerstein", OPTIONS),
    "springpot": ("springpot", OPTIONS),
}


def forces(model: Model, *motions_m: np.ndarray) -> list[np.ndarray]:
    asked = replace(scene(), guard=Guard(outside="fallback"))
    plan = make_plan(model, asked, accept_unsafe=True)
    library = built(plan)
    return [library.new_state().run(x, np.zeros_like(x))[0] for x in motions_m]


@pytest.mark.few(1)
@pytest.mark.parametrize("what", KINDS)
def test_the_emitted_force_of_the_stiffened_model_is_the_models_at_factor_x(what: str) -> None:
    kind, options = KINDS[what]
    model = fit_model(kind, "x", training(), options).model
    motion = np.concatenate([press(2.0, 0.8 * DEPTH_M), press(4.0, 1.1 * DEPTH_M)])
    soft, wrong = forces(model, motion, motion / POWER_OF_TWO)
    (stiff,) = forces(model.stiffened(POWER_OF_TWO), motion / POWER_OF_TWO)
    assert soft.max() > 1.0
    np.testing.assert_allclose(stiff, soft, rtol=1e-5, atol=2e-6 * soft.max())
    assert np.abs(wrong - soft).max() > 0.2 * soft.max()
