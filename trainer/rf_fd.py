"""rf-fd: a regression forest on ten fractional derivatives (the paper's section IV-B)."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import RandomForestRegressor

from springpot.codegen.ir import FirBank, Forest, Model
from springpot.trainer.fractional import fir_derivatives, gl_taps
from springpot.trainer.recording import Recording
from springpot.trainer.rows import choose_rows
from springpot.trainer.smoothing import PAPER_SMOOTH_S, smoothed
from springpot.trainer.training_set import common_time_step, contact_of, depth_m, trained_range
from springpot.trainer.tree_ir import forest_ir

PAPER_ORDERS = tuple(round(0.05 * i, 2) for i in range(1, 11))
PAPER_TAPS = 171
PAPER_TREES = 100
PAPER_LEAF = 5
FEATURES_AT_SPLIT = 1 / 3


@dataclass(frozen=True)
class RfFdOptions:
    """How rf-fd is fitted. window_s None: 171 taps at the recordings' own rate."""

    seed: int = 0
    trees: int = PAPER_TREES
    leaf: int = PAPER_LEAF
    fraction: float | None = None
    window_s: float | None = None
    smooth_s: float = PAPER_SMOOTH_S


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted model and what the fit took.

    importance: shape (orders,), impurity decrease, sums to 1.
    """

    model: Model
    rows: int
    rows_total: int
    feature_s: float
    fit_s: float
    importance: NDArray[np.float64]
    regressor: Any


def fit_rf_fd(name: str, recordings: Sequence[Recording], options: RfFdOptions) -> Fit:
    """Fit the paper's forest on `recordings`. Raises DataError where they do not fit together."""
    dt_s = common_time_step(recordings)
    contact = contact_of(recordings)
    prepared = [smoothed(recording, options.smooth_s) for recording in recordings]
    trained = trained_range(prepared, contact)
    begin = time.perf_counter()
    bank = fir_bank(dt_s, options.window_s)
    # A power of two near 1/depth: scikit-learn takes values closer than 1e-7 for equal, and only a
    # power of two folds back into the thresholds exactly.
    span_m = trained.greatest_m - min(trained.least_m, 0.0)
    scale = float(2.0 ** -np.round(np.log2(span_m)))
    features = np.concatenate(
        [fir_derivatives(scale * depth_m(rec, contact), bank.taps) for rec in prepared]
    ).astype(np.float32)
    force_n = np.concatenate([recording.force_n for recording in prepared])
    rng = np.random.default_rng(options.seed)
    rows = choose_rows(len(force_n), options.fraction, rng)
    fit_begin = time.perf_counter()
    regressor = RandomForestRegressor(
        n_estimators=options.trees,
        min_samples_leaf=options.leaf,
        max_features=FEATURES_AT_SPLIT,
        random_state=options.seed,
        n_jobs=-1,
    ).fit(features[rows], force_n[rows])
    end = time.perf_counter()
    model = Model(
        kind="rf-fd",
        name=name,
        dt_s=dt_s,
        contact=contact,
        trained=trained,
        features=bank,
        regressor=unscaled(forest_ir(regressor), scale),
        provenance={
            "seed": options.seed,
            "rows": len(rows),
            "rows_total": len(force_n),
            "smooth_s": options.smooth_s,
            "recordings": {rec.name: rec.content_hash for rec in recordings},
            "importance": [float(share) for share in regressor.feature_importances_],
            "scikit-learn": version("scikit-learn"),
            "springpot": version("springpot"),
        },
    )
    return Fit(
        model=model,
        rows=len(rows),
        rows_total=len(force_n),
        feature_s=fit_begin - begin,
        fit_s=end - fit_begin,
        importance=regressor.feature_importances_,
        regressor=regressor,
    )


def fir_bank(dt_s: float, window_s: float | None) -> FirBank:
    """The ten orders over `window_s`, by default 171 taps."""
    length = PAPER_TAPS if window_s is None else max(2, round(window_s / dt_s))
    taps = np.stack([gl_taps(order, length, dt_s) for order in PAPER_ORDERS], axis=1)
    return FirBank(orders=PAPER_ORDERS, taps=taps)


def unscaled(forest: Forest, scale: float) -> Forest:
    """Fold a power-of-two scale of the features back into the thresholds, exactly."""
    return Forest(
        feature=forest.feature,
        threshold=forest.threshold / scale,
        left=forest.left,
        right=forest.right,
        value_n=forest.value_n,
        roots=forest.roots,
    )
