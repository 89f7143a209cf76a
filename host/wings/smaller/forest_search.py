"""The smallest forest whose cross-validated error is within a given loss of the one asked for.

What costs no error is taken first: 16-bit features, which need no thresholds, and the
window by exponentials. Then larger leaves, fewer trees and fewer orders are tried.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot import Fit, FitOptions, Recording, UsageError
from springpot.basics import Samples
from springpot.modelling import (
    KINDS,
    MAX_TAPS,
    PAPER_ORDERS,
    PAPER_TAPS,
    TrainingSet,
    depth_m,
    feature_values,
    fractional_features,
    quantisation_over,
    random_forest,
    recording_folds,
    rounded,
    window_samples,
)

_TREES = (0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0)  # of the trees asked for
_LEAVES = (1, 2, 4, 8, 16)  # times the leaf asked for
_ORDERS = (3, 4, 5, 7)
_ROWS = 10_000
_FOLDS = 3


@dataclass(frozen=True)
class Size:
    """One size: its held-out error, and its nodes as the mean over the folds."""

    trees: int
    leaf: int
    orders: tuple[float, ...]
    rmse_n: float
    nodes: int


@dataclass(frozen=True)
class Search:
    """asked: the size that was asked for; tried: all; options: of the smallest within the loss."""

    asked: Size
    chosen: Size
    tried: tuple[Size, ...]
    options: FitOptions

    def metadata(self) -> dict[str, Any]:
        """Size that was asked for and the one that came out, for the command line."""
        return {"asked": asdict(self.asked), "reduced": asdict(self.chosen)}


def fit_reduced(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording]
) -> Fit:
    """The smallest forest within `options.within` of the error of the one asked for."""
    begin = time.perf_counter()
    search = reduced_options(data, options, options.within or 0.0, validation)
    search_s = time.perf_counter() - begin
    fit: Fit = KINDS["rf-fd"].function()(name, data, search.options)
    return replace(fit, search_s=search_s, metadata={**fit.metadata, **search.metadata()})


def reduced_options(
    data: TrainingSet, options: FitOptions, loss: float, validation: Sequence[Recording]
) -> Search:
    """Search by cross-validation over recordings; with options.select "paper", on `validation`.

    Raises UsageError where validation recordings are needed and there are none.
    """
    if options.select == "paper" and not validation:
        raise UsageError("--select paper needs validation recordings: give --validate REC")
    engine = options.engine
    if engine is None and _length(data, options) <= MAX_TAPS:
        engine = "fir-fast"
    options = replace(options, engine=engine, round_features=True)
    evaluation = validation if options.select == "paper" else ()
    orders = options.orders or PAPER_ORDERS
    tried = list(_sizes(data, options, orders, _LEAVES, evaluation))
    asked = next(
        size for size in tried if size.trees == options.trees and size.leaf == options.leaf
    )
    allowed_n = (1.0 + loss) * asked.rmse_n
    best = _smallest(tried, allowed_n)
    ranked = _by_importance(data, replace(options, leaf=best.leaf), orders)
    for count in _ORDERS:
        if count < len(orders):
            fewer = tuple(sorted(ranked[:count]))
            tried += _sizes(data, options, fewer, (best.leaf / options.leaf,), evaluation)
    best = _smallest(tried, allowed_n)
    chosen = replace(options, trees=best.trees, leaf=best.leaf, orders=best.orders)
    return Search(asked, best, tuple(tried), chosen)


def _smallest(tried: Sequence[Size], allowed_n: float) -> Size:
    """Fewest nodes within the error; nodes are what a tick reads and what a table holds."""
    return min((size for size in tried if size.rmse_n <= allowed_n), key=lambda size: size.nodes)


def _length(data: TrainingSet, options: FitOptions) -> int:
    window_s = options.window_s
    return PAPER_TAPS if window_s is None else window_samples(window_s, data.dt_s)


@dataclass(frozen=True, eq=False)
class _Trial:
    """One fit and what it is evaluated on: binned features (rows, orders) and forces (rows,), N."""

    values: NDArray[np.float32]
    force_n: Samples
    tested: NDArray[np.float32]
    tested_n: Samples


def _trials(
    data: TrainingSet,
    options: FitOptions,
    orders: tuple[float, ...],
    evaluation: Sequence[Recording],
) -> list[_Trial]:
    """Folds of whole recordings; or all rows, evaluated on recordings of their own."""
    rows = data.rows(options.fraction, options.seed)
    rows = rows[:: -(-len(rows) // _ROWS)]
    bank = fractional_features(data.dt_s, options.window_s, options.engine, orders)
    values, force_n = data.features(bank, rows), data.force_n(rows)
    quantisation = quantisation_over(values)
    steps = rounded(quantisation, values)
    if evaluation:
        tested = [
            feature_values(
                bank, depth_m(item, data.contact), item.dt_s, np.arange(len(item.force_n))
            )
            for item in evaluation
        ]
        tested_n = np.concatenate([item.force_n for item in evaluation])
        return [_Trial(steps, force_n, rounded(quantisation, np.concatenate(tested)), tested_n)]
    folds = recording_folds(data, rows, options.seed)
    held = [folds.number == fold for fold in folds.tested[:_FOLDS]]
    return [_Trial(steps[~out], force_n[~out], steps[out], force_n[out]) for out in held]


def _sizes(
    data: TrainingSet,
    options: FitOptions,
    orders: tuple[float, ...],
    leaves: Sequence[float],
    evaluation: Sequence[Recording],
) -> Iterator[Size]:
    """Error of every number of trees and size of leaf; one fit a leaf and trial."""
    trials = _trials(data, options, orders, evaluation)
    counts = sorted({max(1, round(share * options.trees)) for share in _TREES})
    for times in leaves:
        leaf = max(1, round(options.leaf * times))
        squares = np.zeros(len(counts))
        nodes = np.zeros(len(counts))
        for trial in trials:
            forest = random_forest(options.trees, leaf, options.seed)
            forest.fit(trial.values, trial.force_n)
            by_tree = np.stack([tree.predict(trial.tested) for tree in forest.estimators_])
            means = np.cumsum(by_tree, axis=0) / np.arange(1, len(by_tree) + 1)[:, None]
            sizes = np.cumsum([tree.tree_.node_count for tree in forest.estimators_])
            for i, count in enumerate(counts):
                squares[i] += np.sum((means[count - 1] - trial.tested_n) ** 2)
                nodes[i] += sizes[count - 1] / len(trials)
        errors_n = np.sqrt(squares / sum(len(trial.tested_n) for trial in trials))
        for count, error_n, size in zip(counts, errors_n, nodes, strict=True):
            yield Size(count, leaf, orders, float(error_n), round(size))


def _by_importance(
    data: TrainingSet, options: FitOptions, orders: tuple[float, ...]
) -> list[float]:
    rows = data.rows(options.fraction, options.seed)
    bank = fractional_features(data.dt_s, options.window_s, options.engine, orders)
    values = data.features(bank, rows)
    steps = rounded(quantisation_over(values), values)
    forest = random_forest(options.trees, options.leaf, options.seed).fit(steps, data.force_n(rows))
    ranking = np.argsort(-forest.feature_importances_)
    return [orders[i] for i in ranking]
