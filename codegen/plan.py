"""Plan: exactly what will be emitted of a model and a scene, and what is left out."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from springpot.codegen.arrays import Real
from springpot.codegen.coupling.auto import CouplingChoice
from springpot.codegen.coupling.gains import CoupleConfig
from springpot.codegen.coupling.loop_device import LoopDevice, build_loop_device
from springpot.codegen.coupling.object_tangent import ObjectTangent
from springpot.codegen.limits import GuardConfig, OutputConfig, SilenceConfig
from springpot.codegen.messages import short_repr
from springpot.codegen.model.model import Model
from springpot.codegen.scene import Scene
from springpot.codegen.stages.model_stages import RangeConfig, Stages
from springpot.codegen.stages.stage import (
    DOUBLE,
    REAL,
    U32,
    Member,
    RegressorStage,
    SceneTicks,
    Stage,
    round_up,
)
from springpot.codegen.stages.windows import ToolVelocityStage
from springpot.codegen.types import RealType

MAX_RECOVERY_S = 2.0


@dataclass(frozen=True)
class LeftOut:
    """One thing that the scene does not need; bytes: tables and state saved, code apart."""

    what: str
    why: str
    bytes: int


def find_unused_orders(model: Model, dtype: RealType) -> list[LeftOut]:
    """List the fractional orders that the forest never splits on: their filters are left out."""
    if model.features is None or model.regressor is None:
        return []
    features = model.features
    used = model.regressor.used_columns(features.n_features)
    orders = features.fractional_orders
    unused = [order for i, order in enumerate(orders) if i not in set(used.tolist())]
    if not unused:
        return []
    vector_width = round_up(len(orders)) - round_up(max(len(used), 1))
    names = ", ".join(f"{order:g}" for order in unused)
    saved = vector_width * features.table_rows * np.dtype(dtype).itemsize
    return [LeftOut(f"orders {names}", "no split uses them", saved)]


def find_left_out_units(
    scene: Scene, ticks: SceneTicks, coupled: bool, alpha: float | None
) -> list[LeftOut]:
    """List the units of the runtime that the scene does without."""
    size = np.dtype(ticks.dtype).itemsize
    units = (
        (ticks.surface, "contact and onset", "the recordings never leave the object", size),
        # stiffness, damping, compliance, dt, phi; proxy's position, velocity, flag
        (coupled, "coupling", "coupling.mode is off", 8 * size + 2 * size + 4),
        (coupled, "velocity estimate", "nothing in this scene needs a velocity", 4 * size),
        (alpha is not None, "smoothing", "smoothing.time_constant_s is 0", 2 * size),
    )
    return [LeftOut(what, why, saved) for present, what, why, saved in units if not present]


@dataclass(frozen=True, eq=False)
class Plan(Stages):
    """Everything the emitted C contains. Fields that are None are units left out.

    chose_rate: whether it ticks at a rate that neither the scene nor the recordings state.
    """

    scene: Scene
    model: Model
    real: Literal["float", "double"]
    dt_s: float
    guard: GuardConfig
    range: RangeConfig
    onset_per_m: Real | None
    fade_per_m: Real | None
    velocity: ToolVelocityStage | None
    couple: CoupleConfig | None
    at_proxy: bool
    smooth_alpha: Real | None
    output: OutputConfig
    silence: SilenceConfig
    watchdog_s: float
    left_out: tuple[LeftOut, ...]
    accept_unsafe: bool
    stiffness_npm: float
    tangent: ObjectTangent
    coupling: CouplingChoice
    outside: str
    chose_rate: bool = False
    __repr__ = short_repr

    @property
    def dtype(self) -> RealType:
        """Numpy type of sp_real."""
        return np.float32 if self.real == "float" else np.float64

    @property
    def recovery_ticks(self) -> int:
        """Ticks of good input after which bad input is forgotten, to 2 % of the maximum force.

        The guard's resynchronisation, the ramp, and the longest memory: a window's length, or four
        time constants of a pole (none longer than MAX_RECOVERY_S counts: an object that creeps for
        minutes has rightly rested elsewhere).
        """
        ramp = round(1.0 / float(self.output.ramp_per_tick))
        model = self.model
        passive_s = 0.0 if model.hammerstein is None else 4.0 * model.hammerstein.memory_s
        features_s = 0.0 if model.features is None else model.features.settling_s(self.dt_s)
        longest_s = min(max(features_s, passive_s), MAX_RECOVERY_S)
        return self.guard.resync_ticks + ramp + round(longest_s / self.dt_s)

    @property
    def loop_device(self) -> LoopDevice:
        """The device that checks assume: the scene's."""
        return build_loop_device(self.scene.device, self.dt_s)

    @property
    def has_places(self) -> bool:
        """True if the object differs from site to site: the C has sp_place then."""
        return self.passive is not None and self.passive.placed is not None

    @property
    def draws_pictures(self) -> bool:
        """True if a game may call the C: it has sp_advance then. No board's has."""
        return self.scene.runtime.target == "host"

    @property
    def max_force_n(self) -> float:
        """Largest force that leaves, in either direction, N."""
        return max(float(self.output.max_n), -float(self.output.min_n))

    @property
    def contact(self) -> bool:
        """True if positions at or below 0 are free air."""
        return self.onset_per_m is not None


def list_stages(plan: Plan) -> list[Stage]:
    """Stages that keep a state, in the order of a tick."""
    excess = plan.excess or (None, None)
    ordered: tuple[Stage | None, ...] = (plan.features, plan.passive, *excess, plan.velocity)
    return [stage for stage in ordered if stage is not None]


def list_headers(plan: Plan) -> list[str]:
    """Headers of the plan's units and those that they need, once each, in the order of a tick."""
    parts: list[Stage | RegressorStage] = [*list_stages(plan)]
    if plan.regressor is not None:
        parts.append(plan.regressor)
    headers = ["sp_number.h", "sp_silence.h", "sp_guard.h", "sp_range.h"]
    headers += [header for part in parts for header in part.headers]
    headers += ["sp_contact.h"] if plan.contact else []
    headers += ["sp_couple.h"] if plan.couple is not None else []
    headers += ["sp_smooth.h"] if plan.smooth_alpha is not None else []
    return list(dict.fromkeys([*headers, "sp_output.h"]))


def list_state_members(plan: Plan) -> list[Member]:
    """Members of sp_state, in order."""
    members = [
        Member("uint32_t begun", (U32,)),
        Member("sp_silence_state silence", (REAL, REAL, U32)),
        Member("sp_guard_state guard", (REAL, REAL, U32, U32)),
    ]
    if plan.draws_pictures:
        members.append(Member("sp_real remainder_s", (REAL,)))
    members += [member for stage in list_stages(plan) for member in stage.members]
    if plan.regressor is not None:
        members += plan.regressor.members
    if plan.couple is not None:
        members.append(Member("sp_couple_state couple", (REAL, REAL, U32)))
    if plan.smooth_alpha is not None:
        members.append(Member("sp_real smoothed_n", (REAL,)))
    return [*members, Member("sp_output_state output", (REAL, REAL))]


def state_bytes(plan: Plan) -> int:
    """Size of sp_state: the members' sizes, each padded to its own alignment."""
    return _compute_layout(plan)[1]


def member_offset(plan: Plan, name: str) -> int:
    """Offset of the member `name` in sp_state, bytes. Raises KeyError."""
    return _compute_layout(plan)[0][name]


def _compute_layout(plan: Plan) -> tuple[dict[str, int], int]:
    """Return the offset of each member of sp_state, and its size, bytes, as a C compiler aligns."""
    sizes = {REAL: plan.dtype(0).itemsize, U32: 4, DOUBLE: 8}
    offsets = {}
    total, widest = 0, 1
    for member in list_state_members(plan):
        align = max(sizes[scalar] for scalar in member.scalars)
        size = sum(sizes[scalar] for scalar in member.scalars)
        total = round_up(total, align)
        offsets[member.declaration.split()[-1].split("[")[0]] = total
        total += round_up(size, align)
        widest = max(widest, align)
    return offsets, round_up(total, widest)
