"""scikit-learn's trees -> the IR's one node table."""

from typing import Any

import numpy as np

from springpot.codegen.ir import Forest


def forest_ir(regressor: Any) -> Forest:
    """Node table of a fitted RandomForestRegressor or ExtraTreesRegressor."""
    trees = [estimator.tree_ for estimator in regressor.estimators_]
    sizes = np.array([tree.node_count for tree in trees])
    roots = np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int32)
    shift = np.repeat(roots, sizes)
    feature = np.concatenate([tree.feature for tree in trees]).astype(np.int32)
    leaf = feature < 0

    def child(side: str) -> np.ndarray[Any, np.dtype[np.int32]]:
        rows = np.concatenate([getattr(tree, side) for tree in trees])
        return np.where(leaf, 0, rows + shift).astype(np.int32)

    return Forest(
        feature=np.where(leaf, -1, feature).astype(np.int32),
        threshold=np.where(leaf, 0.0, np.concatenate([tree.threshold for tree in trees])),
        left=child("children_left"),
        right=child("children_right"),
        value_n=np.concatenate([tree.value[:, 0, 0] for tree in trees]),
        roots=roots,
    )
