"""Smaller forests out of a fitted one: nothing is fitted again."""

from dataclasses import replace

import numpy as np

from springpot.codegen.forest.leaves import level_order
from springpot.codegen.model.regressors import Forest, Quantisation

_MAX_BIN = 2**16 - 1
_ABOVE = 0.01  # of a feature's thresholds: room for values beyond the maximum


def fewer_trees(forest: Forest, count: int) -> Forest:
    """The first `count` trees; where the force was the mean of the trees, their mean."""
    weight = forest.weight * len(forest.roots) / count if forest.is_mean else forest.weight
    return _reachable(replace(forest, roots=forest.roots[:count], weight=weight))


def larger_leaves(forest: Forest, leaves: int) -> Forest:
    """Make one leaf, their mean, of each subtree of at most `leaves` leaves.

    Leaves hold about as many samples each, so that this is nearly a fit with larger leaves.
    """
    _, level = level_order(forest)
    count = (forest.feature < 0).astype(np.int64)
    total_n = np.where(count, forest.value_n, 0.0)
    for depth in range(int(level.max()) - 1, -1, -1):
        inner = np.flatnonzero((level == depth) & (forest.feature >= 0))
        for children in (forest.left[inner], forest.right[inner]):
            count[inner] += count[children]
            total_n[inner] += total_n[children]
    feature = np.where(count <= leaves, -1, forest.feature).astype(np.int32)
    return _reachable(replace(forest, feature=feature, value_n=total_n / count))


def quantised(forest: Forest, n_features: int) -> Forest:
    """Thresholds as 16-bit bins of their range: no table of them is needed."""
    if forest.quantisation is not None:
        return forest
    feature_min, bins_per_unit = np.zeros(n_features), np.ones(n_features)
    threshold = np.zeros(len(forest.threshold))
    for column in range(n_features):
        here = forest.feature == column
        if here.any():
            values = forest.threshold[here]
            span = (1.0 + _ABOVE) * float(np.ptp(values)) or 1.0
            feature_min[column], bins_per_unit[column] = values.min(), (_MAX_BIN - 1) / span
            threshold[here] = np.floor((values - feature_min[column]) * bins_per_unit[column] + 0.5)
    return replace(
        forest, threshold=threshold, quantisation=Quantisation(feature_min, bins_per_unit)
    )


def _reachable(forest: Forest) -> Forest:
    keep = np.zeros(len(forest.feature), dtype=bool)
    reached = forest.roots
    while len(reached):
        keep[reached] = True
        inner = reached[forest.feature[reached] >= 0]
        reached = np.concatenate([forest.left[inner], forest.right[inner]])
    place = (np.cumsum(keep) - 1).astype(np.int32)
    leaf = forest.feature[keep] < 0
    return replace(
        forest,
        feature=forest.feature[keep],
        threshold=forest.threshold[keep],
        left=np.where(leaf, 0, place[forest.left[keep]]).astype(np.int32),
        right=np.where(leaf, 0, place[forest.right[keep]]).astype(np.int32),
        value_n=forest.value_n[keep],
        roots=place[forest.roots],
    )
