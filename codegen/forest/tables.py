"""The two node tables of a forest, as the C has them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Real


@dataclass(frozen=True, eq=False)
class ForestTable:
    """sp_forest_wide.h: node table.

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


@dataclass(frozen=True, eq=False)
class CompactForest:
    """sp_forest.h: nodes as pairs (step, bin) of uint16.

    top: (15, padded trees, 2), by heap position and tree; nodes: (nodes, 2); roots: (padded
    trees,) uint32.
    thresholds: of each used feature, sorted float32; none where features are quantised.
    leaf_step_n, bias_n: force = bias_n + leaf_step_n x sum; leaf_error_n: max error of that,
    leaves being quantised.
    longest_paths: (trees,), splits on the longest way to a leaf of each.
    """

    top: NDArray[np.uint16]
    nodes: NDArray[np.uint16]
    roots: NDArray[np.uint32]
    n_trees: int
    thresholds: tuple[NDArray[np.float32], ...]
    leaf_step_n: Real
    bias_n: Real
    leaf_error_n: float
    longest_paths: NDArray[np.int64]
