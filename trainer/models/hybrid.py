"""Kind `hybrid`: a forest on what the passive model leaves over."""

import time
from collections.abc import Sequence

import numpy as np

from springpot.codegen.model.features import Features, Lags
from springpot.trainer.features.fractional import recursive_bank
from springpot.trainer.models.fit import Fit, FitOptions, assemble
from springpot.trainer.models.forests import depth_scale, fit_forest
from springpot.trainer.models.passive.passive_fit import timed_passive
from springpot.trainer.models.passive.passive_force import model_along
from springpot.trainer.models.passive.passive_terms import parameter_count
from springpot.trainer.models.rf_fd import PAPER_ORDERS
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording

HYBRID_TREES = 50
HYBRID_LEAF = 20
N_LAGS = 8
MAX_LAG = 8192  # samples: a ring of 32 kB in float32


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
    (passive, _, _), passive_s = timed_passive(data, options)
    begin = time.perf_counter()
    by_derivatives = options.engine == "recursive"
    features = derivative_features(data) if by_derivatives else lag_features(data)
    rows = data.rows(options.fraction, options.seed)
    feature_begin = time.perf_counter()
    values = data.features(features, rows)
    feature_s = time.perf_counter() - feature_begin
    surface = data.contact == "surface"
    passive_n = data.along_motions(
        rows, lambda motion, at: model_along(passive, motion, data.dt_s, surface)[0][at]
    )
    residual_n = data.force_n(rows) - passive_n
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
