"""Constants of the C units, in the scene's number type: what is emitted and what is checked.

Each class is one unit's config struct; its fields are the struct's members, in order.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Real = np.float32 | np.float64
RealArray = NDArray[Any]


@dataclass(frozen=True)
class GuardConfig:
    """sp_guard.h."""

    jump_m: Real
    least_m: Real
    greatest_m: Real
    resync_ticks: int


@dataclass(frozen=True)
class RangeConfig:
    """sp_range.h."""

    least_m: Real
    greatest_m: Real


@dataclass(frozen=True, eq=False)
class CoupleConfig:
    """sp_couple.h; phi: shape (4,), the 2 x 2 matrix row by row."""

    stiffness_npm: Real
    damping_nspm: Real
    compliance_mpn: Real
    dt_s: Real
    phi: RealArray


@dataclass(frozen=True)
class OutputConfig:
    """sp_output.h."""

    least_n: Real
    greatest_n: Real
    slew_n: Real
    rise: Real
    fall_nps: Real
    watchdog_s: Real
    dt_s: Real


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
    longest_walk: splits on the longest way to a leaf.
    """

    top: NDArray[np.uint16]
    nodes: NDArray[np.uint16]
    roots: NDArray[np.uint32]
    n_trees: int
    thresholds: tuple[NDArray[np.float32], ...]
    quantum_n: Real
    bias_n: Real
    leaf_error_n: float
    longest_walk: int
