"""Regressors that were fitted elsewhere: sums of trees as node tables, and what is linear."""

import json
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.exceptions import NotFittedError
from sklearn.utils.validation import check_is_fitted

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import UsageError
from springpot.codegen.model.regressors import Forest, Linear
from springpot.codegen.types import JsonObject

_LINEARITY_TOLERANCE = 1e-6  # of the peak force
# Of each node: feature, below 0 of a leaf; threshold; rows of its children; force of a leaf, N.
_NodeTable = tuple[NDArray[Any], ...]


def require_fitted(regressor: Any) -> None:
    """Raise UsageError for what is no fitted regressor."""
    try:
        check_is_fitted(regressor)
    except (NotFittedError, TypeError):
        kind = regressor if isinstance(regressor, type) else type(regressor)
        given = "a regressor"
        if kind.__name__ == "Booster":  # of lightgbm and xgboost themselves
            given = "LGBMRegressor or XGBRegressor, which hold one,"
        raise UsageError(f"{kind.__name__}: give {given} fitted on ensemble_data") from None


def convert_linear(regressor: Any, values: Samples, predicted_n: Samples) -> Linear | None:
    """Return intercept and weights of a regressor that is linear in its features; else None.

    Asked by its predictions alone: at 0, at each unit vector, and compared at `values`, (n,
    features), with predicted_n, (n,).
    """
    n_features = values.shape[1]
    probes = np.concatenate([np.zeros((1, n_features)), np.eye(n_features)])
    response_n = np.asarray(regressor.predict(probes), dtype=np.float64)
    linear = Linear(float(response_n[0]), response_n[1:] - response_n[0])
    differs = np.abs(linear.intercept_n + values @ linear.weights_n - predicted_n)
    return linear if differs.max() <= _LINEARITY_TOLERANCE * np.abs(predicted_n).max() else None


def convert_ensemble(regressor: Any) -> Forest:
    """Node table of a fitted ensemble. Raises KeyError for a kind without trees."""
    return _CONVERTERS[type(regressor).__name__](regressor)


def convert_forest(regressor: Any) -> Forest:
    """Read the mean of a fitted forest's trees, or one tree."""
    trees = _read_sklearn_trees(getattr(regressor, "estimators_", [regressor]))
    return _merge_trees(trees, 1.0 / len(trees))


def _convert_bagging(regressor: Any) -> Forest:
    """Convert a mean of trees, each of which was fitted on features of its own."""
    kinds = {type(estimator).__name__ for estimator in regressor.estimators_}
    if not kinds <= {"DecisionTreeRegressor", "ExtraTreeRegressor"}:
        raise UsageError(f"BaggingRegressor of {', '.join(sorted(kinds))}: give one of trees")
    trees = []
    tables_and_columns = zip(
        _read_sklearn_trees(regressor.estimators_), regressor.estimators_features_, strict=True
    )
    for (feature, *others), columns in tables_and_columns:
        trees.append((np.where(feature < 0, -1, columns[np.maximum(feature, 0)]), *others))
    return _merge_trees(trees, 1.0 / len(trees))


def _convert_gradient_boosting(regressor: Any) -> Forest:
    """A constant, unless it begins at 0, and a sum of trees, each by the learning rate."""
    bias_n = getattr(regressor.init_, "constant_", np.zeros(1)).item()
    return _merge_trees(
        _read_sklearn_trees(regressor.estimators_[:, 0]), float(regressor.learning_rate), bias_n
    )


def _convert_hist_gradient_boosting(regressor: Any) -> Forest:
    """Convert its baseline and trees.

    Their thresholds are doubles, and features are float32 here: both compare alike.
    """
    trees: list[_NodeTable] = []
    for nodes in (predictor[0].nodes for predictor in regressor._predictors):
        feature = np.where(nodes["is_leaf"], -1, nodes["feature_idx"])
        value_n = np.where(nodes["is_leaf"], nodes["value"], 0.0)
        trees.append((feature, nodes["num_threshold"], nodes["left"], nodes["right"], value_n))
    return _merge_trees(trees, 1.0, regressor._baseline_prediction.item())


def _convert_lightgbm(regressor: Any) -> Forest:
    """Convert a sum of trees, or the mean of a forest's."""
    dump = regressor.booster_.dump_model()
    trees = [_parse_tree(tree["tree_structure"]) for tree in dump["tree_info"]]
    if dump["average_output"]:
        return _merge_trees(trees, 1.0 / len(trees))
    # The first tree's leaves hold the mean force too, which would widen the steps of all leaves.
    *first, value_n = trees[0]
    trees[0] = (*first, value_n - value_n[-1])
    return _merge_trees(trees, 1.0, float(value_n[-1]))


def _convert_xgboost(regressor: Any) -> Forest:
    """Convert its trees, up to the best one if it stopped early, and its base score."""
    stopped = hasattr(regressor, "best_iteration")
    booster = regressor.get_booster()[: regressor.best_iteration + 1 if stopped else None]
    dump = booster.get_dump(dump_format="json")
    return _merge_trees(
        [_parse_tree(json.loads(tree)) for tree in dump], 1.0, regressor.intercept_.item()
    )


def _parse_tree(tree: JsonObject) -> _NodeTable:
    """Read a tree's JSON, by LightGBM or by XGBoost, which goes left only below a threshold."""
    rows: list[tuple[Any, ...]] = []

    def add(node: JsonObject) -> int:
        """Append a node and what is below it; return its row."""
        row = len(rows)
        rows.append((-1, 0.0, 0, 0, node.get("leaf", node.get("leaf_value", 0.0))))
        if "split" in node:
            below = np.nextafter(np.float32(node["split_condition"]), np.float32(-np.inf))
            rows[row] = (int(node["split"][1:]), below, *map(add, node["children"]), 0.0)
        elif "split_feature" in node:
            if node["decision_type"] != "<=" or node["missing_type"] == "Zero":
                raise UsageError("LGBMRegressor has categories, or 0 is missing: fit it without")
            children = add(node["left_child"]), add(node["right_child"])
            rows[row] = (node["split_feature"], node["threshold"], *children, 0.0)
        return row

    add(tree)
    return tuple(np.array(rows).T)


def _convert_pipeline(pipeline: Any) -> Forest:
    """Convert trees behind scalers of single columns, by moving the trees' thresholds."""
    *before, (_, last) = pipeline.steps
    forest = convert_ensemble(last)
    for name, step in reversed(before):
        if step in ("passthrough", None):
            continue
        zero, gain = probe_scaler(name, step)
        column = np.maximum(forest.feature, 0)
        threshold = (forest.threshold - zero[column]) / gain[column]
        forest = replace(forest, threshold=np.where(forest.feature < 0, 0.0, threshold))
    return forest


def probe_scaler(name: str, step: Any) -> tuple[Samples, Samples]:
    """Zero and gain > 0, (columns,), of a step z = zero + gain x. Raises UsageError for others."""
    columns = step.n_features_in_
    probes = np.concatenate([np.zeros((1, columns)), np.eye(columns), np.full((1, columns), 0.37)])
    response = np.asarray(step.transform(probes))
    offset = response[0]
    gain = response[1:-1] - offset
    if gain.shape != (columns, columns) or not (
        np.allclose(gain, np.diag(np.diag(gain)))
        and np.all(np.diag(gain) > 0.0)
        and np.allclose(response[-1], offset + 0.37 * np.diag(gain))
    ):
        raise UsageError(
            f"Pipeline: its step {name} is no scaling of single columns: fit the trees without it"
        )
    return offset, np.diag(gain)


def vote_shares(voting: Any) -> Samples:
    """Share of each regressor of a vote, which sum to 1."""
    shares = voting._weights_not_none or np.ones(len(voting.estimators_))
    return np.asarray(shares, dtype=np.float64) / np.sum(shares)


def probe_target(regressor: Any) -> tuple[float, float]:
    """Zero and gain of the force over the inner regressor's. Raises UsageError for other laws."""
    probes = np.array([0.0, 1.0, 0.37, -2.0])
    force_n = np.ravel(regressor.transformer_.inverse_transform(probes[:, None]))
    zero, gain = force_n[0], force_n[1] - force_n[0]
    if not np.allclose(force_n, zero + gain * probes):
        raise UsageError("TransformedTargetRegressor: its transform of the force is no scaling")
    return float(zero), float(gain)


def _convert_voting(regressor: Any) -> Forest:
    """One node table of all their trees: a share goes into the leaves."""
    parts = list(
        zip(vote_shares(regressor), map(convert_ensemble, regressor.estimators_), strict=True)
    )
    tables: list[_NodeTable] = [
        (part.feature, part.threshold, part.left, part.right, share * part.weight * part.value_n)
        for share, part in parts
    ]
    merged = _merge_trees(tables, 1.0, float(sum(share * part.bias_n for share, part in parts)))
    roots = [first + part.roots for first, (_, part) in zip(merged.roots, parts, strict=True)]
    return replace(merged, roots=np.concatenate(roots).astype(np.int32))


def _convert_target(regressor: Any) -> Forest:
    """Trees fitted on a scaled force."""
    zero, gain = probe_target(regressor)
    inner = convert_ensemble(regressor.regressor_)
    return replace(inner, value_n=gain * inner.value_n, bias_n=zero + gain * inner.bias_n)


def _read_sklearn_trees(estimators: Iterable[Any]) -> list[_NodeTable]:
    """Tables of scikit-learn's fitted trees."""
    return [
        (tree.feature, tree.threshold, tree.children_left, tree.children_right, tree.value[:, 0, 0])
        for tree in (estimator.tree_ for estimator in estimators)
    ]


def _merge_trees(trees: list[_NodeTable], weight: float, bias_n: float = 0.0) -> Forest:
    """Put trees into one table of nodes: children are rows of the whole table."""
    sizes = [len(feature) for feature, *_ in trees]
    roots = np.cumsum([0, *sizes[:-1]])
    feature, threshold, left, right, value_n = map(np.concatenate, zip(*trees, strict=True))
    leaf, first = feature < 0, np.repeat(roots, sizes)
    return Forest(
        feature=np.where(leaf, -1, feature).astype(np.int32),
        threshold=np.where(leaf, 0.0, threshold),
        left=np.where(leaf, 0, left + first).astype(np.int32),
        right=np.where(leaf, 0, right + first).astype(np.int32),
        value_n=value_n,
        roots=roots.astype(np.int32),
        weight=weight,
        bias_n=bias_n,
    )


_CONVERTERS = {
    "RandomForestRegressor": convert_forest,
    "ExtraTreesRegressor": convert_forest,
    "DecisionTreeRegressor": convert_forest,
    "ExtraTreeRegressor": convert_forest,
    "BaggingRegressor": _convert_bagging,
    "GradientBoostingRegressor": _convert_gradient_boosting,
    "HistGradientBoostingRegressor": _convert_hist_gradient_boosting,
    "LGBMRegressor": _convert_lightgbm,
    "XGBRegressor": _convert_xgboost,
    "XGBRFRegressor": _convert_xgboost,
    "Pipeline": _convert_pipeline,
    "VotingRegressor": _convert_voting,
    "TransformedTargetRegressor": _convert_target,
}
