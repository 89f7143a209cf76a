"""Traversal of node tables in numpy: what sp_forest.h and the nested ifs do."""

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.forest.compact import COMPACT_SLOT_BITS, ENTRIES, LEVELS, CompactForest
from springpot.codegen.forest.node_table import LEAF_SLOT, ForestTable

_CHUNK = 4096  # samples whose traversal stays in the cache
Bins = NDArray[np.int32]


def feature_bins(
    thresholds: tuple[NDArray[np.float32], ...], features: NDArray[np.float32]
) -> Bins:
    """sp_bins.h: number of thresholds below each feature, (n, used features)."""
    # searchsorted counts what is below: a feature equal to a threshold goes left, as <= says.
    columns = [np.searchsorted(below, features[:, i]) for i, below in enumerate(thresholds)]
    return np.stack(columns, axis=1).astype(np.int32) if columns else features.astype(np.int32)


def compact_sums(forest: CompactForest, bins: Bins) -> NDArray[np.uint32]:
    """sp_forest.h: sum of the quantised leaves, (n,), of bins (n, used features)."""
    # Slot 0, that of leaves, has bin 0.
    padded = np.concatenate([np.zeros((len(bins), 1), dtype=np.int32), bins], axis=1)
    sums = np.zeros(len(bins), dtype=np.uint32)
    for begin in range(0, len(bins), _CHUNK):
        rows = slice(begin, begin + _CHUNK)
        for tree in range(forest.n_trees):
            sums[rows] += forest.nodes[_compact_leaves(forest, tree, padded[rows]), 1]
    return sums


def _compact_leaves(forest: CompactForest, tree: int, bins: Bins) -> NDArray[np.int64]:
    """Rows of the leaves reached in one tree, (n,); bins: (n, slots)."""
    flat, width = np.ascontiguousarray(bins).ravel(), bins.shape[1]
    base = np.arange(len(bins)) * width
    heap = np.ones(len(bins), dtype=np.int64)
    for _ in range(LEVELS):
        node = forest.top[heap - 1, tree]
        heap = 2 * heap + (flat[base + node[:, 0]] > node[:, 1])
    at = int(forest.roots[tree]) + heap - ENTRIES
    active = np.flatnonzero(forest.nodes[at, 0])  # leaves alone hold 0: no step and slot 0
    while len(active):
        here = at[active]
        step = forest.nodes[here, 0].astype(np.int64)
        bin_index = flat[base[active] + (step & ((1 << COMPACT_SLOT_BITS) - 1))]
        here += (step >> COMPACT_SLOT_BITS) + (bin_index > forest.nodes[here, 1])
        at[active] = here
        active = active[forest.nodes[here, 0] > 0]
    return at


def forest_leaves(table: ForestTable, features: NDArray[np.float32]) -> NDArray[np.int64]:
    """Rows of the leaves reached: shape (n, padded trees)."""
    leaves = np.empty((len(features), len(table.roots)), dtype=np.int64)
    left = (table.link >> COMPACT_SLOT_BITS).astype(np.int64)
    slot = (table.link & LEAF_SLOT).astype(np.int64)
    inner = slot != LEAF_SLOT
    n_columns = features.shape[1]
    flat = np.ascontiguousarray(features).ravel()
    for tree, root in enumerate(table.roots):
        at = np.full(len(features), root, dtype=np.int64)
        active = np.arange(len(features)) if inner[root] else np.empty(0, dtype=np.int64)
        while len(active):
            here = at[active]
            feature = flat[active * n_columns + slot[here]]
            # Not (x <= threshold), as the C compares: a NaN goes right.
            here = left[here] + ~(feature <= table.value[here])
            at[active] = here
            active = active[inner[here]]
        leaves[:, tree] = at
    return leaves


def table_sums(table: ForestTable, features: NDArray[np.float32]) -> NDArray[np.uint32]:
    """Sum of the quantised leaves, (n,), of features (n, used features)."""
    sums = np.empty(len(features), dtype=np.uint32)
    value = table.value.astype(np.uint32)
    for begin in range(0, len(features), _CHUNK):
        rows = slice(begin, begin + _CHUNK)
        sums[rows] = value[forest_leaves(table, features[rows])].sum(axis=1, dtype=np.uint32)
    return sums


def forest_force(table: ForestTable | CompactForest, sums: NDArray[np.uint32]) -> Reals:
    """Force of each sum of leaves, (n,), N, in the scene's type."""
    total: Reals = sums.astype(type(table.leaf_step_n))
    force_n: Reals = table.bias_n + total * table.leaf_step_n
    return force_n
