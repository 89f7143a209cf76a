"""The two node tables of a forest, as the C has them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Real


@dataclass(frozen=True, eq=False)
class ForestTable:
    """sp_forest_wide.h: node table.

    value: (nodes,) float32; link: (nodes,) uint32; roots: (padded trees,) uint32.
    depth: longest walk in levels. quantum_n: force of one quantum of the sum, N; bias_n: beside it.
    leaf_error_n: greatest rounding of a leaf's force.
    leaf: (IR nodes,) int32, row of each IR node in this table.
    """

    value: NDArray[np.float32]
    link: NDArray[np.uint32]
    roots: NDArray[np.uint32]
    depth: int
    quantum_n: Real
    bias_n: Real
    leaf_error_n: float
    leaf: NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class CompactForest:
    """sp_forest.h: nodes as pairs (step, rank) of uint16.

    top: (15, lanes, 2), by heap position and tree; nodes: (nodes, 2); roots: (lanes,) uint32.
    thresholds: of each used feature, sorted float32; none where features are rounded.
    quantum_n, bias_n: force = bias_n + quantum_n x sum; leaf_error_n: its error by rounding leaves.
    longest_walks: (trees,), splits on the longest way to a leaf of each.
    """

    top: NDArray[np.uint16]
    nodes: NDArray[np.uint16]
    roots: NDArray[np.uint32]
    n_trees: int
    thresholds: tuple[NDArray[np.float32], ...]
    quantum_n: Real
    bias_n: Real
    leaf_error_n: float
    longest_walks: NDArray[np.int64]
