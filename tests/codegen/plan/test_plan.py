import dataclasses

import numpy as np
import pytest
from support.small import DEPTH_M, small_model

from springpot import Scene
from springpot.codegen.errors import UnsafeError, UsageError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.scene import Coupling, Guard, Runtime

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


def test_what_cannot_be_done_is_refused() -> None:
    with pytest.raises(UsageError, match=r"runtime\.rate_hz = 500"):
        make_plan(small_model(), changed(runtime=Runtime(rate_hz=500)))
    unit_error = changed(coupling=Coupling(mode="tool", damping_nspm=2e4))
    with pytest.raises(UnsafeError, match="20 N s/m"):
        make_plan(small_model(), unit_error)
    assert make_plan(small_model(), unit_error, accept_unsafe=True).accept_unsafe
