"""Leaves of a forest in 16 bits: what every way of traversing it adds up."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.model.regressors import Forest

_MAX_QUANTISED = 2**16 - 1


@dataclass(frozen=True, eq=False)
class QuantisedLeaves:
    """value_n of a leaf = min_n + steps x leaf_step_n, within half a step.

    steps: (IR nodes,) uint16, 0 where the node is no leaf.
    leaf_step_n, bias_n: force = bias_n + leaf_step_n x sum of the steps.
    error_n: maximum error of the force by this rounding.
    """

    quantised: NDArray[np.uint16]
    leaf_step_n: float
    bias_n: float
    error_n: float


def quantised_leaves(forest: Forest) -> QuantisedLeaves:
    """Spread 16 bits over the range of the leaves."""
    leaf = forest.feature < 0
    min_n, max_n = float(forest.value_n[leaf].min()), float(forest.value_n[leaf].max())
    leaf_step_n = (max_n - min_n) / _MAX_QUANTISED
    steps = (forest.value_n - min_n) / (leaf_step_n or 1.0)
    n_trees = len(forest.roots)
    return QuantisedLeaves(
        quantised=np.where(leaf, np.rint(steps), 0.0).astype(np.uint16),
        leaf_step_n=leaf_step_n * forest.weight,
        bias_n=forest.bias_n + forest.weight * n_trees * min_n,
        error_n=0.5 * leaf_step_n * abs(forest.weight) * n_trees,
    )


def used_features(forest: Forest) -> NDArray[np.int32]:
    """Columns that some split uses, ascending."""
    return np.unique(forest.feature[forest.feature >= 0])


def largest_float32_below(threshold: NDArray[np.float64]) -> NDArray[np.float32]:
    """Largest float32 not above each threshold: float32 x <= it exactly where x <= threshold."""
    nearest = threshold.astype(np.float32)
    above = nearest.astype(np.float64) > threshold
    return np.where(above, np.nextafter(nearest, np.float32(-np.inf)), nearest)


def level_order(forest: Forest) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Place of each IR node, tree after tree, level by level, siblings adjacent; and its level."""
    place = np.empty(len(forest.feature), dtype=np.int32)
    level_of = np.empty(len(forest.feature), dtype=np.int32)
    placed = 0
    for root in forest.roots:
        level = np.array([root])
        depth = 0
        while len(level):
            place[level] = np.arange(placed, placed + len(level), dtype=np.int32)
            level_of[level] = depth
            placed += len(level)
            inner = level[forest.feature[level] >= 0]
            level = np.stack([forest.left[inner], forest.right[inner]], axis=1).ravel()
            depth += 1
    return place, level_of
