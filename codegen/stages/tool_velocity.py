"""Velocity of the tool, for a coupling: sp_tool_velocity.h."""

from dataclasses import dataclass

from springpot.codegen.arrays import Real
from springpot.codegen.literals import constant_text
from springpot.codegen.stages.stage import REAL, Member, SceneTicks, Stage, flushed, stage_code
from springpot.codegen.types import Scalar

TIME_S = 0.004  # of the low-pass


@dataclass(frozen=True)
class ToolVelocityStage(Stage):
    """Follows the guarded position; its value is the C variable `position_mps`."""

    rate_hz: Real
    weight: Real

    headers = ("sp_tool_velocity.h",)
    members = (Member("sp_tool_velocity_state tool_velocity", (REAL, REAL)),)

    code = stage_code("tool_velocity")

    def tables(self) -> list[str]:
        return [
            constant_text("rate_hz", self.rate_hz),
            constant_text("velocity_weight", self.weight),
        ]

    def next(self, velocity_mps: Scalar, before_m: Scalar, x: Scalar) -> Scalar:
        """sp_tool_velocity: the velocity at x, m/s, a tick after before_m."""
        difference = (x - before_m) * self.rate_hz
        return flushed(velocity_mps + self.weight * (difference - velocity_mps))


def tool_velocity_stage(ticks: SceneTicks) -> ToolVelocityStage:
    """Difference at 1/dt_s, low-passed over TIME_S by backward Euler."""
    dt_s, dtype = ticks.dt_s, ticks.dtype
    return ToolVelocityStage(rate_hz=dtype(1.0 / dt_s), weight=dtype(dt_s / (dt_s + TIME_S)))
