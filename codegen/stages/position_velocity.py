"""Depth and its velocity by first-order adaptive windowing: sp_window.h and sp_velocity.h."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from springpot.codegen.arrays import Real, Reals
from springpot.codegen.literals import array_text, constant_text
from springpot.codegen.model.features import PositionVelocity
from springpot.codegen.model.formulas import foaw
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.stage import (
    REAL,
    U32,
    Columns,
    FeatureStage,
    Member,
    Starts,
    feature_stage,
    held_before,
    stage_code,
)
from springpot.codegen.types import RealType


@dataclass(frozen=True, eq=False)
class PositionVelocityStage(FeatureStage):
    """Features: depth, velocity of the depth. per_step: shape (length,), 1/s."""

    per_step: Reals
    band_m: Real

    n_features = 2
    headers = ("sp_window.h", "sp_velocity.h")

    code = stage_code("position_velocity")

    @property
    def members(self) -> tuple[Member, ...]:
        """The window, twice so that its samples are contiguous, and where it begins."""
        length = len(self.per_step) + 1
        return (
            Member(f"sp_real clipped_track[2 * {length}]", (REAL,) * (2 * length)),
            Member("uint32_t clipped_newest", (U32,)),
        )

    def tables(self) -> list[str]:
        return [
            f"enum {{\n    N_CLIPPED_STEPS = {len(self.per_step)}\n}};",
            array_text("clipped_per_step", "sp_real", self.per_step),
            constant_text("clipped_band_m", self.band_m),
        ]

    def instructions(self, costs: Costs) -> float:
        return float(len(self.per_step) * costs.velocity_step + 60.0)

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        length = len(self.per_step)
        velocity = np.zeros_like(depth)
        for rows, samples in held_before(depth, starts, length):
            windows = sliding_window_view(samples, length + 1)
            velocity[rows] = foaw(self.per_step, self.band_m, windows)
        return np.stack([depth, velocity], axis=1)


@feature_stage.register
def position_velocity_stage(
    features: PositionVelocity, kept: Columns, dt_s: float, dtype: RealType
) -> PositionVelocityStage:
    """Depth and its velocity, whichever of them are `kept`."""
    per_step = [1.0 / (j * dt_s) for j in range(1, features.length + 1)]
    return PositionVelocityStage(np.array(per_step, dtype=dtype), dtype(features.band_m))
