"""Node tables of tree ensembles that scikit-learn fitted: sums of trees, exact."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from sklearn.dummy import DummyRegressor
from sklearn.exceptions import NotFittedError
from sklearn.utils.validation import check_is_fitted

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import UsageError
from springpot.codegen.model.regressors import Forest

_SEARCHES = ("GridSearchCV", "RandomizedSearchCV", "HalvingGridSearchCV")


def ensemble_ir(regressor: Any) -> Forest:
    """Node table of an ensemble that was fitted elsewhere. Raises UsageError for other kinds."""
    kind = regressor.__name__ if isinstance(regressor, type) else type(regressor).__name__
    if kind not in _MADE_OF:
        instead = ", here its best_estimator_" if kind in _SEARCHES else ""
        raise UsageError(
            f"{kind}: is no sum of trees: give a fitted {', '.join(sorted(_MADE_OF)[:-1])} or "
            f"{max(_MADE_OF)}{instead}"
        )
    try:
        if isinstance(regressor, type):
            raise NotFittedError
        check_is_fitted(regressor)
    except NotFittedError:
        raise UsageError(f"{kind}: is not fitted: fit it on ensemble_data first") from None
    return _MADE_OF[kind](regressor)


def forest_ir(regressor: Any) -> Forest:
    """Of a fitted RandomForestRegressor or ExtraTreesRegressor: a mean of trees."""
    trees = [estimator.tree_ for estimator in regressor.estimators_]
    return _sum_of(trees, 1.0 / len(trees), 0.0)


def _tree(regressor: Any) -> Forest:
    return _sum_of([regressor.tree_], 1.0, 0.0)


def _bagging(regressor: Any) -> Forest:
    """A mean of trees, each on features of its own."""
    kinds = {type(estimator).__name__ for estimator in regressor.estimators_}
    if not kinds <= {"DecisionTreeRegressor", "ExtraTreeRegressor"}:
        raise UsageError(f"BaggingRegressor of {', '.join(sorted(kinds))}: give one of trees")
    trees = [estimator.tree_ for estimator in regressor.estimators_]
    return _sum_of(trees, 1.0 / len(trees), 0.0, regressor.estimators_features_)


def _gradient_boosting(regressor: Any) -> Forest:
    """A constant and a sum of trees, each by the learning rate."""
    init = regressor.init_
    if not isinstance(init, DummyRegressor | str):
        raise UsageError(
            f"GradientBoostingRegressor begins with {type(init).__name__}: leave init out"
        )
    bias_n = 0.0 if isinstance(init, str) else float(init.constant_.item())
    trees = [estimator.tree_ for estimator in regressor.estimators_[:, 0]]
    return _sum_of(trees, float(regressor.learning_rate), bias_n)


def _hist_gradient_boosting(regressor: Any) -> Forest:
    """The sum of its trees and its baseline.

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


def _pipeline(pipeline: Any) -> Forest:
    """Trees after scalers of single columns, which fold into the thresholds."""
    *before, (_, last) = pipeline.steps
    forest = ensemble_ir(last)
    for name, step in reversed(before):
        if step in ("passthrough", None):
            continue
        zero, gain = _affine(name, step)
        column = np.maximum(forest.feature, 0)
        threshold = (forest.threshold - zero[column]) / gain[column]
        forest = replace(forest, threshold=np.where(forest.feature < 0, 0.0, threshold))
    return forest


def _affine(name: str, step: Any) -> tuple[Samples, Samples]:
    """z = zero + gain x of a step, both (columns,). Raises UsageError if it is anything else."""
    columns = step.n_features_in_
    tried = np.concatenate([np.zeros((1, columns)), np.eye(columns), np.full((1, columns), 0.37)])
    found = np.asarray(step.transform(tried))
    zero = found[0]
    gain = found[1:-1] - zero
    if gain.shape != (columns, columns) or not (
        np.allclose(gain, np.diag(np.diag(gain)))
        and np.all(np.diag(gain) > 0.0)
        and np.allclose(found[-1], zero + 0.37 * np.diag(gain))
    ):
        raise UsageError(
            f"Pipeline: its step {name} is no scaling of single columns: fit the trees without it"
        )
    return zero, np.diag(gain)


def _sum_of(
    trees: Sequence[Any], weight: float, bias_n: float, columns: Sequence[Any] | None = None
) -> Forest:
    """Trees of scikit-learn in one table; columns: of the features that each tree sees."""
    sizes = np.array([tree.node_count for tree in trees])
    found = [tree.feature for tree in trees]
    if columns is not None:
        pairs = zip(found, columns, strict=True)
        found = [np.where(its < 0, -1, np.asarray(seen)[np.maximum(its, 0)]) for its, seen in pairs]
    feature = np.concatenate(found).astype(np.int32)
    leaf = feature < 0
    return Forest(
        feature=np.where(leaf, -1, feature).astype(np.int32),
        threshold=np.where(leaf, 0.0, np.concatenate([tree.threshold for tree in trees])),
        left=_children([tree.children_left for tree in trees], sizes, leaf),
        right=_children([tree.children_right for tree in trees], sizes, leaf),
        value_n=np.concatenate([tree.value[:, 0, 0] for tree in trees]),
        roots=_roots(sizes),
        weight=weight,
        bias_n=bias_n,
    )


def _roots(sizes: np.ndarray[Any, Any]) -> np.ndarray[Any, np.dtype[np.int32]]:
    return np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int32)


def _children(
    children: list[np.ndarray[Any, Any]], sizes: np.ndarray[Any, Any], leaf: np.ndarray[Any, Any]
) -> np.ndarray[Any, np.dtype[np.int32]]:
    rows = np.concatenate(children).astype(np.int64) + np.repeat(_roots(sizes), sizes)
    return np.where(leaf, 0, rows).astype(np.int32)


_MADE_OF = {
    "RandomForestRegressor": forest_ir,
    "ExtraTreesRegressor": forest_ir,
    "DecisionTreeRegressor": _tree,
    "ExtraTreeRegressor": _tree,
    "BaggingRegressor": _bagging,
    "GradientBoostingRegressor": _gradient_boosting,
    "HistGradientBoostingRegressor": _hist_gradient_boosting,
    "Pipeline": _pipeline,
}
