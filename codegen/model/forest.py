"""Forests of a model: leaves in 16 bits, the force they give, features in bins, smaller forests.

Every way of traversing a forest in C adds up these leaves, and decides as is done here. Features in
bins are what sp_quantise.h makes, for a forest that was fitted on them.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals, Samples
from springpot.codegen.model.regressors import Forest, Quantisation
from springpot.codegen.types import RealType

MAX_BIN = 2**16 - 1  # of a leaf or a feature in 16 bits
_RANGE_MARGIN = 0.01  # of a feature's thresholds: room for values beyond the maximum
_CHUNK_TRAVERSALS = 1 << 18  # samples times trees, traversed side by side: more leave the cache


@dataclass(frozen=True, eq=False)
class QuantisedLeaves:
    """Leaves as whole numbers of equal steps over their range, each within half a step.

    quantised: (nodes,), uint16, 0 where the node is no leaf.
    leaf_step_n, bias_n: force = bias_n + leaf_step_n x sum of the leaves reached, N.
    error_n: bound on the error that the rounding adds to the force, N.
    """

    quantised: NDArray[np.uint16]
    leaf_step_n: float
    bias_n: float
    error_n: float


def quantise_leaves(forest: Forest) -> QuantisedLeaves:
    """Spread 16 bits over the range of the leaves.

    Sums of whole numbers are exact, so that trees may be added in any order with the same bits.
    """
    leaf = forest.feature < 0
    min_n, max_n = float(forest.value_n[leaf].min()), float(forest.value_n[leaf].max())
    leaf_step_n = (max_n - min_n) / MAX_BIN
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


def predict_forest_n(
    forest: Forest, leaves: QuantisedLeaves, values: NDArray[np.float32], real: RealType
) -> Reals:
    """Force of rows of features (n, features), (n,), N: the sum of the quantised leaves, scaled.

    Left where a feature is at most the threshold: a NaN goes right, as the C compares.
    """
    inner, stored = forest.feature >= 0, leaves.quantised.astype(np.uint32)
    threshold = largest_float32_below(forest.threshold)
    children = np.stack([forest.right, forest.left], axis=1).ravel()
    leaf_sums, trees = np.zeros(len(values), dtype=np.uint32), len(forest.roots)
    for begin in range(0, len(values), rows := max(1, _CHUNK_TRAVERSALS // trees)):
        part = np.ascontiguousarray(values[begin : begin + rows])
        flat, first = part.ravel(), np.repeat(np.arange(len(part)) * part.shape[1], trees)
        node = np.tile(forest.roots, len(part))
        active = np.flatnonzero(inner[node])
        while len(active):
            active_nodes = node.take(active)
            is_left = (
                flat.take(first.take(active) + forest.feature.take(active_nodes))
                <= threshold[active_nodes]
            )
            active_nodes = children.take(2 * active_nodes + is_left)
            node[active] = active_nodes
            active = active[inner.take(active_nodes)]
        leaf_sums[begin : begin + rows] = (
            stored[node].reshape(-1, trees).sum(axis=1, dtype=np.uint32)
        )
    force_n: Reals = real(leaves.bias_n) + leaf_sums.astype(real) * real(leaves.leaf_step_n)
    return force_n


def find_used_features(forest: Forest) -> NDArray[np.int32]:
    """Columns that some split uses, ascending: (used,)."""
    return np.unique(forest.feature[forest.feature >= 0])


def largest_float32_below(threshold: Samples) -> NDArray[np.float32]:
    """Largest float32 not above each threshold, (n,).

    For a float32 x, x <= it exactly where x <= threshold; the nearest float32 may be above it.
    """
    nearest = threshold.astype(np.float32)
    above = nearest.astype(np.float64) > threshold
    return np.where(above, np.nextafter(nearest, np.float32(-np.inf)), nearest)


def sort_by_level(forest: Forest) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Place and level of each node of the model, both (nodes,).

    Places go tree after tree, level by level, siblings adjacent: a node then names one child only.
    """
    position, level_of = (np.empty(len(forest.feature), dtype=np.int32) for _ in range(2))
    placed = 0
    for root in forest.roots:
        level, depth = np.array([root]), 0
        while len(level):
            position[level] = np.arange(placed, placed + len(level), dtype=np.int32)
            level_of[level] = depth
            placed += len(level)
            inner = level[forest.feature[level] >= 0]
            level = np.stack([forest.left[inner], forest.right[inner]], axis=1).ravel()
            depth += 1
    return position, level_of


def to_bins(quantisation: Quantisation, features: Reals) -> NDArray[np.float32]:
    """Bins of features (n, features), 0 .. 65535, as the float32 that scikit-learn takes."""
    feature_min = quantisation.feature_min.astype(np.float32)
    bins_per_unit = quantisation.bins_per_unit.astype(np.float32)
    steps = (features.astype(np.float32) - feature_min) * bins_per_unit + np.float32(0.5)
    inside = np.clip(steps, np.float32(0), np.float32(MAX_BIN))
    whole: NDArray[np.float32] = np.floor(inside)
    return whole


def fit_quantisation(features: Samples) -> Quantisation:
    """Bins that cover the values of each column, (n, features)."""
    feature_min, feature_max = features.min(axis=0), features.max(axis=0)
    span = np.where(feature_max > feature_min, feature_max - feature_min, 1.0)
    return Quantisation(feature_min=feature_min, bins_per_unit=MAX_BIN / span)


def keep_trees(forest: Forest, count: int) -> Forest:
    """Keep the first `count` trees; a force that was a mean is the mean of those."""
    total = forest.weight * len(forest.roots)
    weight = total / count if np.isclose(total, 1.0) else forest.weight
    return _drop_unreachable(replace(forest, roots=forest.roots[:count], weight=weight))


def merge_leaves(forest: Forest, leaves: int) -> Forest:
    """Make one leaf, their mean, of each subtree of at most `leaves` leaves.

    Leaves hold about as many samples each, so that this is nearly a fit with larger leaves.
    """
    _, level = sort_by_level(forest)
    count = (forest.feature < 0).astype(np.int64)
    total_n = np.where(count, forest.value_n, 0.0)
    for depth in range(int(level.max()) - 1, -1, -1):
        inner = np.flatnonzero((level == depth) & (forest.feature >= 0))
        for children in (forest.left[inner], forest.right[inner]):
            count[inner] += count[children]
            total_n[inner] += total_n[children]
    feature = np.where(count <= leaves, -1, forest.feature).astype(np.int32)
    return _drop_unreachable(replace(forest, feature=feature, value_n=total_n / count))


def quantise_thresholds(forest: Forest, n_features: int) -> Forest:
    """Thresholds as 16-bit bins of their range: no table of them is needed."""
    if forest.quantisation is not None:
        return forest
    feature_min, bins_per_unit = np.zeros(n_features), np.ones(n_features)
    threshold = np.zeros(len(forest.threshold))
    for column in range(n_features):
        in_column = forest.feature == column
        if in_column.any():
            values = forest.threshold[in_column]
            span = (1.0 + _RANGE_MARGIN) * float(np.ptp(values)) or 1.0
            feature_min[column], bins_per_unit[column] = values.min(), (MAX_BIN - 1) / span
            threshold[in_column] = np.floor(
                (values - feature_min[column]) * bins_per_unit[column] + 0.5
            )
    return replace(
        forest, threshold=threshold, quantisation=Quantisation(feature_min, bins_per_unit)
    )


def _drop_unreachable(forest: Forest) -> Forest:
    """Return the forest without the nodes that no root leads to, and renumber the rest."""
    keep = np.zeros(len(forest.feature), dtype=bool)
    reached = forest.roots
    while len(reached):
        keep[reached] = True
        inner = reached[forest.feature[reached] >= 0]
        reached = np.concatenate([forest.left[inner], forest.right[inner]])
    new_index = (np.cumsum(keep) - 1).astype(np.int32)
    leaf = forest.feature[keep] < 0
    return replace(
        forest,
        feature=forest.feature[keep],
        threshold=forest.threshold[keep],
        left=np.where(leaf, 0, new_index[forest.left[keep]]).astype(np.int32),
        right=np.where(leaf, 0, new_index[forest.right[keep]]).astype(np.int32),
        value_n=forest.value_n[keep],
        roots=new_index[forest.roots],
    )
