"""Whether a node table is a set of trees: children in range, no cycle, each node reached once."""

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.errors import DataError
from springpot.codegen.model.regressors import Forest

MAX_DEPTH = 256  # splits on a path; fully grown trees on 50 000 rows have about 45


def require_trees(forest: Forest, n_features: int) -> None:
    """Raise DataError, with the field's name, where traversing the forest could go astray."""
    n = len(forest.feature)
    for name in ("threshold", "left", "right", "value_n"):
        if getattr(forest, name).shape != (n,):
            raise DataError(f"{name}: {getattr(forest, name).shape} for {n} nodes")
    if forest.feature.ndim != 1 or forest.roots.ndim != 1 or not len(forest.roots):
        raise DataError("roots: no list of trees")
    _require_within("feature", forest.feature, -1, n_features)
    for name in ("left", "right", "roots"):  # of leaves too: tables are built by indexing with them
        _require_within(name, getattr(forest, name), 0, n)
    inner = forest.feature >= 0
    children = np.concatenate([forest.left[inner], forest.right[inner], forest.roots])
    times = np.bincount(children, minlength=n)
    if (bad := np.flatnonzero(times != 1)).size:
        raise DataError(f"left, right: node {bad[0]} is reached {times[bad[0]]} times, not once")
    # Every node has one parent: what is still not reached from the roots lies on cycles.
    level, reached = forest.roots, 0
    for _ in range(MAX_DEPTH + 1):
        reached += len(level)
        split = level[inner[level]]
        level = np.concatenate([forest.left[split], forest.right[split]])
        if not len(level):
            break
    else:
        raise DataError(f"left, right: a tree deeper than {MAX_DEPTH} splits")
    if reached != n:
        raise DataError(f"left, right: {n - reached} nodes lie on cycles")


def _require_within(name: str, values: NDArray[np.int32], begin: int, end: int) -> None:
    if values.size and not (values.min() >= begin and values.max() < end):
        bad = int(np.flatnonzero((values < begin) | (values >= end))[0])
        raise DataError(f"{name}: {values[bad]} at {bad} is outside {begin} .. {end - 1}")
