"""scikit-learn's trees -> the IR's one node table."""

from typing import Any

import numpy as np

from springpot.codegen.errors import UsageError
from springpot.codegen.model.regressors import Forest


def forest_ir(regressor: Any) -> Forest:
    """Node table of a fitted RandomForestRegressor or ExtraTreesRegressor, a mean of trees."""
    trees = [estimator.tree_ for estimator in regressor.estimators_]
    sizes = np.array([tree.node_count for tree in trees])
    feature = np.concatenate([tree.feature for tree in trees]).astype(np.int32)
    leaf = feature < 0
    return Forest(
        feature=np.where(leaf, -1, feature).astype(np.int32),
        threshold=np.where(leaf, 0.0, np.concatenate([tree.threshold for tree in trees])),
        left=_children([tree.children_left for tree in trees], sizes, leaf),
        right=_children([tree.children_right for tree in trees], sizes, leaf),
        value_n=np.concatenate([tree.value[:, 0, 0] for tree in trees]),
        roots=_roots(sizes),
        weight=1.0 / len(trees),
        bias_n=0.0,
    )


def boosted_ir(regressor: Any) -> Forest:
    """Node table of a fitted HistGradientBoostingRegressor: the sum of its trees and its baseline.

    Its trees compare doubles; on features rounded to float32 the decisions are the same.
    """
    trees = [predictor[0].nodes for predictor in regressor._predictors]
    nodes = np.concatenate(trees)
    if np.any(nodes["is_categorical"]):
        raise UsageError("boosted trees with categorical splits: positions are numbers")
    sizes = np.array([len(tree) for tree in trees])
    leaf = nodes["is_leaf"].astype(bool)
    return Forest(
        feature=np.where(leaf, -1, nodes["feature_idx"]).astype(np.int32),
        threshold=np.where(leaf, 0.0, nodes["num_threshold"]),
        left=_children([tree["left"] for tree in trees], sizes, leaf),
        right=_children([tree["right"] for tree in trees], sizes, leaf),
        value_n=np.where(leaf, nodes["value"], 0.0).astype(np.float64),
        roots=_roots(sizes),
        weight=1.0,
        bias_n=float(regressor._baseline_prediction.item()),
    )


def _roots(sizes: np.ndarray[Any, Any]) -> np.ndarray[Any, np.dtype[np.int32]]:
    return np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int32)


def _children(
    children: list[np.ndarray[Any, Any]], sizes: np.ndarray[Any, Any], leaf: np.ndarray[Any, Any]
) -> np.ndarray[Any, np.dtype[np.int32]]:
    rows = np.concatenate(children).astype(np.int64) + np.repeat(_roots(sizes), sizes)
    return np.where(leaf, 0, rows).astype(np.int32)
