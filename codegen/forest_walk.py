"""Walks through a node table in numpy: what sp_forest.h does, for many samples at once."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.configs import ForestTable
from springpot.codegen.forest_table import LEAF_SLOT, SLOT_BITS

_CHUNK = 4096  # samples whose walk stays in the cache


def forest_leaves(table: ForestTable, features: NDArray[np.float32]) -> NDArray[np.int64]:
    """Rows of the leaves reached: shape (n, padded trees)."""
    leaves = np.empty((len(features), len(table.roots)), dtype=np.int64)
    left = (table.link >> SLOT_BITS).astype(np.int64)
    slot = (table.link & LEAF_SLOT).astype(np.int64)
    inner = slot != LEAF_SLOT
    n_columns = features.shape[1]
    flat = np.ascontiguousarray(features).ravel()
    for tree, root in enumerate(table.roots):
        at = np.full(len(features), root, dtype=np.int64)
        walking = np.arange(len(features)) if inner[root] else np.empty(0, dtype=np.int64)
        while len(walking):
            here = at[walking]
            feature = flat[walking * n_columns + slot[here]]
            here = left[here] + ~(feature <= table.value[here])
            at[walking] = here
            walking = walking[inner[here]]
        leaves[:, tree] = at
    return leaves


def forest_force(table: ForestTable, features: NDArray[np.float32]) -> NDArray[Any]:
    """sp_forest.h: force of each feature vector, N, in the scene's type."""
    force = np.empty(len(features), dtype=type(table.quantum_n))
    value = table.value.astype(np.int32)
    for begin in range(0, len(features), _CHUNK):
        rows = slice(begin, begin + _CHUNK)
        total = value[forest_leaves(table, features[rows])].sum(axis=1, dtype=np.int32)
        force[rows] = table.bias_n + total.astype(force.dtype) * table.quantum_n
    return force
