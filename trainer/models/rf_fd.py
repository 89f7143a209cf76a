"""Kind `rf-fd`: a forest on fractional derivatives, or past positions."""

import dataclasses
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import RandomForestRegressor

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import UsageError
from springpot.codegen.model.features import Features, FirBank, FractionalBank, Lags
from springpot.codegen.model.forest import fit_quantisation, to_bins
from springpot.trainer.features import fit_fast_fir_bank, fit_recursive_bank, gl_taps
from springpot.trainer.models.ensembles import convert_forest
from springpot.trainer.models.fit import Engine, Fit, FitOptions, assemble
from springpot.trainer.models.passive.passive_fit import fit_passive
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording

PAPER_ORDERS = tuple(round(0.05 * i, 2) for i in range(1, 11))  # of equation (5), section IV-B
PAPER_TAPS = 171  # m of equation (16)
HISTORY_LAGS = 10
MAX_TAPS = 1024  # longer windows are cheaper as exponentials
MIN_WINDOW = 10  # samples
MAX_WINDOW_S = 1e5
RECURSIVE_S = 1000.0


def build_fractional_features(
    dt_s: float,
    window_s: float | None,
    engine: Engine | None = None,
    orders: tuple[float, ...] = PAPER_ORDERS,
) -> FractionalBank:
    """Build the paper's fractional derivatives of depth, equation (5), over `window_s`.

    The default window has 171 samples (PAPER_TAPS). The default engine is taps, and exponentials
    where the window is long. Exponentials without a stated window reach far back (RECURSIVE_S): the
    derivative of a depth that is held fades to 0, as the true one does, and that of a short window
    does not. Raises UsageError for a window that is too short, or too long for the engine.
    """
    length = PAPER_TAPS if window_s is None else window_samples(window_s, dt_s)
    if engine == "recursive" or (engine is None and length > MAX_TAPS):
        return fit_recursive_bank(orders, dt_s, RECURSIVE_S if window_s is None else length * dt_s)
    if length > MAX_TAPS:
        raise UsageError(
            f"--window-s {window_s:g} is {length} taps, at most {MAX_TAPS} are worth their time: "
            "use --engine recursive"
        )
    taps = np.stack([gl_taps(order, length, dt_s) for order in orders], axis=1)
    bank = FirBank(orders=orders, taps=taps)
    return fit_fast_fir_bank(bank) if engine == "fir-fast" else bank


def window_samples(window_s: float, dt_s: float) -> int:
    """Samples of a window. Raises UsageError where it holds fewer than ten, or is a day long."""
    if not MIN_WINDOW * dt_s <= window_s <= MAX_WINDOW_S:
        raise UsageError(
            f"--window-s {window_s:g}: at {1 / dt_s:g} Hz give {MIN_WINDOW * dt_s:g} to "
            f"{MAX_WINDOW_S:g} s"
        )
    return round(window_s / dt_s)


def build_lag_features(dt_s: float, window_s: float | None) -> Lags:
    """Ten positions, evenly spaced over the window ([24])."""
    length = PAPER_TAPS if window_s is None else window_samples(window_s, dt_s)
    lags = np.round(np.linspace(0, length - 1, HISTORY_LAGS)).astype(int)
    return Lags(tuple(lags.tolist()))


def fit_rf_fd(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Fit kind `rf-fd`: the paper's forest on fractional derivatives (section IV-B).

    With `past_positions` on ten past positions instead, the baseline that the paper compares with
    (its reference [24]), which acts with negative damping. The passive model is fitted beside it
    for depths beyond the trained ones, where trees are constant.
    """
    features: Features
    if options.past_positions:
        features = build_lag_features(data.dt_s, options.window_s)
    else:
        orders = options.orders or PAPER_ORDERS
        features = build_fractional_features(data.dt_s, options.window_s, options.engine, orders)
    begin = time.perf_counter()
    rows = data.rows(options.fraction, options.seed)
    force_n = data.force_n(rows)
    values = data.features(features, rows)
    feature_s = time.perf_counter() - begin
    scale, quantisation = 1.0, None
    if options.round_features:
        quantisation = fit_quantisation(values)
        values = to_bins(quantisation, values).astype(np.float64)
    else:
        scale = compute_depth_scale(data.trained.max_m - min(data.trained.min_m, 0.0))
    begin = time.perf_counter()
    regressor = fit_forest(options, (scale * values).astype(np.float32), force_n)
    forest = convert_forest(regressor).on_scaled(scale)
    forest = dataclasses.replace(forest, quantisation=quantisation)
    fit_s = time.perf_counter() - begin
    passive = fit_passive(data, options)
    metadata = {
        "n_nodes": len(forest.feature),
        "importance": regressor.feature_importances_.tolist(),
    }
    parts = (features, forest)
    model = assemble("rf-fd", name, data, options, len(rows), parts, passive, False, metadata)
    return Fit(model, len(rows), feature_s, fit_s, metadata=metadata)


def compute_depth_scale(span_m: float) -> float:
    """Power of two near 1/depth.

    scikit-learn takes values closer than 1e-7 for equal, and only a power of two folds back into
    the thresholds exactly.
    """
    return float(2.0 ** -np.round(np.log2(span_m)))


def fit_forest(options: FitOptions, values: NDArray[np.float32], force_n: Samples) -> Any:
    """A bootstrap forest; it predicts in one thread, which always sums trees in one order."""
    forest = RandomForestRegressor(
        n_estimators=options.trees,
        min_samples_leaf=options.leaf,
        max_features=options.split_features,
        max_samples=max(int(options.tree_rows * len(values)), 1),  # of a share it may warn
        random_state=options.seed,
        n_jobs=-1,
    )
    return forest.fit(values, force_n).set_params(n_jobs=1)
