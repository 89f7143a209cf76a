"""Features that are weighted sums of terms which all orders share: sp_weighted_sum.h."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.stage import FeatureStage, Probe, padded


@dataclass(frozen=True, eq=False)
class WeightedSumStage(FeatureStage):
    """orders: of the columns in use. weights: shape (terms, capacity)."""

    orders: tuple[float, ...]
    weights: Reals

    @property
    def n_features(self) -> int:
        return len(self.orders)

    @property
    def capacity(self) -> int:
        return int(self.weights.shape[1])

    @property
    def named(self) -> str:
        """The orders, for a comment."""
        return ", ".join(f"{order:g}" for order in self.orders)

    def probe(self) -> Probe:
        rows, vector_width = self.weights.shape
        return Probe(
            inputs=rows,
            outputs=vector_width,
            sums=self.weigh,
        )

    def sum_instructions(self, costs: Costs) -> float:
        """Bound of the instructions of the weighted sums alone."""
        terms, vector_width = self.weights.shape
        return float(vector_width * (terms * costs.weight + costs.lane))

    def weigh(self, terms: Reals) -> Reals:
        """Terms (..., terms) by the weights, each column's sum in order: (..., capacity)."""
        total: Reals = np.zeros((*terms.shape[:-1], self.capacity), dtype=self.weights.dtype)
        for k, row in enumerate(self.weights):
            total += terms[..., k, None] * row
        return total


def in_lanes(weights: Reals, kept: NDArray[np.intp], dtype: type) -> Reals:
    """The columns `kept`, padded with zeros to whole vectors: (terms, capacity)."""
    found: Reals = np.zeros((len(weights), padded(max(len(kept), 1))), dtype=dtype)
    found[:, : len(kept)] = weights[:, kept]
    return found
