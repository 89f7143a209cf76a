import dataclasses

import numpy as np
import pytest
from support.small import DEPTH_M, scene, small_model, training

from springpot import Scene
from springpot.codegen.emit.files import emit_files
from springpot.codegen.errors import UnsafeError, UsageError
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.scene import Coupling, Guard, Runtime
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions

SCENE = Scene(schema=1, name="x", model="x")


def changed(**sections: object) -> Scene:
    return dataclasses.replace(SCENE, **sections)


def test_defaults_come_from_the_model() -> None:
    plan = make_plan(small_model(), SCENE)
    trained = small_model().trained
    assert plan.output.max_n == np.float32(1.2 * trained.max_n)
    assert plan.watchdog_s == np.float32(0.02)
    assert plan.per_onset == pytest.approx(1 / (0.01 * DEPTH_M), rel=1e-2)
    assert plan.guard.jump_m >= np.float32(1e-3)
    assert plan.coupling.why.startswith("off: auto")
    assert plan.outside.startswith("fallback: ")


def test_a_model_that_never_leaves_the_object_has_no_contact() -> None:
    model = dataclasses.replace(small_model(), contact="always")
    plan = make_plan(model, SCENE)
    assert plan.per_onset is None
    assert "contact and onset" in [item.what for item in plan.left_out]
    assert make_plan(model, changed(guard=Guard(contact="surface"))).per_onset is not None


@pytest.mark.slow
def test_unused_orders_are_dropped_with_their_bytes() -> None:
    model = small_model()
    forest = dataclasses.replace(
        model.regressor, feature=np.where(model.regressor.feature > 1, 1, model.regressor.feature)
    )
    plan = make_plan(dataclasses.replace(model, regressor=forest), SCENE)
    assert plan.features.orders == (0.05, 0.1)
    assert plan.features.taps.shape == (2, 176)
    dropped = next(item for item in plan.left_out if item.what.startswith("orders"))
    assert dropped.bytes == (12 - 4) * 171 * 4


def test_what_cannot_be_done_is_refused() -> None:
    with pytest.raises(UsageError, match=r"runtime\.rate_hz = 500"):
        make_plan(small_model(), changed(runtime=Runtime(rate_hz=500)))
    unit_error = changed(coupling=Coupling(mode="tool", damping_nspm=2e4))
    with pytest.raises(UnsafeError, match="20 N s/m"):
        make_plan(small_model(), unit_error)
    assert make_plan(small_model(), unit_error, accept_unsafe=True).accept_unsafe


@pytest.mark.slow
def test_large_forests_are_not_for_m2cgen() -> None:
    large = fit_model("rf-fd", "large", training(), FitOptions(trees=30, leaf=2)).model
    with pytest.raises(UsageError, match='use "table"'):
        emit_files(make_plan(large, scene(forest="m2cgen")))
