"""Cases of the closed loop that lose samples: what they lose, and that they see a kick."""

from contextlib import ExitStack
from typing import Any

import numpy as np
import pytest
from support.c import golden_forces
from support.paths import C_TESTS
from support.small import scene

from springpot.codegen.coupling.linear_loop import DESIGN_HAND
from springpot.codegen.plan.plan import Plan, make_plan
from springpot.host.native.c_library import CLibrary
from springpot.host.native.compiler import shared_library
from springpot.host.native.trial_build import built, uncoupled
from springpot.host.simulation.hand_loop import HandLoop
from springpot.host.simulation.losses import LATE, LOST, losing_cases
from springpot.host.stability.closed_loop import Outcome, Rendered, lossy_outcomes
from springpot.runtime_c.paths import INCLUDE

UNSAID = ("lost-1", "lost-2", "lost-10")


class SilentLosses(HandLoop):
    """Its losses are kept from the scene."""

    def _scene(self) -> tuple[Any, Any]:
        pointers, state = super()._scene()
        file = shared_library([C_TESTS / "silent_loss.c"], [INCLUDE, INCLUDE / "float"])
        stub = CLibrary(file, "int silent_loss(void *, float, float *);")
        pointers.idle = self._port.pointer(stub.address(stub.c.silent_loss))
        return pointers, (state, stub)


def rendered(plan: Plan, loop: type[HandLoop], stack: ExitStack) -> Rendered:
    library = stack.enter_context(built(plan))
    model = stack.enter_context(built(uncoupled(plan)))
    return Rendered(plan, loop(library), library, model)


def outcomes(mode: str, loop: type[HandLoop]) -> dict[str, Outcome]:
    plan = make_plan(golden_forces.model("hammerstein"), scene(mode=mode))
    with ExitStack() as stack:
        found = list(lossy_outcomes(rendered(plan, loop, stack), DESIGN_HAND, 0))
    return {outcome.case: outcome for outcome in found}


@pytest.mark.parametrize("mode", ["tool", "proxy"])
def test_a_scene_that_does_not_hear_of_a_loss_kicks(mode: str) -> None:
    told, untold = outcomes(mode, HandLoop), outcomes(mode, SilentLosses)
    for case in UNSAID:
        assert told[case].losses is not None and untold[case].losses is not None
        assert not told[case].losses.kicks
    assert any(untold[case].losses.kicks for case in UNSAID)  # type: ignore[union-attr]


def test_losses_fall_on_the_fastest_part_of_every_stroke() -> None:
    plan = make_plan(golden_forces.model("hammerstein"), scene())

    def force(position_m: np.ndarray) -> np.ndarray:
        return np.zeros_like(position_m)

    found = {case.name: case for case, _ in losing_cases(plan, force, DESIGN_HAND)}
    felt = outcomes("off", HandLoop)
    assert set(found) == set(felt) and len(found) == 16
    for name, what in (("lost-1", LOST), ("lost-10", LOST), ("late", LATE)):
        for suffix in ("", "-fast"):
            at = np.flatnonzero(found[name + suffix].scenario.dropped == what)
            speed = np.abs(felt[name + suffix].trace.velocity_mps)
            assert len(at) >= 6
            assert speed[at].min() > 0.6 * np.quantile(speed, 0.95), name
    for share in (90, 50, 10):
        taken = np.mean(found[f"rate-{share}"].scenario.dropped == 0)
        assert taken == pytest.approx(share / 100, abs=0.01)
