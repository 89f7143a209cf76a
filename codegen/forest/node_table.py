"""A forest as a table of nodes with quantised leaves: what m2cgen's nested ifs are written from."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Real
from springpot.codegen.errors import UsageError
from springpot.codegen.forest.leaves import (
    largest_float32_below,
    level_order,
    quantised_leaves,
    used_features,
)
from springpot.codegen.model.regressors import Forest

WIDE_SLOT_BITS = 4
LEAF_SLOT = (1 << WIDE_SLOT_BITS) - 1
WIDE_VECTOR_WIDTH = 16


@dataclass(frozen=True, eq=False)
class ForestTable:
    """Node table.

    value: (nodes,) float32; link: (nodes,) uint32; roots: (padded trees,) uint32.
    depth: longest path in levels. leaf_step_n: force of one step of the sum, N; bias_n: beside it.
    leaf_error_n: bound of what the leaves' rounding adds to the force, N.
    leaf: (IR nodes,) int32, row of each IR node in this table.
    """

    value: NDArray[np.float32]
    link: NDArray[np.uint32]
    roots: NDArray[np.uint32]
    depth: int
    leaf_step_n: Real
    bias_n: Real
    leaf_error_n: float
    leaf: NDArray[np.int32]


def forest_table(forest: Forest, real: Callable[[float], Real]) -> ForestTable:
    """Lay out `forest` with its used features as slots 0, 1, ... in ascending order.

    Raises UsageError where a forest has more features or nodes than a node's link can name.
    """
    columns = used_features(forest)
    if len(columns) > LEAF_SLOT:
        raise UsageError(
            f"a forest on {len(columns)} features: the C table holds {LEAF_SLOT}: train on fewer"
        )
    if len(forest.feature) >= 1 << (32 - WIDE_SLOT_BITS):
        raise UsageError(f"a forest of {len(forest.feature)} nodes does not fit 28 bits")
    row, level = level_order(forest)
    leaf = forest.feature < 0
    slot = np.where(leaf, LEAF_SLOT, np.searchsorted(columns, forest.feature))
    left = np.where(leaf, row, row[forest.left])
    quantised = quantised_leaves(forest)
    value = np.where(leaf, quantised.quantised, largest_float32_below(forest.threshold))
    n_nodes = len(row)
    padding = -len(forest.roots) % WIDE_VECTOR_WIDTH
    table_value = np.zeros(n_nodes + 1, dtype=np.float32)
    table_link = np.full(n_nodes + 1, n_nodes << WIDE_SLOT_BITS | LEAF_SLOT, dtype=np.uint32)
    table_value[row] = value.astype(np.float32)
    table_link[row] = (left.astype(np.uint32) << WIDE_SLOT_BITS) | slot.astype(np.uint32)
    roots = np.append(row[forest.roots], np.full(padding, n_nodes)).astype(np.uint32)
    if padding == 0:
        table_value, table_link = table_value[:-1], table_link[:-1]
    return ForestTable(
        value=table_value,
        link=table_link,
        roots=roots,
        depth=int(level.max()) + 1,
        leaf_step_n=real(quantised.leaf_step_n),
        bias_n=real(quantised.bias_n),
        leaf_error_n=quantised.error_n,
        leaf=row,
    )
