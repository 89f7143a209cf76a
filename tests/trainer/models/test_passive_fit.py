"""The passive model where recordings leave something open: a depth not reached, a gap between."""

import numpy as np
from support.small import DT_S, press

from springpot.host.metrics import accuracy
from springpot.trainer.features.values import highpass
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.passive.nonnegative import normal_equations, sparse_solve
from springpot.trainer.models.passive.passive_fit import PENALTIES, term_columns
from springpot.trainer.models.passive.passive_terms import Shape, standard_terms
from springpot.trainer.models.predict import predict_n
from springpot.trainer.models.training_set import training_set
from springpot.trainer.recordings.recording import Recording

DEPTH_M = 0.01
MODES = ((0.02, 2.0), (0.2, 1.5), (2.0, 1.5))  # s, N
SPRING_N = 6.0


def tissue(name: str, position_m: np.ndarray, stiffening: float) -> Recording:
    """An object whose spring and three relaxations follow one exponential curve of depth."""
    curve = np.expm1(stiffening * position_m / DEPTH_M) / np.expm1(stiffening)
    force_n = SPRING_N * curve
    for tau_s, weight_n in MODES:
        force_n = force_n + weight_n * highpass(curve, tau_s, DT_S)
    return Recording(name, position_m, force_n, DT_S, zero="min")


def about(share: float, stiffening: float) -> list[Recording]:
    """Cycles of a tenth of the depth about one share of it, at three speeds."""
    return [
        tissue(f"{share}-{hz}", DEPTH_M * (share - 0.1) + press(hz, 0.2 * DEPTH_M, 2), stiffening)
        for hz in (0.5, 2.0, 8.0)
    ]


def one_twice_as_deep() -> list[Recording]:
    motions = {"half": press(0.5, 0.005), "again": press(2.0, 0.005), "deep": press(1.0, DEPTH_M)}
    return [tissue(name, position_m, 4.0) for name, position_m in motions.items()]


def test_a_fold_without_the_deepest_recording_has_ordinary_weights_and_errors() -> None:
    # Without a penalty on bends: weights of 1e25 on the ramps that the fold never reached.
    data = training_set(one_twice_as_deep(), smooth_s=0.0)
    peak_n = data.trained.max_n
    terms = standard_terms(data, Shape("ramps"), bias=True)
    rows = np.arange(data.rows_total)
    values, force_n = term_columns(terms, data, rows), data.force_n(rows)
    for penalty in PENALTIES["ramps"]:
        for held in range(3):
            out = data.owner(rows) == held
            kept = normal_equations(values[~out], force_n[~out]).penalised(
                penalty * terms.roughness()
            )
            weights = kept.solve()
            assert weights.max() < 10.0 * peak_n
            assert normal_equations(values[out], force_n[out]).rmse(weights) < peak_n


def test_the_deepest_recordings_fold_decides_for_no_basis() -> None:
    fit = fit_model("hammerstein", "x", one_twice_as_deep(), FitOptions(smooth_s=0.0))
    test = tissue("other", press(0.7, 0.8 * DEPTH_M), 4.0)
    found = accuracy([test.force_n], [predict_n(fit.model, test)])
    assert fit.metadata["basis"] == "ramps"
    assert found.rmse_percent_of_peak < 4.0  # powers, where ramps could not be chosen: 7.5


def test_a_rise_between_two_trained_depths_goes_on_straight() -> None:
    training = [item for share in (0.2, 0.55, 0.85) for item in about(share, 4.0)]
    model = fit_model("hammerstein", "x", training, FitOptions(smooth_s=0.0)).model
    tests = about(0.4, 4.0)
    found = accuracy([item.force_n for item in tests], [predict_n(model, item) for item in tests])
    assert found.rmse_percent_of_peak < 2.0  # where bends cost nothing: 3.7


def test_ramps_that_no_row_saw_go_on_as_the_last_ones_seen() -> None:
    data = training_set([tissue("half", press(1.0, 0.5 * DEPTH_M), 2.0)], smooth_s=0.0)
    whole = training_set([tissue("whole", press(1.0, DEPTH_M), 2.0)], smooth_s=0.0)
    terms = standard_terms(whole, Shape("ramps"), bias=False)
    rows = np.arange(data.rows_total)
    normal = normal_equations(term_columns(terms, data, rows), data.force_n(rows))
    slopes = sparse_solve(normal.penalised(1e-4 * terms.roughness()), terms.blocks, 0.005)
    curves = slopes.reshape(terms.curves, terms.n_basis)
    steepest = np.diff(curves[:, :4], axis=1).max()
    assert np.diff(curves[:, 3:], axis=1).max() <= 1.1 * steepest
    assert np.diff(curves[:, 3:], n=2, axis=1).max() <= 0.1 * steepest
