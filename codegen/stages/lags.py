"""Past positions: sp_lags.h."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.literals import array_text
from springpot.codegen.model.features import Lags
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
class LagsStage(FeatureStage):
    """lags: those kept, in samples; difference: past positions enter as x(t) - x(t - lag)."""

    lags: NDArray[np.uint32]
    difference: bool

    headers = ("sp_lags.h",)

    code = stage_code("lags")

    @property
    def n_features(self) -> int:
        return len(self.lags)

    @property
    def _length(self) -> int:
        return int(self.lags.max()) + 1

    @property
    def members(self) -> tuple[Member, ...]:
        return (
            Member(f"sp_real past[{self._length}]", (REAL,) * self._length),
            Member("uint32_t newest", (U32,)),
        )

    def tables(self) -> list[str]:
        return [
            f"enum {{\n    N_PAST = {self._length},\n    N_LAGS = {len(self.lags)}\n}};",
            array_text("lags", "uint32_t", self.lags),
        ]

    def instructions(self, costs: Costs) -> float:
        return len(self.lags) * costs.lag + 40.0

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        longest = self._length - 1
        result = np.zeros((len(depth), self.n_features), dtype=depth.dtype)
        for rows, samples in held_before(depth, starts, longest):
            n = len(samples) - longest
            for i, lag in enumerate(self.lags.tolist()):
                past = samples[longest - lag : longest - lag + n]
                result[rows, i] = samples[longest:] - past if self.difference and lag else past
        return result


@feature_stage.register
def lags_stage(lags: Lags, kept: Columns, dt_s: float, dtype: RealType) -> LagsStage:
    """Keep the lags `kept`."""
    chosen = np.array([lags.samples[i] for i in kept] or [0], dtype=np.uint32)
    return LagsStage(lags=chosen, difference=lags.difference)
