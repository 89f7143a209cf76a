"""Kind `auto`: the candidate of least cross-validated error; the validation data is never seen."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import HistGradientBoostingRegressor

from springpot.trainer.features.values import Samples
from springpot.trainer.models.fit import PAPER_LEAF, Fit, FitOptions
from springpot.trainer.models.folds import Folds, condition_folds, geometric_mean, recording_folds
from springpot.trainer.models.forests import depth_scale, fitted_forest
from springpot.trainer.models.hammerstein import (
    HYBRID_LEAF,
    HYBRID_TREES,
    choices,
    derivative_features,
    fit_hammerstein,
    fit_hybrid,
    lag_features,
    term_columns,
)
from springpot.trainer.models.nonnegative import normal_equations
from springpot.trainer.models.passive_terms import standard_terms
from springpot.trainer.models.rbf import fit_rbf_fd
from springpot.trainer.models.rf_fd import fit_boosted_fd, fit_rf_fd, fractional_features
from springpot.trainer.models.training_set import TrainingSet

NEARLY = 1.005  # of the least error: the cheaper of two within it is taken
ALIKE = 5e-4  # of the greatest force: what no sensor and no hand tells apart counts as within it
_ROWS = 10_000  # of each fit under cross-validation
_TREES = 40

Predict = Callable[[Samples], Samples]
_FitWhole = Callable[[str, TrainingSet, FitOptions], Fit]


@dataclass(frozen=True, eq=False)
class Candidate:
    """One way to fit: `values` of the search's rows, `learn` on some of them, `fit` on all data.

    cost: rank of its time in C, the lower the cheaper.
    """

    name: str
    cost: int
    values: Callable[[], Samples]
    learn: Callable[[Samples, Samples], Predict]
    fit: _FitWhole


@dataclass(frozen=True)
class Score:
    """Geometric mean of a candidate's held-out RMSEs, N: recordings, conditions, and both."""

    name: str
    cost: int
    recordings_n: float
    conditions_n: float
    mean_n: float


def fit_auto(name: str, data: TrainingSet, options: FitOptions) -> Fit:
    """Fit the best candidate on all training recordings; the table of scores is in its facts."""
    begin = time.perf_counter()
    rows = _search_rows(data, options.seed)
    folds = [recording_folds(data, rows, options.seed)]
    by_condition = condition_folds(data, rows, options.seed)
    folds += [by_condition] if by_condition is not None else []
    known = candidates(data, rows, options)
    force_n = data.force_n(rows)
    scores = [_score(candidate, force_n, folds) for candidate in known]
    best = choose(scores, max(abs(data.trained.greatest_n), abs(data.trained.least_n)))
    search_s = time.perf_counter() - begin
    fit = next(c for c in known if c.name == best.name).fit(name, data, options)
    facts = {**fit.facts, "chosen": best.name, "scores": [vars(score) for score in scores]}
    return Fit(fit.model, fit.rows, fit.feature_s, fit.fit_s, search_s, facts)


def choose(scores: list[Score], peak_n: float) -> Score:
    """The cheapest of those within half a per cent of the least error, or of a felt nothing."""
    least = min(score.mean_n for score in scores)
    most = max(NEARLY * least, least + ALIKE * peak_n)
    near = [score for score in scores if score.mean_n <= most]
    return min(near, key=lambda score: (score.cost, score.mean_n))


def candidates(data: TrainingSet, rows: NDArray[np.intp], options: FitOptions) -> list[Candidate]:
    """Hammerstein with both bases, hybrids on both features, and the paper's models.

    rows: of the search; what several candidates see of them is computed once.
    """
    scale = depth_scale(_span_m(data))
    short, long = fractional_features(data.dt_s, options.window_s), derivative_features(data)
    lags = lag_features(data)
    seen = {each: cache(partial(data.features, each, rows)) for each in (short, long, lags)}
    found = []
    for choice in choices(data):
        terms = standard_terms(data, *choice)
        label = f"{choice[0]}{' bias' if choice[1] else ''}"
        passive = cache(partial(term_columns, terms, data, rows))
        fit: _FitWhole = partial(fit_hammerstein, among=[choice])
        found.append(Candidate(f"hammerstein {label}", 1, passive, _learn_passive, fit))
        for how, features in (("lags", lags), ("derivatives", long)):
            values = partial(_side_by_side, passive, seen[features])
            learn = partial(_learn_hybrid, terms.count, scale=scale)
            fit = partial(fit_hybrid, features=features, among=[choice])
            found.append(Candidate(f"hybrid {how}, {label}", 4, values, learn, fit))
    trees = partial(_learn_trees, scale=scale, seed=options.seed)
    boosted = partial(_learn_boosted, scale=scale, seed=options.seed)
    fit_long = partial(fit_rf_fd, features=long)
    return [
        *found,
        Candidate("rf-fd", 5, seen[short], trees, fit_rf_fd),
        Candidate("rf-fd long", 6, seen[long], trees, fit_long),
        Candidate("boosted", 3, seen[short], boosted, fit_boosted_fd),
        Candidate("rbf-fd", 2, seen[short], _learn_rbf, fit_rbf_fd),
    ]


def _search_rows(data: TrainingSet, seed: int) -> NDArray[np.intp]:
    return data.rows(min(1.0, _ROWS / data.rows_total), seed)


def _score(candidate: Candidate, force_n: Samples, folds: list[Folds]) -> Score:
    values = candidate.values()
    means = []
    for fold in folds:
        errors = []
        for number in fold.tested:
            held = fold.number == number
            if held.all() or not held.any():
                continue
            predict = candidate.learn(values[~held], force_n[~held])
            errors.append(rms(predict(values[held]) - force_n[held]))
        means.append(geometric_mean(errors))
    return Score(candidate.name, candidate.cost, means[0], means[-1], geometric_mean(means))


def rms(values: Samples) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def _span_m(data: TrainingSet) -> float:
    return data.trained.greatest_m - min(data.trained.least_m, 0.0)


def _side_by_side(one: Callable[[], Samples], other: Callable[[], Samples]) -> Samples:
    return np.concatenate([one(), other()], axis=1)


def _learn_passive(values: Samples, force_n: Samples) -> Predict:
    weights = normal_equations(values, force_n).solve()
    return lambda held: held @ weights


def _learn_hybrid(n_terms: int, values: Samples, force_n: Samples, scale: float) -> Predict:
    passive = _learn_passive(values[:, :n_terms], force_n)
    residual_n = force_n - passive(values[:, :n_terms])
    forest = fitted_forest(HYBRID_TREES, HYBRID_LEAF, 0, scale * values[:, n_terms:], residual_n)
    return lambda held: passive(held[:, :n_terms]) + forest.predict(scale * held[:, n_terms:])


def _learn_trees(values: Samples, force_n: Samples, scale: float, seed: int) -> Predict:
    forest = fitted_forest(_TREES, PAPER_LEAF, seed, scale * values, force_n)
    return lambda held: forest.predict(scale * held)


def _learn_boosted(values: Samples, force_n: Samples, scale: float, seed: int) -> Predict:
    trees = HistGradientBoostingRegressor(max_depth=4, random_state=seed, early_stopping=False)
    trees.fit(scale * values, force_n)
    return lambda held: trees.predict(scale * held)


def _learn_rbf(values: Samples, force_n: Samples) -> Predict:
    from springpot.trainer.models.radial import fit_rbf, rbf_force

    pair = values[:, [0, 3]]
    rbf, _ = fit_rbf(pair, force_n, 100, "farthest")
    return lambda held: rbf_force(rbf, held[:, [0, 3]])
