"""What a forest has in 16 bits: its leaves, which every way of traversing it adds up, and features.

Features in fixed point are what sp_quantise.h makes, for a forest that was fitted on them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.model.regressors import Forest, Quantisation

_MAX_QUANTISED = 2**16 - 1
MAX = 2**16 - 1


@dataclass(frozen=True, eq=False)
class QuantisedLeaves:
    """Leaves as whole numbers of equal steps over their range, each within half a step.

    quantised: (IR nodes,), uint16, 0 where the node is no leaf.
    leaf_step_n, bias_n: force = bias_n + leaf_step_n x sum of the leaves reached, N.
    error_n: bound of what the rounding adds to the force, N.
    """

    quantised: NDArray[np.uint16]
    leaf_step_n: float
    bias_n: float
    error_n: float


def quantised_leaves(forest: Forest) -> QuantisedLeaves:
    """Spread 16 bits over the range of the leaves.

    Sums of whole numbers are exact, so that trees may be added in any order with the same bits.
    """
    leaf = forest.feature < 0
    min_n, max_n = float(forest.value_n[leaf].min()), float(forest.value_n[leaf].max())
    leaf_step_n = (max_n - min_n) / _MAX_QUANTISED
    # 1 where all leaves are alike: every one is then 0 steps.
    steps = (forest.value_n - min_n) / (leaf_step_n or 1.0)
    n_trees = len(forest.roots)
    return QuantisedLeaves(
        quantised=np.where(leaf, np.rint(steps), 0.0).astype(np.uint16),
        leaf_step_n=leaf_step_n * forest.weight,
        # Exactly one leaf of each tree is reached: each tree's min_n is part of the bias.
        bias_n=forest.bias_n + forest.weight * n_trees * min_n,
        error_n=0.5 * leaf_step_n * abs(forest.weight) * n_trees,
    )


def used_features(forest: Forest) -> NDArray[np.int32]:
    """Columns that some split uses, ascending: (used,)."""
    return np.unique(forest.feature[forest.feature >= 0])


def largest_float32_below(threshold: NDArray[np.float64]) -> NDArray[np.float32]:
    """Largest float32 not above each threshold, (n,).

    For a float32 x, x <= it exactly where x <= threshold; the nearest float32 may be above it.
    """
    nearest = threshold.astype(np.float32)
    above = nearest.astype(np.float64) > threshold
    return np.where(above, np.nextafter(nearest, np.float32(-np.inf)), nearest)


def level_order(forest: Forest) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Place and level of each IR node, both (IR nodes,).

    Places go tree after tree, level by level, siblings adjacent: a node then names one child only.
    """
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


def rounded(quantisation: Quantisation, features: Reals) -> NDArray[np.float32]:
    """Bins of features (n, features), 0 .. 65535, as the float32 that scikit-learn takes."""
    feature_min = quantisation.feature_min.astype(np.float32)
    bins_per_unit = quantisation.bins_per_unit.astype(np.float32)
    steps = (features.astype(np.float32) - feature_min) * bins_per_unit + np.float32(0.5)
    inside = np.clip(steps, np.float32(0), np.float32(MAX))
    whole: NDArray[np.float32] = np.floor(inside)
    return whole


def quantisation_over(features: NDArray[np.float64]) -> Quantisation:
    """Bins that cover the values of each column, (n, features)."""
    feature_min, feature_max = features.min(axis=0), features.max(axis=0)
    span = np.where(feature_max > feature_min, feature_max - feature_min, 1.0)
    return Quantisation(feature_min=feature_min, bins_per_unit=MAX / span)
