"""The same window by direct taps and truncated exponentials: sp_fast_window.h."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.literals import array_text
from springpot.codegen.model.features import FastFirBank
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.stage import (
    REAL,
    SMALLEST,
    U32,
    Columns,
    Member,
    Starts,
    feature_stage,
    held_before,
    segments,
    stage_code,
)
from springpot.codegen.stages.weighted_sum import WeightedSumStage, in_lanes
from springpot.codegen.types import RealType


@dataclass(frozen=True, eq=False)
class FastFirStage(WeightedSumStage):
    """keep, leave: (poles,), what a pole keeps in a tick, and of a rise until the window's end.

    weights: (direct + poles + 1, capacity). length: of the window, samples.
    """

    keep: Reals
    leave: Reals
    length: int

    code = stage_code("fast_fir")
    headers = ("sp_window.h", "sp_number.h", "sp_fast_window.h", "sp_weighted_sum.h")

    @property
    def n_direct(self) -> int:
        """Newest rises, which have weights of their own."""
        return len(self.weights) - len(self.keep) - 1

    @property
    def members(self) -> tuple[Member, ...]:
        """The window, twice so that its samples are contiguous; where it begins; the poles."""
        window = 2 * (self.length + 1)
        return (
            Member(f"sp_real history[{window}]", (REAL,) * window),
            Member("uint32_t newest", (U32,)),
            Member(f"sp_real poles[{len(self.keep)}]", (REAL,) * len(self.keep)),
        )

    def tables(self) -> list[str]:
        rows, width = self.weights.shape
        return [
            f"enum {{\n    N_WINDOW = {self.length + 1},\n    N_DIRECT = {self.n_direct},\n"
            f"    N_POLES = {len(self.keep)},\n    N_TERMS = {rows},\n    N_VECTOR = {width}\n}};",
            array_text("keep", "sp_real", self.keep),
            array_text("leave", "sp_real", self.leave),
            f"/* Rises, poles, oldest sample: a row each; lanes: the orders {self.named}. */",
            array_text("weights", "sp_real", self.weights),
        ]

    def instructions(self, costs: Costs) -> float:
        poles = len(self.keep) * costs.pole + self.n_direct * costs.direct
        return float(poles + self.sum_instructions(costs) + 60.0)

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        result = np.zeros((len(depth), self.n_features), dtype=depth.dtype)
        stretches = segments(len(depth), starts)
        pasts = held_before(depth, starts, self.length)
        for (begin, end, _), (_, samples) in zip(stretches, pasts, strict=True):
            terms = self._terms(samples, end - begin)
            result[begin:end] = self.weigh(terms)[:, : self.n_features]
        return result

    def _terms(self, samples: Reals, n: int) -> Reals:
        """Terms of n ticks, (n, direct + poles + 1), from `length` past samples and the n."""
        rises = np.diff(samples)  # rises[i] is that of samples[i + 1]
        newest = self.length - 1
        direct = [rises[newest - k : newest - k + n] for k in range(self.n_direct)]
        entering = rises[newest - self.n_direct : newest - self.n_direct + n]
        leaving = rises[:n]
        h = np.zeros(len(self.keep), dtype=samples.dtype)
        poles = np.empty((n, len(h)), dtype=samples.dtype)
        for i in range(n):
            h = self.keep * h + (entering[i] - self.leave * leaving[i])
            h[np.abs(h) < samples.dtype.type(SMALLEST)] = 0
            poles[i] = h
        return np.column_stack([*direct, poles, samples[1 : n + 1]])


@feature_stage.register
def fast_fir_stage(bank: FastFirBank, kept: Columns, dt_s: float, dtype: RealType) -> FastFirStage:
    """Keep the columns `kept` of the bank."""
    n_direct = len(bank.weights) - len(bank.tau_ticks) - 1
    own = bank.length - 1 - n_direct
    return FastFirStage(
        orders=tuple(bank.orders[i] for i in kept),
        keep=np.exp(-1.0 / bank.tau_ticks).astype(dtype),
        leave=np.exp(-own / bank.tau_ticks).astype(dtype),
        weights=in_lanes(bank.weights, kept, dtype),
        length=bank.length,
    )
