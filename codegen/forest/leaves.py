"""Leaves of a forest in 16 bits: what every way of walking it adds up."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.model.regressors import Forest

_GREATEST_QUANTA = 2**16 - 1


@dataclass(frozen=True, eq=False)
class LeafQuanta:
    """value_n of a leaf = least_n + quanta x quantum_n, within half a quantum.

    quanta: (IR nodes,) uint16, 0 where the node is no leaf.
    quantum_n, bias_n: force = bias_n + quantum_n x sum of the quanta.
    error_n: greatest error of the force by this rounding.
    """

    quanta: NDArray[np.uint16]
    quantum_n: float
    bias_n: float
    error_n: float


def leaf_quanta(forest: Forest) -> LeafQuanta:
    """Spread 16 bits over the range of the leaves."""
    leaf = forest.feature < 0
    least_n, greatest_n = float(forest.value_n[leaf].min()), float(forest.value_n[leaf].max())
    quantum_n = (greatest_n - least_n) / _GREATEST_QUANTA
    steps = (forest.value_n - least_n) / (quantum_n or 1.0)
    n_trees = len(forest.roots)
    return LeafQuanta(
        quanta=np.where(leaf, np.rint(steps), 0.0).astype(np.uint16),
        quantum_n=quantum_n * forest.weight,
        bias_n=forest.bias_n + forest.weight * n_trees * least_n,
        error_n=0.5 * quantum_n * abs(forest.weight) * n_trees,
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
