"""Plan: exactly what will be emitted of a model and a scene, and what is left out."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from springpot.codegen.arrays import Real
from springpot.codegen.coupling.auto import CouplingChoice
from springpot.codegen.coupling.gains import CoupleConfig
from springpot.codegen.coupling.loop_device import LoopDevice, loop_device
from springpot.codegen.model.model import Model
from springpot.codegen.plan.left_out import LeftOut
from springpot.codegen.plan.limits import GuardConfig, OutputConfig, SilenceConfig
from springpot.codegen.scene import Scene
from springpot.codegen.short_repr import short_repr
from springpot.codegen.stages.model_force import RangeConfig, Stages
from springpot.codegen.stages.tool_velocity import ToolVelocityStage
from springpot.codegen.types import RealType

MAX_RECOVERY_S = 2.0


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
    per_onset: Real | None
    per_fade: Real | None
    velocity: ToolVelocityStage | None
    couple: CoupleConfig | None
    at_proxy: bool
    max_mps: Real
    smooth_alpha: Real | None
    output: OutputConfig
    silence: SilenceConfig
    watchdog_s: float
    left_out: tuple[LeftOut, ...]
    accept_unsafe: bool
    stiffness_npm: float
    coupling: CouplingChoice
    outside: str
    chose_rate: bool = False
    __repr__ = short_repr

    @property
    def dtype(self) -> RealType:
        """Numpy type of sp_real."""
        return np.float32 if self.real == "float" else np.float64

    @property
    def needs_device_velocity(self) -> bool:
        """Whether sp_step reads its velocity argument."""
        return self.couple is not None and self.velocity is None

    @property
    def recovery_ticks(self) -> int:
        """Ticks of good input after which bad input is forgotten, to 2 % of the maximum force.

        The guard's resynchronisation, the ramp, and the longest memory: a window's length, or four
        time constants of a pole (none longer than MAX_RECOVERY_S counts: an object that creeps for
        minutes has rightly rested elsewhere).
        """
        ramp = round(1.0 / float(self.output.rise))
        model = self.model
        passive_s = 0.0 if model.hammerstein is None else 4.0 * model.hammerstein.memory_s
        features_s = 0.0 if model.features is None else model.features.settling_s(self.dt_s)
        longest_s = min(max(features_s, passive_s), MAX_RECOVERY_S)
        return self.guard.resync_ticks + ramp + round(longest_s / self.dt_s)

    @property
    def loop_device(self) -> LoopDevice:
        """The device that checks assume: the scene's."""
        return loop_device(self.scene.device, self.dt_s)

    @property
    def has_places(self) -> bool:
        """Whether the object is not the same everywhere: there is sp_place then."""
        return self.passive is not None and self.passive.placed is not None

    @property
    def max_force_n(self) -> float:
        """Largest force that leaves, in either direction, N."""
        return max(float(self.output.max_n), -float(self.output.min_n))

    @property
    def contact(self) -> bool:
        """Whether positions at or below 0 are free air."""
        return self.per_onset is not None
