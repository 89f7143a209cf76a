"""Kind `hammerstein`, the fallback of every other kind, and `hybrid`."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from operator import add

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.model.features import Features, Lags
from springpot.codegen.model.model import Basis, Hammerstein
from springpot.trainer.features.exponentials import recursive_bank
from springpot.trainer.models.fit import Fit, FitOptions, assemble
from springpot.trainer.models.folds import Folds, fold_families, geometric_mean, pieces
from springpot.trainer.models.forests import depth_scale, fit_forest
from springpot.trainer.models.nonnegative import Normal, normal_equations, sparse_solve
from springpot.trainer.models.passive_terms import (
    FEWEST_BY_DEPTH,
    Shape,
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

SPARSE_LOSS = 0.003
# Prices tried on the bends of ramps: the smoothest curves unless others have a tenth less
# cross-validated error. What few recordings tell is not enough to choose by hundredths.
PRICES: dict[Basis, tuple[float, ...]] = {"powers": (0.0,), "ramps": (1e-3, 1e-4, 1e-5, 1e-6)}
BETTER = 0.9
# What curves and rates are tried, each for a tenth less error than the ones before.
PLAIN = (Shape("powers"), Shape("ramps"), Shape("ramps", stretch=12.0))
RATE_RATIOS = (16.0, 1.0 / 16.0)  # relaxing faster at the surface, or deep inside
HYBRID_TREES = 50
HYBRID_LEAF = 20
N_LAGS = 8
MAX_LAG = 8192  # samples: a ring of 32 kB in float32


def term_columns(terms: Terms, data: TrainingSet, rows: np.ndarray) -> Samples:
    """Values of all terms at rows of all recordings, (rows, terms)."""
    return data.along(rows, lambda depth, at: columns(terms, depth, data.dt_s, at))


def fit_passive(data: TrainingSet, options: FitOptions) -> tuple[Hammerstein, int, float]:
    """Fit each shape of the curves, with each price on bends; choose by cross-validated error.

    A bias only where the tool never leaves the object: at a surface the force is 0 by itself.

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
    families = fold_families(data, rows, options.seed)
    piece = pieces(families)

    def tried(shape: Shape) -> _Tried:
        terms = standard_terms(data, shape, data.contact == "always", options.poles)
        parts = _equations(term_columns(terms, data, rows), force_n, piece)
        return reduce(_better, (
            _Tried(_cross_validated(parts, families, piece, price * terms.bends()), terms, price,
                   parts)
            for price in PRICES[shape.basis]
        ))  # fmt: skip

    plain = [tried(shape) for shape in PLAIN]
    best = reduce(_better, plain)
    ramps = [some for some in plain if some.terms.shape.basis == "ramps"]
    if ramps and options.poles >= FEWEST_BY_DEPTH:
        stretch = reduce(_better, ramps).terms.shape.stretch
        for ratio in RATE_RATIOS:
            best = _better(best, tried(Shape("ramps", stretch, ratio)))
    normal = _sum(best.parts).penalised(best.price * best.terms.bends())
    weights = sparse_solve(normal, best.terms.blocks, SPARSE_LOSS)
    return to_model(best.terms, weights), len(rows), best.error_n


@dataclass(frozen=True, eq=False)
class _Tried:
    """Terms with a price on their bends: cross-validated error, normal equations of the pieces."""

    error_n: float
    terms: Terms
    price: float
    parts: list[Normal]


def _better(best: _Tried, other: _Tried) -> _Tried:
    return other if other.error_n < BETTER * best.error_n else best


def fit_hammerstein(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Kind `hammerstein`: 15 to 100 numbers, passive in the large."""
    fitted, fit_s = _timed_passive(data, options)
    passive, rows, error = fitted
    n_parameters = parameter_count(passive)
    metadata = {
        "n_parameters": n_parameters,
        "cv_rmse_n": error,
        "basis": passive.basis,
        "stretch": passive.stretch,
        "rate_ratio": passive.rate_ratio,
    }
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


def _equations(values: Samples, force_n: Samples, piece: Indices) -> list[Normal]:
    """Normal equations of each piece of the rows: every fold is a sum of some."""
    return [
        normal_equations(values[piece == k], force_n[piece == k])
        for k in range(int(piece.max()) + 1)
    ]


def _cross_validated(
    parts: list[Normal], families: Sequence[Folds], piece: Indices, penalty: Samples
) -> float:
    """RMSE over the held-out folds, N: geometric mean in each family, then of all."""
    _, first = np.unique(piece, return_index=True)
    means = []
    for folds in families:
        number = folds.number[first]
        errors = []
        for fold in folds.tested:
            training = [part for part, its in zip(parts, number, strict=True) if its != fold]
            held = [part for part, its in zip(parts, number, strict=True) if its == fold]
            if training and held:
                weights = _sum(training).penalised(penalty).solve()
                errors.append(_sum(held).rmse(weights))
        if errors:
            means.append(geometric_mean(errors))
    return geometric_mean(means) if means else 0.0


def _sum(parts: list[Normal]) -> Normal:
    return reduce(add, parts)
