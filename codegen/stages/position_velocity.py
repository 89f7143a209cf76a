"""Depth and its velocity by first-order adaptive windowing: sp_window.h and sp_velocity.h."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from springpot.codegen.arrays import Real, Reals
from springpot.codegen.literals import array_text, literal
from springpot.codegen.model.features import PositionVelocity
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.stage import (
    REAL,
    U32,
    Columns,
    FeatureStage,
    Member,
    Stage,
    Starts,
    feature_stage,
    segments,
)


@dataclass(frozen=True, eq=False)
class VelocityStage(Stage):
    """per_step: shape (length,), 1/s; `source` is the variable whose velocity it estimates."""

    per_step: Reals
    band_m: Real
    source: str

    headers = ("sp_window.h", "sp_velocity.h")

    @property
    def members(self) -> tuple[Member, ...]:
        """The window, twice so that its samples are contiguous, and where it begins."""
        length = len(self.per_step) + 1
        return (
            Member(f"sp_real {self.source}_track[2 * {length}]", (REAL,) * (2 * length)),
            Member(f"uint32_t {self.source}_newest", (U32,)),
        )

    def tables(self) -> list[str]:
        name = self.source.upper()
        return [
            f"enum {{\n    N_{name}_STEPS = {len(self.per_step)}\n}};",
            array_text(f"{self.source}_per_step", "sp_real", self.per_step),
            f"static const sp_real {self.source}_band_m = {literal(self.band_m)};",
        ]

    def restart(self) -> list[str]:
        s = self.source
        length = f"N_{s.upper()}_STEPS + 1"
        return [f"sp_window_fill(state->{s}_track, &state->{s}_newest, {length}, {s});"]

    def advance(self) -> list[str]:
        s = self.source
        steps = f"N_{s.upper()}_STEPS"
        return [
            f"const sp_real *{s}_track =",
            f"    sp_window_push(state->{s}_track, &state->{s}_newest, {steps} + 1, {s});",
            f"const sp_real {s}_mps =",
            f"    sp_velocity_foaw({s}_track, {s}_per_step, {steps}, {s}_band_m);",
        ]

    def reference(self, x: Reals, starts: Starts) -> Reals:
        """Velocity of every tick, shape (n,), m/s."""
        result = np.zeros_like(x)
        for begin, end, held in segments(len(x), starts):
            result[begin:end] = foaw(self.per_step, self.band_m, x[begin:end], held)
        return result


@dataclass(frozen=True, eq=False)
class PositionVelocityStage(FeatureStage):
    """Features: depth, velocity of the depth."""

    velocity: VelocityStage

    n_features = 2

    @property
    def headers(self) -> tuple[str, ...]:
        return self.velocity.headers

    @property
    def members(self) -> tuple[Member, ...]:
        return self.velocity.members

    def tables(self) -> list[str]:
        return self.velocity.tables()

    def restart(self) -> list[str]:
        return self.velocity.restart()

    def advance(self) -> list[str]:
        return self.velocity.advance()

    def read(self) -> list[str]:
        """Equation (13)."""
        return ["features[0] = clipped;", "features[1] = clipped_mps;"]

    def instructions(self, costs: Costs) -> float:
        return float(len(self.velocity.per_step) * costs.velocity_step + 60.0)

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        return np.stack([depth, self.velocity.reference(depth, starts)], axis=1)


@feature_stage.register
def position_velocity_stage(
    features: PositionVelocity, kept: Columns, dt_s: float, dtype: type[Any]
) -> PositionVelocityStage:
    """Depth and its velocity, whichever of them are `kept`."""
    return PositionVelocityStage(velocity_stage(features, dt_s, dtype, "clipped"))


def velocity_stage(
    features: PositionVelocity, dt_s: float, dtype: type, source: str
) -> VelocityStage:
    """Stage that estimates the velocity of the C variable `source`, m/s."""
    per_step: Reals = np.array(
        [1.0 / (j * dt_s) for j in range(1, features.length + 1)], dtype=dtype
    )
    return VelocityStage(per_step=per_step, band_m=dtype(features.band_m), source=source)


def foaw(per_step: Reals, band_m: Real, x: Reals, held: bool) -> Reals:
    """sp_velocity.h over one stretch, shape (n,); before it x[0] was held, or zeros."""
    length = len(per_step)
    before = np.full(length, x[0] if held else x.dtype.type(0), dtype=x.dtype)
    return foaw_of(per_step, band_m, sliding_window_view(np.concatenate([before, x]), length + 1))


def foaw_of(per_step: Reals, band_m: Real, windows: Reals) -> Reals:
    """The velocity at the end of each window, shape (n,), m/s; windows: (n, steps + 1), m."""
    newest = windows[:, -1]
    slope = minimum = maximum = np.zeros_like(newest)
    longer = np.ones(len(newest), dtype=bool)
    for j, per_s in enumerate(per_step):
        rise = newest - windows[:, -2 - j]
        candidate = rise * per_s
        low, high = (rise - band_m) * per_s, (rise + band_m) * per_s
        if j == 0:
            slope, minimum, maximum = candidate, low, high
            continue
        longer &= (candidate >= minimum) & (candidate <= maximum)
        slope = np.where(longer, candidate, slope)
        minimum = np.where(longer & (low > minimum), low, minimum)
        maximum = np.where(longer & (high < maximum), high, maximum)
    return slope
