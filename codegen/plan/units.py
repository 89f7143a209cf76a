"""Headers of a plan's units, and the members of sp_state.

And the bound of the instructions of one tick, which a budget is checked against: a tick that
restarts (the first one, and one that takes a new position as true) fills the memory besides; the
first after a silence is all the ticks without a sample too.
"""

from dataclasses import dataclass

from springpot.codegen.plan.plan import Plan
from springpot.codegen.stages.costs import COSTS
from springpot.codegen.stages.stage import (
    DOUBLE,
    REAL,
    U32,
    Member,
    RegressorStage,
    Stage,
    padded,
)

_MAKE_UP = 60.0  # beside its ticks


def stages(plan: Plan) -> list[Stage]:
    """Stages that keep a state, in the order of a tick."""
    excess = plan.excess or (None, None)
    found: tuple[Stage | None, ...] = (plan.features, plan.passive, *excess, plan.velocity)
    return [stage for stage in found if stage is not None]


def planned_headers(plan: Plan) -> list[str]:
    """Headers of the plan's units and of what they need, once each, in the order of a tick."""
    parts: list[Stage | RegressorStage] = [*stages(plan)]
    if plan.regressor is not None:
        parts.append(plan.regressor)
    headers = ["sp_number.h", "sp_silence.h", "sp_guard.h", "sp_range.h"]
    headers += ["sp_guard_velocity.h"] if plan.needs_device_velocity else []
    headers += [header for part in parts for header in part.headers]
    headers += ["sp_contact.h"] if plan.contact else []
    headers += ["sp_couple.h"] if plan.couple is not None else []
    headers += ["sp_smooth.h"] if plan.smooth_alpha is not None else []
    return list(dict.fromkeys([*headers, "sp_output.h"]))


def state_members(plan: Plan) -> list[Member]:
    """Members of sp_state, in order."""
    members = [
        Member("uint32_t begun", (U32,)),
        Member("sp_silence_state silence", (REAL, REAL, U32)),
        Member("sp_guard_state guard", (REAL, REAL, U32, U32)),
    ]
    members += [member for stage in stages(plan) for member in stage.members]
    if plan.regressor is not None:
        members += plan.regressor.members
    if plan.couple is not None:
        members.append(Member("sp_couple_state couple", (REAL, REAL, U32)))
    if plan.smooth_alpha is not None:
        members.append(Member("sp_real smoothed_n", (REAL,)))
    return [*members, Member("sp_output_state output", (REAL, REAL, REAL))]


def state_bytes(plan: Plan) -> int:
    """Size of sp_state: the members' sizes, each padded to its own alignment."""
    return _layout(plan)[1]


def member_offset(plan: Plan, name: str) -> int:
    """Offset of the member `name` in sp_state, bytes. Raises KeyError."""
    return _layout(plan)[0][name]


def _layout(plan: Plan) -> tuple[dict[str, int], int]:
    sizes = {REAL: plan.dtype(0).itemsize, U32: 4, DOUBLE: 8}
    offsets = {}
    total = 0
    widest = 1
    for member in state_members(plan):
        align = max(sizes[scalar] for scalar in member.scalars)
        size = sum(sizes[scalar] for scalar in member.scalars)
        total = padded(total, align)
        offsets[member.declaration.split()[-1].split("[")[0]] = total
        total += padded(size, align)
        widest = max(widest, align)
    return offsets, padded(total, widest)


@dataclass(frozen=True)
class InstructionBound:
    """Instructions of sp_step. tick: after a tick with a sample; after_silence: the longest."""

    tick: int
    restart: int
    after_silence: int


def instruction_bound(plan: Plan) -> InstructionBound | None:
    """Bound for the plan's target; None for a PC, doubles in software, nested ifs."""
    costs = COSTS.get(plan.scene.runtime.target)
    if costs is None or plan.real == "double":
        return None
    regressor = 0.0 if plan.regressor is None else plan.regressor.instructions(costs)
    if regressor is None:
        return None
    passive = sum(
        stage.instructions(costs) for stage in (plan.passive, *(plan.excess or ())) if stage
    )
    coupling = costs.coupling if plan.couple is not None else 0.0
    features = 0.0 if plan.features is None else plan.features.instructions(costs)
    tick = costs.tick + coupling + features + regressor + passive
    forget = sum(stage.restart_instructions(costs) for stage in stages(plan))
    longest = 1 + round(plan.watchdog_s / plan.dt_s)
    return InstructionBound(
        tick=round(tick),
        restart=round(tick + forget),
        after_silence=round(longest * tick + _MAKE_UP),
    )
