"""Bounds of the largest and the smallest force of a forest, over all features.

The largest leaf of every tree may need features that no single vector has. Branch and bound over
sets of leaves, one of each tree, whose boxes have a point in common: the bound of a set that is not
complete is its sum and the largest leaf of every other tree that still meets its box. Best first,
so that the first complete set is the extreme (Devos, Meert, Davis: Versatile verification of tree
ensembles, 2021).
"""

import heapq
from dataclasses import dataclass, replace
from itertools import count

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.model.regressors import Forest

MAX_COMPARED = 1_000_000  # leaves compared with a box; a second. After so many a bound is not exact
_MAX_PAIRS = 20_000_000  # pairs of leaves times features; above, steps are not looked for


@dataclass(frozen=True)
class Extreme:
    """Bound of a force, force_n: no features give more; some give reached_n, the same if exact."""

    force_n: float
    reached_n: float

    @property
    def exact(self) -> bool:
        return self.force_n == self.reached_n


@dataclass(frozen=True, eq=False)
class _Leaves:
    """Leaves of all trees, one tree after the other.

    Box of each, (leaves, features): above lower, up to upper. value and tree: (leaves,).
    """

    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    value: NDArray[np.float64]
    tree: NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class _Set:
    """Leaves that still meet the box of those that were taken, at least one of each tree.

    lower, upper: that box. taken: trees, (trees,), whose only leaf it holds to.
    """

    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    candidates: NDArray[np.intp]
    taken: NDArray[np.bool_]


_Entry = tuple[float, int, _Set, np.intp | None]  # -bound; a set, or one with a leaf to take


def forest_extremes(
    forest: Forest, n_features: int, max_compared: int = MAX_COMPARED
) -> tuple[Extreme, Extreme]:
    """The smallest and the largest force of a forest, N, bias included."""
    leaves = _leaves(forest, n_features)
    least, most = _largest(-1.0, leaves, max_compared), _largest(1.0, leaves, max_compared)
    smallest = Extreme(forest.bias_n - least.force_n, forest.bias_n - least.reached_n)
    return smallest, Extreme(forest.bias_n + most.force_n, forest.bias_n + most.reached_n)


def forest_step(
    forest: Forest, change: NDArray[np.float64], max_compared: int = MAX_COMPARED
) -> Extreme | None:
    """Largest change of the force, N, if the features change by `change`, (features,).

    Sets are of pairs of leaves of a tree: before and after. None where those are too many.
    """
    leaves = _leaves(forest, len(change))
    if len(change) * int((np.bincount(leaves.tree) ** 2).sum()) > _MAX_PAIRS:
        return None
    pairs = _pairs(leaves, change)
    falls, rises = _largest(-1.0, pairs, max_compared), _largest(1.0, pairs, max_compared)
    return max(falls, rises, key=lambda extreme: extreme.force_n)


def _leaves(forest: Forest, n_features: int) -> _Leaves:
    """Boxes in the features' own units, also if a quantised forest compares bins."""
    threshold = _thresholds(forest)
    boxes = []
    for tree, root in enumerate(forest.roots):
        unbounded = np.full(n_features, np.inf)
        ways = [(int(root), -unbounded, unbounded)]
        while ways:
            node, lower, upper = ways.pop()
            feature = forest.feature[node]
            if feature < 0:
                if np.all(lower < upper):  # else two splits of one feature shut it: never reached
                    boxes.append((lower, upper, forest.weight * forest.value_n[node], tree))
                continue
            left_upper, right_lower = upper.copy(), lower.copy()
            left_upper[feature] = min(upper[feature], threshold[node])
            right_lower[feature] = max(lower[feature], threshold[node])
            ways.append((int(forest.left[node]), lower, left_upper))
            ways.append((int(forest.right[node]), right_lower, upper))
    lower_of, upper_of, value, tree_of = zip(*boxes, strict=True)
    return _Leaves(np.array(lower_of), np.array(upper_of), np.array(value), np.array(tree_of))


def _thresholds(forest: Forest) -> NDArray[np.float64]:
    """Threshold of each split in its feature's unit, (nodes,).

    A feature's bin is floor(x + 1/2), x in bins: it is above t from x = floor(t) + 1/2 on.
    """
    quantisation = forest.quantisation
    if quantisation is None:
        return forest.threshold
    own = np.maximum(forest.feature, 0)  # of leaves, without meaning
    bins = np.floor(forest.threshold) + 0.5
    found: NDArray[np.float64] = (
        quantisation.feature_min[own] + bins / quantisation.bins_per_unit[own]
    )
    return found


def _pairs(leaves: _Leaves, change: NDArray[np.float64]) -> _Leaves:
    """Pairs of leaves of a tree, before and after the change; value: what the change adds."""
    found = []
    for tree in range(int(leaves.tree[-1]) + 1):
        own = np.flatnonzero(leaves.tree == tree)
        # x in the first leaf and x + change in the second: their boxes, the second moved back.
        lower = np.maximum(leaves.lower[own, None], leaves.lower[own] - change)
        upper = np.minimum(leaves.upper[own, None], leaves.upper[own] - change)
        before, after = np.nonzero(np.all(lower < upper, axis=2))
        value = leaves.value[own[after]] - leaves.value[own[before]]
        at = np.full(len(value), tree)
        found.append((lower[before, after], upper[before, after], value, at))
    lower, upper, value, tree_of = zip(*found, strict=True)
    return _Leaves(*(np.concatenate(parts) for parts in (lower, upper, value, tree_of)))


def _largest(scale: float, leaves: _Leaves, max_compared: int) -> Extreme:
    return Extreme(*_largest_sum(replace(leaves, value=scale * leaves.value), max_compared))


def _largest_sum(leaves: _Leaves, max_compared: int) -> tuple[float, float]:
    """Bound of the largest sum of one leaf of each tree, and the largest sum that was found."""
    n_features, n_trees = leaves.lower.shape[1], int(leaves.tree[-1]) + 1
    unbounded = np.full(n_features, np.inf)
    first = _Set(-unbounded, unbounded, np.arange(len(leaves.tree)), np.zeros(n_trees, bool))
    order = count()  # of entries with the same bound
    heap: list[_Entry] = [(-_bound(leaves, first), next(order), first, None)]
    found = _dive(leaves, first)  # whatever cannot beat it is never queued
    rows = 0
    while heap and rows < max_compared:
        bound, _, known, leaf = heapq.heappop(heap)
        if leaf is not None:  # its bound was its parent's: now it is looked at
            rows += len(known.candidates)
            known = _take(leaves, known, leaf)
            heapq.heappush(heap, (-_bound(leaves, known), next(order), known, None))
        elif known.taken.all():
            return -bound, -bound  # best first: every other bound is at most this one
        else:
            # A leaf costs at least what it is below its tree's best: a bound that is known before
            # its box is compared with the others, which most leaves then never need.
            choices = _choices(leaves, known)
            losses = leaves.value[choices].max() - leaves.value[choices]
            for choice, loss in zip(choices, losses, strict=True):
                if -bound - loss > found:
                    heapq.heappush(heap, (float(bound + loss), next(order), known, choice))
    return max(found, -heap[0][0] if heap else found), found


def _bound(leaves: _Leaves, found: _Set) -> float:
    """The largest candidate of every tree, summed in the order of the trees."""
    tree = leaves.tree[found.candidates]
    starts = np.flatnonzero(np.diff(tree, prepend=-1))
    return float(np.maximum.reduceat(leaves.value[found.candidates], starts).sum())


def _choices(leaves: _Leaves, found: _Set) -> NDArray[np.intp]:
    """Branching step: candidate leaves of the undecided tree with the widest range of values.

    Its leaves part the bounds most, so that few of them are looked at again.
    """
    tree = leaves.tree[found.candidates]
    starts = np.flatnonzero(np.diff(tree, prepend=-1))
    value = leaves.value[found.candidates]
    spread = np.maximum.reduceat(value, starts) - np.minimum.reduceat(value, starts)
    spread[found.taken] = -1.0
    chosen: NDArray[np.intp] = found.candidates[tree == int(np.argmax(spread))]
    return chosen


def _take(leaves: _Leaves, found: _Set, leaf: np.intp) -> _Set:
    """Only this leaf of its tree, and of the others what meets it."""
    lower = np.maximum(found.lower, leaves.lower[leaf])
    upper = np.minimum(found.upper, leaves.upper[leaf])
    rest = found.candidates[leaves.tree[found.candidates] != leaves.tree[leaf]]
    below = np.minimum(leaves.upper[rest], upper)
    above = np.maximum(leaves.lower[rest], lower)
    meeting = rest[np.all(above < below, axis=1)]
    candidates = np.sort(np.append(meeting, leaf))
    taken = found.taken.copy()
    taken[leaves.tree[leaf]] = True
    return _Set(lower, upper, candidates, taken)


def _dive(leaves: _Leaves, found: _Set) -> float:
    """The sum of a complete set: the largest leaf of each tree in turn that still meets."""
    while not found.taken.all():
        choices = _choices(leaves, found)
        found = _take(leaves, found, choices[np.argmax(leaves.value[choices])])
    return _bound(leaves, found)
