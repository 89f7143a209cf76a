"""Fractional derivatives by exponentials that all orders share: sp_poles.h."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.literals import array_text
from springpot.codegen.model.features import RecursiveBank
from springpot.codegen.model.formulas import loss_and_gain
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.stage import (
    DOUBLE,
    REAL,
    SMALLEST,
    Columns,
    Member,
    Starts,
    feature_stage,
    numbers,
    segments,
    stage_code,
)
from springpot.codegen.stages.weighted_sum import WeightedSumStage, in_lanes
from springpot.codegen.types import RealType

SLOW_TICKS = 1e5  # above this many ticks of time constant, a float state stops moving


def pole_states(loss: Reals, rises: Reals, h: Reals) -> Reals:
    """sp_poles.h: states after each tick, (n, poles), from h, (poles,); rises (n,), (n, poles)."""
    states = np.empty((len(rises), len(h)), dtype=loss.dtype)
    for k, (its_loss, begin) in enumerate(zip(numbers(loss), numbers(h), strict=True)):
        along, its_h = [], begin
        for rise in numbers(rises if rises.ndim == 1 else rises[:, k]):
            its_h = its_h + (rise - its_loss * its_h)
            its_h = its_h if abs(its_h) >= SMALLEST else its_h * 0
            along.append(its_h)
        states[:, k] = along
    return states


@dataclass(frozen=True, eq=False)
class RecursiveStage(WeightedSumStage):
    """Poles fast first; weights: shape (poles, capacity), gains folded in.

    loss: (fast poles,). slow_loss: (slow poles,), stepped in double.
    """

    loss: Reals
    slow_loss: NDArray[np.float64]

    code = stage_code("recursive")

    @property
    def headers(self) -> tuple[str, ...]:
        slow = ("sp_slow_poles.h",) if len(self.slow_loss) else ()
        return ("sp_number.h", "sp_poles.h", *slow, "sp_weighted_sum.h")

    @property
    def members(self) -> tuple[Member, ...]:
        """States of all poles, the slow ones' own, and the depth of the tick before."""
        n_poles, n_slow = len(self.weights), len(self.slow_loss)
        slow = (Member(f"double slow[{n_slow}]", (DOUBLE,) * n_slow),) if n_slow else ()
        return (
            *slow,
            Member(f"sp_real poles[{n_poles}]", (REAL,) * n_poles),
            Member("sp_real last_clipped", (REAL,)),
        )

    def tables(self) -> list[str]:
        n_poles, vector_width = self.weights.shape
        n_fast = len(self.loss)
        slow = [array_text("slow_loss", "double", self.slow_loss)] if len(self.slow_loss) else []
        fast = [array_text("loss", "sp_real", self.loss)] if n_fast else []
        return [
            f"enum {{\n    N_POLES = {n_poles},\n    N_FAST = {n_fast},\n"
            f"    N_VECTOR = {vector_width}\n}};",
            *fast,
            *slow,
            f"/* Poles to orders: a row a pole, a lane each for the orders {self.named}. */",
            array_text("weights", "sp_real", self.weights),
        ]

    def instructions(self, costs: Costs) -> float:
        poles = len(self.loss) * costs.pole + len(self.slow_loss) * costs.slow_pole
        return float(poles + self.sum_instructions(costs) + 40.0)

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        result = np.zeros((len(depth), self.n_features), dtype=depth.dtype)
        for begin, end, held in segments(len(depth), starts):
            first = depth[begin] if held else depth.dtype.type(0)
            rises = np.diff(depth[begin:end], prepend=first)
            fast = pole_states(self.loss, rises, np.zeros_like(self.loss))
            slow_rises, at_rest = rises.astype(np.float64), np.zeros_like(self.slow_loss)
            slow = pole_states(self.slow_loss, slow_rises, at_rest)
            states = np.concatenate([fast, slow.astype(depth.dtype)], axis=1)
            result[begin:end] = self.weigh(states)[:, : self.n_features]
        return result


@feature_stage.register
def recursive_stage(
    bank: RecursiveBank, kept: Columns, dt_s: float, dtype: RealType
) -> RecursiveStage:
    """Keep the columns `kept`; order the poles fast first."""
    order = np.argsort(bank.tau_s)
    loss, gain = loss_and_gain(bank.tau_s[order], dt_s)
    slow = bank.tau_s[order] > SLOW_TICKS * dt_s
    slow &= dtype is np.float32
    return RecursiveStage(
        orders=tuple(bank.orders[i] for i in kept),
        loss=loss[~slow].astype(dtype),
        slow_loss=loss[slow],
        weights=in_lanes(gain[:, None] * bank.weights[order], kept, dtype),
    )
