"""Kind `hammerstein`, the fallback of every other kind, and `hybrid`."""

import time
from collections.abc import Sequence
from functools import reduce
from operator import add

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.model.features import Features, Lags
from springpot.codegen.model.model import Basis, Hammerstein
from springpot.trainer.features.exponentials import recursive_bank
from springpot.trainer.models.fit import Fit, FitOptions, assemble
from springpot.trainer.models.folds import Folds, recording_folds
from springpot.trainer.models.forests import depth_scale, fit_forest
from springpot.trainer.models.nonnegative import Normal, normal_equations, sparse_solve
from springpot.trainer.models.passive_terms import (
    Terms,
    columns,
    hammerstein_force,
    parameter_count,
    standard_terms,
    to_model,
)
from springpot.trainer.models.rf_fd import PAPER_ORDERS
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording

SPARSE_LOSS = 0.005
BASES: tuple[Basis, ...] = ("powers", "ramps")
HYBRID_TREES = 50
HYBRID_LEAF = 20
N_LAGS = 8
MAX_LAG = 8192  # samples: a ring of 32 kB in float32


def term_columns(terms: Terms, data: TrainingSet, rows: np.ndarray) -> Samples:
    """Values of all terms at rows of all recordings, (rows, terms)."""
    return data.along(rows, lambda depth, at: columns(terms, depth, data.dt_s, at))


BasisChoice = tuple[Basis, bool]  # basis, and whether a bias is fitted


def choices(data: TrainingSet) -> tuple[BasisChoice, ...]:
    """Every basis, with and without a bias; at a surface the force is 0 by itself: no bias."""
    biases = (False,) if data.contact == "surface" else (False, True)
    return tuple((kind, bias) for kind in BASES for bias in biases)


def fit_passive(data: TrainingSet, options: FitOptions) -> tuple[Hammerstein, int, float]:
    """Fit every choice; keep the one of lowest cross-validated error.

    Returns the model, the rows used, and its cross-validated RMSE, N.
    """
    return _timed_passive(data, options)[0]


def _timed_passive(
    data: TrainingSet, options: FitOptions
) -> tuple[tuple[Hammerstein, int, float], float]:
    """`fit_passive` and its seconds, once for the options that decide it."""
    key = ("passive", options.fraction, options.seed, options.poles)
    return data.once(key, lambda: _fit_passive(data, options))


def _fit_passive(data: TrainingSet, options: FitOptions) -> tuple[Hammerstein, int, float]:
    rows = data.many_rows() if options.fraction is None else data.rows(options.fraction, 0)
    force_n = data.force_n(rows)
    folds = recording_folds(data, rows, options.seed)
    best: tuple[float, Terms, Normal] | None = None
    for kind, bias in choices(data):
        terms = standard_terms(data, kind, bias, options.poles)
        parts = _fold_equations(term_columns(terms, data, rows), force_n, folds)
        error = _cross_validated(parts, folds)
        if best is None or error < best[0]:
            best = (error, terms, _sum(parts))
    assert best is not None
    error, terms, normal = best
    return to_model(terms, sparse_solve(normal, SPARSE_LOSS)), len(rows), error


def fit_hammerstein(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Kind `hammerstein`: 15 to 100 numbers, passive in the large."""
    fitted, fit_s = _timed_passive(data, options)
    passive, rows, error = fitted
    n_parameters = parameter_count(passive)
    metadata = {"n_parameters": n_parameters, "cv_rmse_n": error, "basis": passive.basis}
    model = assemble(
        "hammerstein", name, data, options, rows, (None, None), passive, True, metadata
    )
    return Fit(model, rows, feature_s=0.0, fit_s=fit_s, metadata=metadata)


def lag_features(data: TrainingSet) -> Lags:
    """The depth, and its change over eight log-spaced lags."""
    longest = max(2, min(round(data.longest_s / data.dt_s / 4), MAX_LAG))
    lags = np.unique(np.round(np.geomspace(1, longest, N_LAGS)).astype(int))
    return Lags(samples=(0, *lags.tolist()), difference=True)


def derivative_features(data: TrainingSet) -> Features:
    """Fractional derivatives that remember the longest recording."""
    return recursive_bank(PAPER_ORDERS, data.dt_s, data.longest_s)


def fit_hybrid(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Kind `hybrid`: a small forest on the residual of `hammerstein`.

    On the depth's changes over lags; with options.engine "recursive" on fractional derivatives.
    """
    (passive, _, _), passive_s = _timed_passive(data, options)
    begin = time.perf_counter()
    by_derivatives = options.engine == "recursive"
    features = derivative_features(data) if by_derivatives else lag_features(data)
    rows = data.rows(options.fraction, options.seed)
    feature_begin = time.perf_counter()
    values = data.features(features, rows)
    feature_s = time.perf_counter() - feature_begin
    residual_n = data.force_n(rows) - passive_force(passive, data, rows)
    span_m = data.trained.max_m - data.trained.min_m
    forest, importance = fit_forest(
        values, residual_n, depth_scale(span_m), HYBRID_TREES, HYBRID_LEAF, options.seed
    )
    metadata = {
        "n_nodes": len(forest.feature),
        "n_parameters": parameter_count(passive),
        "importance": importance.tolist(),
    }
    parts = (features, forest)
    model = assemble("hybrid", name, data, options, len(rows), parts, passive, True, metadata)
    fit_s = passive_s + time.perf_counter() - begin - feature_s
    return Fit(model, len(rows), feature_s, fit_s, metadata=metadata)


def passive_force(passive: Hammerstein, data: TrainingSet, rows: np.ndarray) -> Samples:
    """Force of the passive model at rows of all recordings, (rows,), N."""
    return data.along(rows, lambda depth, at: hammerstein_force(passive, depth, data.dt_s, at))


def _fold_equations(values: Samples, force_n: Samples, folds: Folds) -> list[Normal]:
    return [
        normal_equations(values[folds.number == fold], force_n[folds.number == fold])
        for fold in range(int(folds.number.max()) + 1)
    ]


def _cross_validated(parts: list[Normal], folds: Folds) -> float:
    """RMSE over the held-out folds, N."""
    squares = rows = 0.0
    for fold in folds.tested:
        training = [part for i, part in enumerate(parts) if i != fold]
        if not training or not parts[fold].rows:
            continue
        squares += parts[fold].error(_sum(training).solve())
        rows += parts[fold].rows
    return float(np.sqrt(squares / max(rows, 1.0)))


def _sum(parts: list[Normal]) -> Normal:
    return reduce(add, parts)
