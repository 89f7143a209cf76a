"""Cases of the closed loop that lose samples: when they lose them, and what is judged of it."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.c import golden_forces
from support.paths import C_TESTS
from support.small import scene

from springpot.codegen.coupling.linear_loop import DESIGN_HAND
from springpot.codegen.make_plan import make_plan
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.native.compiler import shared_library
from springpot.codegen.plan import Plan
from springpot.host.native.scene_library import SceneLibrary, build_and_load
from springpot.host.simulation import cases
from springpot.host.simulation.hand_loop import HandLoop
from springpot.host.stability.closed_loop import Outcome, rendered, sample_loss_outcomes
from springpot.host.stability.losses import SampleLossEffects, compare_with_lossless
from springpot.runtime_c.paths import INCLUDE

UNSAID = ("lost-1", "lost-2", "lost-10")
GOING_ON = (*UNSAID, "late", "nan-5", "rate-90")


class SilentLosses(HandLoop):
    """Its losses are kept from the scene."""

    def __init__(self, library: SceneLibrary) -> None:
        super().__init__(library)
        file = shared_library([C_TESTS / "silent_loss.c"], [INCLUDE, INCLUDE / "float"])
        self.stub = CLibrary(file, "int silent_loss(void *, float, float *);")
        self._idle = self.stub.address(self.stub.c.silent_loss)


def plan_of(mode: str) -> Plan:
    return make_plan(golden_forces.model("hammerstein"), scene(mode=mode))


@cache
def outcomes(mode: str, loop: type[HandLoop] = HandLoop) -> dict[str, Outcome]:
    plan = plan_of(mode)
    found = sample_loss_outcomes(rendered(plan, build_and_load(plan), loop), DESIGN_HAND, 0)
    return {outcome.case_name: outcome for outcome in found}


def faults(outcome: Outcome) -> tuple[str, ...]:
    return outcome.losses.faults


@pytest.mark.few(1)
@pytest.mark.parametrize("mode", ["tool", "proxy"])
def test_a_scene_that_does_not_hear_of_a_loss_kicks(mode: str) -> None:
    told, untold = outcomes(mode), outcomes(mode, SilentLosses)
    for case in GOING_ON:
        assert not faults(told[case]), case
        assert told[case].latched_s is None
    assert any(faults(untold[case]) for case in UNSAID)


@pytest.mark.few(1)
@pytest.mark.parametrize("suffix", cases.SPEEDS)
def test_rates_that_must_end_do_and_no_others(suffix: str) -> None:
    told, untold = outcomes("off"), outcomes("off", SilentLosses)
    for case in ("rate-50", "rate-10"):
        found = told[case + suffix]
        assert found.ended and found.latched_s < 0.5 and not untold[case + suffix].ended
    for case in GOING_ON:
        assert told[case + suffix].latched_s is None


@pytest.mark.parametrize("dt_s", [1e-3, 1.25e-4, 1e-2])
@pytest.mark.parametrize("cycle_s", [0.048, 0.122, 0.25])
@pytest.mark.parametrize("ticks", [1, 2, 5, 10])
def test_losses_come_at_every_phase_and_leave_time_to_make_up(
    dt_s: float, cycle_s: float, ticks: int
) -> None:
    n, cycle_ticks = round(2.0 / dt_s), cycle_s / dt_s
    lost = np.zeros(n, dtype=bool)
    lost[cases.loss_ticks(n, cycle_ticks, ticks, dt_s)] = True
    begins = np.flatnonzero(np.diff(lost.astype(np.int8)) == 1) + 1
    apart = np.diff(begins)
    assert set(apart) == {apart[0]} and lost.sum() == ticks * len(begins)
    assert ticks / (apart[0] - ticks) < 5 / 32  # sp_silence.h: good ticks make up for it
    assert apart[0] * dt_s > 0.029
    distinct = min(len(begins), round(cycle_ticks))
    assert cases.largest_phase_gap(begins, cycle_ticks) < max(2.5 / distinct, 1.01 / cycle_ticks)


def test_what_is_lost_and_at_which_rates() -> None:
    plan = plan_of("off")

    def force(position_m: np.ndarray) -> np.ndarray:
        return np.zeros_like(position_m)

    found = {
        case.name: case.scenario for case, _ in cases.sample_loss_cases(plan, force, DESIGN_HAND)
    }
    assert set(found) == set(outcomes("off")) and len(found) == 16
    for suffix in cases.SPEEDS:
        assert set(found["lost-10" + suffix].dropped) == {cases.TAKEN, cases.LOST}
        assert set(found["late" + suffix].dropped) == {cases.TAKEN, cases.LATE}
        assert np.isnan(found["nan-5" + suffix].error_m).sum() % 5 == 0
        for share in (90, 50, 10):
            taken = np.mean(found[f"rate-{share}{suffix}"].dropped == cases.TAKEN)
            assert taken == pytest.approx(share / 100, abs=0.01)


def judged_after(change: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> SampleLossEffects:
    """Losses of `lost-2`, its force changed; change takes force and ticks since the last loss."""
    plan, outcome = plan_of("off"), outcomes("off")["lost-2"]
    lost = np.flatnonzero(outcome.case.scenario.dropped == cases.LOST)
    at = np.arange(len(outcome.trace.force_n))
    since = at - lost[np.maximum(np.searchsorted(lost, at, side="right") - 1, 0)]
    force_n = change(outcome.trace.force_n.copy(), since)
    trace = replace(outcome.trace, force_n=force_n)
    return compare_with_lossless(
        plan, build_and_load(plan), outcome.case.scenario, trace, outcome.trace
    )


def test_each_property_sees_what_breaks_it() -> None:
    assert not judged_after(lambda force_n, _: force_n).faults
    held = judged_after(lambda force_n, since: np.where(since == 0, force_n + 0.1, force_n))
    assert held.faults == ("lost samples are felt as a kick",)  # it rises without a sample
    pull = judged_after(lambda force_n, since: -np.where(since == 0, force_n + 0.1, force_n))
    assert pull.growth_n == held.growth_n
    wrong = ("the force stays wrong after lost samples",)
    for ticks, change_n, seen in ((6, 1.0, True), (6, -1.0, False), (11, -1.0, True),
                                  (11, -0.4, False), (4, 1.0, False)):  # fmt: skip
        found = judged_after(
            lambda force_n, since, at=ticks, by=change_n: np.where(
                since == at, np.maximum(force_n + by, 0.0), force_n
            )
        )
        assert (found.faults == wrong) is seen, (ticks, change_n)


def test_energy_that_no_hand_paid_is_seen() -> None:
    trace = outcomes("off")["lost-2"].trace
    out = np.gradient(trace.position_m) < 0.0
    found = judged_after(lambda force_n, _: np.where(out, 1.6 * force_n, force_n))
    assert "lost samples give the hand energy" in found.faults
    as_without_a_loss = replace(found, clean_returned_j=found.returned_j)
    assert "lost samples give the hand energy" not in as_without_a_loss.faults
    assert found.returned_j > 0.01 * found.stored_j > max(found.clean_returned_j, 0.0)
