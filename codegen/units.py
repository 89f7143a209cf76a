"""The C units that a plan needs, their headers, and the state each one keeps."""

from collections.abc import Callable
from dataclasses import dataclass

from springpot.codegen.plan import Plan

REAL, U32 = "real", "u32"


@dataclass(frozen=True)
class Member:
    """One member of sp_state: C declaration and the scalars in it, for the size."""

    declaration: str
    scalars: tuple[str, ...]


@dataclass(frozen=True)
class Unit:
    """One header of runtime_c/src; `needs` are headers that it includes."""

    header: str
    needs: tuple[str, ...]
    wanted: Callable[[Plan], bool]
    members: Callable[[Plan], tuple[Member, ...]] = lambda _: ()


def _history(plan: Plan) -> tuple[Member, ...]:
    length = len(plan.frac.taps)
    return (
        Member(f"sp_real history[2 * {length}]", (REAL,) * (2 * length)),
        Member("uint32_t newest", (U32,)),
    )


def _track(plan: Plan) -> tuple[Member, ...]:
    assert plan.velocity is not None
    length = len(plan.velocity.per_step) + 1
    return (
        Member(f"sp_real track[2 * {length}]", (REAL,) * (2 * length)),
        Member("uint32_t track_newest", (U32,)),
    )


UNITS = (
    Unit(
        "sp_guard.h",
        ("sp_number.h",),
        lambda _: True,
        lambda _: (Member("sp_guard_state guard", (REAL, REAL, U32, U32)),),
    ),
    Unit("sp_range.h", (), lambda _: True),
    Unit("sp_window.h", (), lambda _: True, _history),
    Unit("sp_frac.h", (), lambda _: True),
    Unit("sp_forest.h", (), lambda plan: plan.scene.runtime.forest == "table"),
    Unit("sp_contact.h", (), lambda plan: plan.contact),
    Unit("sp_velocity.h", ("sp_window.h",), lambda plan: plan.velocity is not None, _track),
    Unit(
        "sp_couple_tool.h",
        (),
        lambda plan: plan.couple_tool is not None,
        lambda _: (Member("sp_couple_tool_state couple", (REAL, REAL, U32)),),
    ),
    Unit(
        "sp_smooth.h",
        (),
        lambda plan: plan.smooth_alpha is not None,
        lambda _: (Member("sp_real smoothed_n", (REAL,)),),
    ),
    Unit(
        "sp_output.h",
        ("sp_number.h",),
        lambda _: True,
        lambda _: (Member("sp_output_state output", (REAL, REAL, REAL, U32)),),
    ),
)


def planned_units(plan: Plan) -> list[Unit]:
    """Units of this plan, in the order of a tick."""
    return [unit for unit in UNITS if unit.wanted(plan)]


def planned_headers(plan: Plan) -> list[str]:
    """Headers of the plan's units and of what they need, once each."""
    headers: dict[str, None] = {}
    for unit in planned_units(plan):
        headers.update(dict.fromkeys((*unit.needs, unit.header)))
    return list(headers)


def state_members(plan: Plan) -> list[Member]:
    """Members of sp_state, in order."""
    return [member for unit in planned_units(plan) for member in unit.members(plan)]


def state_bytes(plan: Plan) -> int:
    """Size of sp_state: the members' sizes, each padded to its own alignment."""
    sizes = {REAL: plan.dtype(0).itemsize, U32: 4}
    total = 0
    widest = 1
    for member in state_members(plan):
        align = max(sizes[scalar] for scalar in member.scalars)
        size = sum(sizes[scalar] for scalar in member.scalars)
        total = _padded(total, align) + _padded(size, align)
        widest = max(widest, align)
    return _padded(total, widest)


def _padded(size: int, align: int) -> int:
    return -(-size // align) * align
