"""rf-fd with the paper's options is the forest of the paper's text, written again."""

from collections.abc import Sequence

import numpy as np
import pytest
from scipy.special import binom
from sklearn.ensemble import RandomForestRegressor
from support.derivatives import fir_derivatives
from support.silicones import paper_presses, validation_signals

from springpot import Recording
from springpot.codegen.arrays import rms
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.predict import predict_n

K = np.arange(171)[:, None]
ORDERS = np.arange(1, 11) / 20
TAPS = (-1.0) ** K * binom(ORDERS, K) / 1e-3**ORDERS  # equation (15): (taps, orders)


def averaged(values: np.ndarray) -> np.ndarray:
    """Moving average of 25 samples about each: 12 before, 12 behind, ends held."""
    sums = np.cumsum(np.pad(values, (13, 12), mode="edge"))
    return (sums[25:] - sums[:-25]) / 25


def errors_of_the_text_n(
    presses: Sequence[Recording], signals: Sequence[Recording], seed: int
) -> list[float]:
    features = np.concatenate([fir_derivatives(averaged(one.position_m), TAPS) for one in presses])
    force_n = np.concatenate([averaged(one.force_n) for one in presses])
    rows = np.random.default_rng(100 + seed).choice(len(force_n), len(force_n) // 5, replace=False)
    forest = RandomForestRegressor(
        n_estimators=100, min_samples_leaf=5, max_features=1 / 3, random_state=100 + seed, n_jobs=2
    ).fit(1e3 * features[rows], force_n[rows])  # in mm: closer than 1e-7 is equal to it
    return [
        rms(forest.predict(1e3 * fir_derivatives(one.position_m, TAPS)) - one.force_n)
        for one in signals
    ]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ecoflex-00-30", "dragon-skin-10"])
def test_the_forest_of_the_text_has_the_same_error(name: str) -> None:
    presses, signals = paper_presses(name), validation_signals(name, 10)
    for seed in (1, 2):
        options = FitOptions(seed=seed, tree_rows=1.0, split_features=1 / 3)
        model = fit_model("rf-fd", "x", presses, options).model
        ours = np.mean([rms(predict_n(model, one) - one.force_n) for one in signals])
        text = np.mean(errors_of_the_text_n(presses, signals, seed))
        assert ours == pytest.approx(text, rel=0.02), (seed, ours, text)
