"""What drove the paper to fractional derivatives: a forest on past positions gives energy back."""

from dataclasses import dataclass

from springpot import Model, Scene
from springpot.codegen.coupling.linear_loop import HAND_MODELS
from springpot.codegen.plan.make_plan import make_plan
from springpot.host.native.trial_build import built
from springpot.host.simulation.cases import cases
from springpot.host.simulation.hand_loop import HandLoop
from springpot.host.stability.closed_loop import MORE_DELAY, Rendered, case_outcome
from springpot.host.stability.judgement import judge
from springpot.host.stability.small_signal import small_signal_map

CONTROL = "rf-history"
_HOLD = "hold"
_TAPS = ("tap-4hz", "tap-8hz")


@dataclass(frozen=True)
class HandledModel:
    """A model under small presses and in three simulated hands, without a coupling.

    active_cells, cells: of its small-signal map. tap_energy_out_j: what a hand got out of 3 s of
    taps without a delay, the most of all hands and rates; below 0, taps cost energy. hold_mps: the
    fastest vibration of a tool that is held. unsteady: cases that vibrate or leave their bounds.
    """

    active_cells: int
    cells: int
    worst_sin_delta: float
    tap_energy_out_j: float
    hold_mps: float
    unsteady: int


def handled(model: Model, scene: Scene) -> HandledModel:
    """Map and closed loop of a model in a scene without a coupling."""
    plan = make_plan(model, scene, accept_unsafe=True)
    with built(plan) as library:
        small = small_signal_map(plan, library, 0).as_dict()
        rendered = Rendered(plan, HandLoop(library), library, library)
        outcomes = [
            case_outcome(rendered, case, hand, more_delay)
            for hand in HAND_MODELS
            for case in cases(plan, rendered.force, hand)
            if case.name in (_HOLD, *_TAPS)
            for more_delay in MORE_DELAY
        ]
    judged = [judge(outcome) for outcome in outcomes]
    return HandledModel(
        active_cells=int(small["active_cells"]),
        cells=int(small["cells"]),
        worst_sin_delta=float(small["worst_sin_delta"]),
        tap_energy_out_j=max(
            item.energy_out_j for item in outcomes if item.case in _TAPS and not item.late
        ),
        hold_mps=max(item.hf_speed_mps for item in outcomes if item.case == _HOLD),
        unsteady=sum(item.unbounded or item.loud for item in judged),
    )
