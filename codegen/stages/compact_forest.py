"""A `Forest` -> the 4-byte nodes of sp_forest.h, deciding exactly as scikit-learn does."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.errors import UsageError
from springpot.codegen.model.forest import (
    MAX_BIN,
    QuantisedLeaves,
    find_used_features,
    largest_float32_below,
    sort_by_level,
)
from springpot.codegen.model.regressors import Forest
from springpot.codegen.stages.stage import round_up

# Metadata of sp_forest.h and sp_forest_x86.h; a test compares them with the headers.
COMPACT_SLOT_BITS = 4
LEVELS = 4
TREES_PER_PASS = 10  # the plain C traverses this many trees at once, or a multiple
MAX_VECTOR_TREES = 16  # trees side by side in the widest vector unit

ENTRIES = 1 << LEVELS
_MAX_STEP = 2 ** (16 - COMPACT_SLOT_BITS) - 1
_LEVELS_PER_LINE = 3  # levels that lie together below the first ones

Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class CompactForest:
    """sp_forest.h: nodes as pairs (step, bin) of uint16.

    top: (15, padded trees, 2), by heap position and tree; nodes: (nodes, 2); roots: (padded
    trees,) uint32.
    thresholds: of each used feature, sorted float32; none where features are quantised.
    """

    top: NDArray[np.uint16]
    nodes: NDArray[np.uint16]
    roots: NDArray[np.uint32]
    n_trees: int
    thresholds: tuple[NDArray[np.float32], ...]


@dataclass(frozen=True, eq=False)
class _Order:
    """Order of the forest's nodes in the tables; place, level, tree, heap: one for each node.

    place: in the table, of nodes at LEVELS or below it and of all leaves. heap: position among the
    first levels. roots: (trees,). size: nodes in the table.
    """

    table_index: Ints
    level: NDArray[np.int32]
    tree: Ints
    heap: Ints
    roots: Ints
    size: int


def compact_forest(forest: Forest, leaves: QuantisedLeaves) -> CompactForest:
    """Lay a forest out as the 4-byte nodes of sp_forest.h, its used features as slots 1 on.

    Raises UsageError where 4 bytes do not do.
    """
    columns = find_used_features(forest)
    if len(columns) >= 1 << COMPACT_SLOT_BITS:
        raise UsageError(
            f"a forest on {len(columns)} features: the C's nodes of 4 bytes name "
            f"{(1 << COMPACT_SLOT_BITS) - 1}: train on fewer"
        )
    leaf = forest.feature < 0
    slot = np.where(leaf, 0, np.searchsorted(columns, forest.feature) + 1)
    thresholds, bin_index = _rank_thresholds(forest, columns)
    order = _sort_nodes(forest)
    low = order.level >= LEVELS
    # Above LEVELS heap positions name the children (2 h, 2 h + 1). A leaf's step is 0 and its slot
    # 0. Its bin, 0, is above no node's: a traversal that goes on stays there.
    step = np.where(leaf | ~low, 0, order.table_index[forest.left] - order.table_index)
    if bin_index.max(initial=0) > MAX_BIN or step.max(initial=0) > _MAX_STEP:
        raise UsageError(
            "the forest is too large for the C's nodes of 4 bytes: fit fewer trees or larger "
            "leaves, or use `springpot train` with --round-features"
        )
    stored = low | leaf
    nodes = np.zeros((order.size, 2), dtype=np.uint16)
    nodes[order.table_index[stored], 0] = (step << COMPACT_SLOT_BITS | slot)[stored]
    nodes[order.table_index[stored], 1] = np.where(leaf, leaves.quantised, bin_index)[stored]
    n_padded = round_up(
        round_up(len(order.roots), TREES_PER_PASS), MAX_VECTOR_TREES
    )  # every traversal: whole groups
    top = np.zeros((ENTRIES - 1, n_padded, 2), dtype=np.uint16)  # zeros send everything to the left
    high = ~low & ~leaf
    top[order.heap[high] - 1, order.tree[high], 0] = slot[high]
    top[order.heap[high] - 1, order.tree[high], 1] = bin_index[high]
    roots = np.full(n_padded, order.size - 1, dtype=np.uint32)
    roots[: len(order.roots)] = order.roots
    return CompactForest(
        top=top, nodes=nodes, roots=roots, n_trees=len(order.roots), thresholds=thresholds
    )


def _rank_thresholds(forest: Forest, columns: NDArray[np.int32]) -> tuple[tuple[Any, ...], Ints]:
    """Return the sorted thresholds of each used feature, and for each node the rank of its own.

    Ranks have 16 bits where thresholds have 32. Quantised features are their own ranks: no
    thresholds are needed.
    """
    if forest.quantisation is not None:
        return (), np.clip(np.floor(forest.threshold), 0, MAX_BIN).astype(np.int64)
    # scikit-learn compares float32(x) with a double; the largest float32 not above it decides
    # alike. So do ranks: x <= sorted threshold j if and only if at most j thresholds are below x.
    split = largest_float32_below(forest.threshold)
    bin_index = np.zeros(len(split), dtype=np.int64)
    thresholds = []
    for column in columns:
        here = forest.feature == column
        values, bin_index[here] = np.unique(split[here], return_inverse=True)
        thresholds.append(values)
    return tuple(thresholds), bin_index


def _sort_nodes(forest: Forest) -> _Order:
    """Order the nodes for the cache: first levels by heap position, below them subtrees together.

    All trees take the first levels in step, so that a vector reads one row of them; below, where
    trees part, what is read next should lie in the cache line that was just read: three levels of a
    subtree lie together.
    """
    depth_first, level = sort_by_level(forest)
    heap = np.zeros(len(depth_first), dtype=np.int64)
    tree = np.zeros(len(depth_first), dtype=np.int64)
    heap[forest.roots], tree[forest.roots] = 1, np.arange(len(forest.roots))
    # Three levels below a node are 7 pairs of children, 56 bytes: about a cache line together.
    block = np.arange(len(depth_first))
    for depth in range(int(level.max())):
        inner = np.flatnonzero((level == depth) & (forest.feature >= 0))
        for side, children in enumerate((forest.left[inner], forest.right[inner])):
            tree[children] = tree[inner]
            if depth < LEVELS:
                heap[children] = 2 * heap[inner] + side
            elif (depth + 1 - LEVELS) % _LEVELS_PER_LINE:
                block[children] = block[inner]
    parents = np.flatnonzero((level >= LEVELS) & (forest.feature >= 0))
    # `before` counts tree after tree, so that trees stay apart in this order.
    parents = parents[np.lexsort((depth_first[parents], depth_first[block[parents]]))]
    pairs = np.bincount(tree[parents], minlength=len(forest.roots))
    roots = ENTRIES * np.arange(len(pairs)) + 2 * np.concatenate([[0], np.cumsum(pairs)[:-1]])
    table_index = np.zeros(len(depth_first), dtype=np.int64)
    first = ENTRIES * (tree[parents] + 1) + 2 * np.arange(len(parents))
    table_index[forest.left[parents]], table_index[forest.right[parents]] = first, first + 1
    entering = level <= LEVELS
    # A leaf above LEVELS sends everything to the left: its heap position, shifted down to LEVELS.
    lowered = heap[entering] << (LEVELS - level[entering])
    table_index[entering] = roots[tree[entering]] + lowered - ENTRIES
    size = ENTRIES * len(pairs) + 2 * len(parents) + 1  # the last one is what padding ends at
    return _Order(table_index, level, tree, heap, roots, size)
