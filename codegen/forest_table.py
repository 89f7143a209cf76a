"""IR forest -> the node table of sp_forest.h, deciding exactly as scikit-learn does."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.configs import ForestTable, Real
from springpot.codegen.ir import Forest
from springpot.runtime_c.errors import UsageError

# Facts of sp_forest.h; a test compares them with the header.
SLOT_BITS = 4
LEAF_SLOT = (1 << SLOT_BITS) - 1
LANES = 16

_EXACT_FLOAT_INTEGER = 2**24  # float32 holds every integer up to here
_GREATEST_SUM = 2**31 - 1


def used_features(forest: Forest) -> NDArray[np.int32]:
    """Columns that some split uses, ascending."""
    return np.unique(forest.feature[forest.feature >= 0])


def forest_table(forest: Forest, real: Callable[[float], Real]) -> ForestTable:
    """Lay out `forest` with its used features as slots 0, 1, ... in ascending order.

    Raises UsageError where a forest has more features or nodes than a node's link can name.
    """
    columns = used_features(forest)
    if len(columns) > LEAF_SLOT:
        raise UsageError(
            f"a forest on {len(columns)} features: the C table holds {LEAF_SLOT}: train on fewer"
        )
    if len(forest.feature) >= 1 << (32 - SLOT_BITS):
        raise UsageError(f"a forest of {len(forest.feature)} nodes does not fit 28 bits")
    row, depth = _rows(forest)
    leaf = forest.feature < 0
    slot = np.where(leaf, LEAF_SLOT, np.searchsorted(columns, forest.feature))
    left = np.where(leaf, row, row[forest.left])
    quantum = _quantum(forest.value_n[leaf], len(forest.roots))
    value = np.where(
        leaf, np.rint(forest.value_n / quantum), largest_float32_below(forest.threshold)
    )
    n_nodes = len(row)
    padding = -len(forest.roots) % LANES
    table_value = np.zeros(n_nodes + 1, dtype=np.float32)
    table_link = np.full(n_nodes + 1, n_nodes << SLOT_BITS | LEAF_SLOT, dtype=np.uint32)
    table_value[row] = value.astype(np.float32)
    table_link[row] = (left.astype(np.uint32) << SLOT_BITS) | slot.astype(np.uint32)
    roots = np.append(row[forest.roots], np.full(padding, n_nodes)).astype(np.uint32)
    if padding == 0:
        table_value, table_link = table_value[:-1], table_link[:-1]
    return ForestTable(
        value=table_value,
        link=table_link,
        roots=roots,
        depth=depth,
        quantum_n=real(quantum * forest.weight),
        bias_n=real(forest.bias_n),
        leaf_error_n=quantum / 2,
        leaf=row,
    )


def largest_float32_below(threshold: NDArray[np.float64]) -> NDArray[np.float32]:
    """Largest float32 not above each threshold: float32 x <= it exactly where x <= threshold."""
    nearest = threshold.astype(np.float32)
    above = nearest.astype(np.float64) > threshold
    return np.where(above, np.nextafter(nearest, np.float32(-np.inf)), nearest)


def _quantum(values_n: NDArray[np.float64], n_trees: int) -> float:
    """Smallest power of two in which leaves are exact float integers and no sum overflows."""
    greatest = max(float(np.abs(values_n).max()), 2.0**-100)
    limit = min(_EXACT_FLOAT_INTEGER, _GREATEST_SUM // n_trees)
    return float(2.0 ** np.ceil(np.log2(greatest / limit)))


def _rows(forest: Forest) -> tuple[NDArray[np.int32], int]:
    """Row of each IR node, tree after tree, level by level, siblings adjacent; and the depth."""
    row = np.empty(len(forest.feature), dtype=np.int32)
    next_row = 0
    depth = 0
    for root in forest.roots:
        level = np.array([root])
        levels = 0
        while len(level):
            row[level] = np.arange(next_row, next_row + len(level), dtype=np.int32)
            next_row += len(level)
            inner = level[forest.feature[level] >= 0]
            level = np.stack([forest.left[inner], forest.right[inner]], axis=1).ravel()
            levels += 1
        depth = max(depth, levels)
    return row, depth
