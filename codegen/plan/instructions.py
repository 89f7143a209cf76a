"""Bound of the instructions of one tick, from the tables: what a budget is checked against.

A tick that restarts (the first one, and one that takes a new position as true) fills the memory
besides; the first after a silence is all the ticks without a sample too.
"""

from dataclasses import dataclass

from springpot.codegen.plan.plan import Plan
from springpot.codegen.plan.units import stages
from springpot.codegen.stages.costs import COSTS

_MAKE_UP = 60.0  # beside its ticks


@dataclass(frozen=True)
class InstructionBound:
    """Instructions of sp_step. tick: after a tick with a sample; after_silence: the longest."""

    tick: int
    restart: int
    after_silence: int


def instruction_bound(plan: Plan) -> InstructionBound | None:
    """Bound for the plan's target; None for a PC, doubles in software, nested ifs, three axes."""
    costs = COSTS.get(plan.scene.runtime.target)
    if costs is None or plan.real == "double" or plan.lateral is not None:
        return None
    regressor = 0.0 if plan.regressor is None else plan.regressor.instructions(costs)
    if regressor is None:
        return None
    passive = sum(
        stage.instructions(costs) for stage in (plan.passive, *(plan.excess or ())) if stage
    )
    coupling = costs.coupling if plan.couple is not None else 0.0
    energy = costs.energy if plan.energy is not None else 0.0
    features = 0.0 if plan.features is None else plan.features.instructions(costs)
    tick = costs.tick + coupling + energy + features + regressor + passive
    forget = sum(stage.restart_instructions(costs) for stage in stages(plan))
    longest = 1 + round(plan.watchdog_s / plan.dt_s)
    return InstructionBound(
        tick=round(tick),
        restart=round(tick + forget),
        after_silence=round(longest * tick + _MAKE_UP),
    )
