"""Smaller versions of a fitted model, without its training data: nothing is fitted again.

What costs no error comes first: the window by exponentials and thresholds as 16-bit bins. Then
forests lose trees and small leaves."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import singledispatch

import numpy as np

from springpot import Model
from springpot.codegen.forest.leaves import level_order
from springpot.codegen.model.features import Features, FirBank
from springpot.codegen.model.regressors import Forest, Quantisation, Regressor
from springpot.trainer.features.fast_fir import fast_fir_bank
from springpot.trainer.models.rf_fd import MAX_TAPS

_MAX_BIN = 2**16 - 1
_ABOVE = 0.01  # of a feature's thresholds: room for values beyond the maximum
_TREES = (1.0, 0.8, 0.6, 0.4, 0.3, 0.2, 0.1, 0.05)  # shares of the trees
_LEAVES = (1, 2, 4, 8, 16, 32)  # leaves made one


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


@dataclass(frozen=True, eq=False)
class Pruned:
    """Smaller model: what was left out, how many leaves were made one, and the model."""

    what: tuple[str, ...]
    leaves: int
    model: Model


def pruned_models(model: Model) -> Iterator[Pruned]:
    """Smaller versions of a model; none where nothing can be left out."""
    if model.features is None or model.regressor is None:
        return
    features, free = cheaper_features(model.features)
    for what, leaves, regressor in smaller_regressors(model.regressor, model.features.n_features):
        parts = (*free, *what)
        if parts:
            metadata = {**model.provenance, "left_out": list(parts)}
            smaller = replace(model, features=features, regressor=regressor, provenance=metadata)
            yield Pruned(parts, leaves, smaller)


@singledispatch
def cheaper_features(features: Features) -> tuple[Features, tuple[str, ...]]:
    """The same features for fewer instructions, and what was done; themselves by default."""
    return features, ()


@cheaper_features.register
def _cheaper_window(bank: FirBank) -> tuple[Features, tuple[str, ...]]:
    if len(bank.taps) > MAX_TAPS:
        return bank, ()
    return fast_fir_bank(bank), ("the window by exponentials",)


@singledispatch
def smaller_regressors(
    regressor: Regressor, n_features: int
) -> Iterator[tuple[tuple[str, ...], int, Regressor]]:
    """Yield what is left out, leaves made one, and the regressor without it; itself by default."""
    yield (), 1, regressor


@smaller_regressors.register
def _smaller_forests(
    forest: Forest, n_features: int
) -> Iterator[tuple[tuple[str, ...], int, Regressor]]:
    free = () if forest.quantisation is not None else ("thresholds in 16-bit steps",)
    forest = quantised(forest, n_features)
    n_trees = len(forest.roots)
    for leaves in _LEAVES:
        pruned = larger_leaves(forest, leaves)
        larger = (f"leaves made one up to {leaves}",) if leaves > 1 else ()
        for count in sorted({max(1, round(share * n_trees)) for share in _TREES}):
            fewer = (f"{count} of {n_trees} trees",) if count < n_trees else ()
            yield (*free, *larger, *fewer), leaves, fewer_trees(pruned, count)
