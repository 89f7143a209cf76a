"""Inputs of a fit, from its recordings: rows, range, contact, scale, smoothing, memory, folds."""

import dataclasses
from collections import Counter
from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import binom
from sklearn.ensemble import RandomForestRegressor
from support.derivatives import fir_derivatives
from support.silicones import paper_presses, validation_signals
from support.small import DEPTH_M, DT_S, press, recording, small_fit, training

from springpot import Recording
from springpot.codegen.arrays import rms
from springpot.codegen.errors import DataError
from springpot.codegen.model.forest import quantise_leaves
from springpot.codegen.model.model_file import model_hash
from springpot.trainer.kinds import fit_model
from springpot.trainer.models import doubts, rbf
from springpot.trainer.models.depths import is_adhesive, join_motions
from springpot.trainer.models.ensembles import convert_linear
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import (
    Folds,
    build_cv_schemes,
    compute_fold_cells,
    split_by_condition,
    split_repeats,
)
from springpot.trainer.models.passive.nonnegative import normal_equations
from springpot.trainer.models.passive.passive_fit import fit_passive, select_passive
from springpot.trainer.models.predict import predict_n
from springpot.trainer.models.rf_fd import PAPER_ORDERS, build_lag_features, compute_depth_scale
from springpot.trainer.models.training_set import TrainingSet, build_training_set, select_rows
from springpot.trainer.recordings.signals import smooth


@pytest.mark.parametrize(
    ("rows", "fraction", "expected"),
    [(48_850, None, 9770), (19_999, None, 19_999), (20_000, None, 4000), (10_000_000, None, 50_000),
     (100, 0.5, 50), (100, 1.0, 100), (3, 0.01, 1)],
)  # fmt: skip
def test_rows_follow_the_paper(rows: int, fraction: float | None, expected: int) -> None:
    chosen = select_rows(rows, fraction, np.random.default_rng(0))
    assert len(chosen) == len(set(chosen.tolist())) == expected and chosen.max() < rows


@pytest.mark.parametrize(
    ("press_s", "noise_n"), [(0.2, 0.05), (1.0, 0.3), (0.03, 0.05), (0.06, 0.05), (0.005, 0.0)]
)
def test_the_default_smoothing_bends_less_than_noise(press_s: float, noise_n: float) -> None:
    time_s = np.arange(3000) / 3000.0
    force_n = 8.0 * np.sin(np.pi * np.clip((time_s - 0.3) / press_s, 0.0, 1.0))
    noise = np.random.default_rng(0).normal(0.0, noise_n, len(time_s))
    clean = Recording("impact", force_n / 1e3, force_n, 1.0 / 3000.0)
    noisy = [replace(clean, force_n=force_n + noise)]
    smooth_s = build_training_set(noisy, None).smooth_s
    bent_n, longer_n = (
        rms((smooth(clean, s).force_n - force_n)[force_n > 0.8])
        for s in (smooth_s, 2.0 * smooth_s or 0.025 / 8)
    )
    assert bent_n <= 0.5 * noise_n
    assert smooth_s == 0.025 or longer_n > 0.45 * noise_n
    assert build_training_set(noisy, 0.025).smooth_s == 0.025  # as it was asked for


def test_smoothing_is_zero_phase_and_keeps_a_line() -> None:
    line = np.linspace(0.0, 0.01, 400)
    item = Recording("line", line, 100 * line, DT_S)
    result = smooth(item, 0.025)
    np.testing.assert_allclose(result.position_m[12:-12], line[12:-12], atol=1e-15)
    assert smooth(item, 0.0) is item


def test_the_fit_predicts_what_scikit_learn_predicts() -> None:
    model, item = small_fit().model, training()[2]
    data = build_training_set(training(), None)
    rows = data.rows(None, 1)
    scale = 64.0  # the power of two nearest to 1/0.012 m
    assert compute_depth_scale(DEPTH_M) == scale
    forest = RandomForestRegressor(
        n_estimators=5, min_samples_leaf=20, max_samples=0.35, random_state=1
    ).fit(scale * data.features(model.features, rows), data.force_n(rows))
    features = fir_derivatives(scale * item.position_m, model.features.taps)
    expected = forest.predict(features.astype(np.float32))
    rounding_n = 1.01 * quantise_leaves(model.regressor).error_n
    np.testing.assert_allclose(predict_n(model, item), expected, rtol=0, atol=rounding_n)


@pytest.mark.few(0, 1)
@pytest.mark.parametrize("name", ["ecoflex-00-30", "dragon-skin-10"])
def test_the_papers_forest_is_that_of_its_text(name: str) -> None:
    """Written again: equation (15), 25 samples averaged, 100 trees; on the same fifth of rows."""
    presses, signals = paper_presses(name), validation_signals(name, 10)
    k, orders = np.arange(171)[:, None], np.arange(1, 11) / 20
    taps = (-1.0) ** k * binom(orders, k) / 1e-3**orders
    averaged = [np.convolve(np.pad(channel, 12, "edge"), np.full(25, 0.04), "valid")
                for one in presses for channel in (one.position_m, one.force_n)]  # fmt: skip
    features = np.concatenate([fir_derivatives(position_m, taps) for position_m in averaged[::2]])
    force_n = np.concatenate(averaged[1::2])
    ours, text = [], []
    for seed in (1, 2):
        rows = select_rows(len(force_n), 0.2, np.random.default_rng(seed))
        forest = RandomForestRegressor(
            min_samples_leaf=5, max_features=1 / 3, random_state=100 + seed, n_jobs=2
        ).fit(1e3 * features[rows], force_n[rows])  # in mm: closer than 1e-7 is equal to it
        options = FitOptions(seed=seed, tree_rows=1.0, split_features=1 / 3, smooth_s=0.025)
        model = fit_model("rf-fd", "x", presses, options).model
        for one in signals:
            ours.append(rms(predict_n(model, one) - one.force_n))
            own = fir_derivatives(one.position_m, taps)
            text.append(rms(forest.predict(1e3 * own) - one.force_n))
    assert np.mean(ours) == pytest.approx(np.mean(text), rel=0.02)


@pytest.mark.slow
def test_unscaled_metres_would_not_do() -> None:
    # Positions a thousand times smaller give the same model: the scale follows the depth.
    small = [dataclasses.replace(item, position_m=item.position_m / 1024.0) for item in training()]
    fit = fit_model("rf-fd", "small", small, FitOptions(seed=1, trees=5, leaf=20))
    reference = predict_n(small_fit().model, training()[1])
    np.testing.assert_allclose(predict_n(fit.model, small[1]), reference, atol=1e-5)


def test_ten_past_positions_span_the_window() -> None:
    assert build_lag_features(DT_S, 0.1).samples == tuple(range(0, 100, 11))


def test_functions_of_validation_rows_are_those_of_the_fit() -> None:
    values = np.random.default_rng(0).normal(size=(50, 3))
    for _, fitted, others in rbf._build_systems(values, values[::-1]):
        np.testing.assert_array_equal(others, fitted[::-1])


def test_recordings_that_do_not_fit_together_are_refused() -> None:
    good = training()[0]
    moved = dataclasses.replace(good, name="moved", zero="min")
    as_a_rate = dataclasses.replace(good, name="q", dt_s=1.0 / good.dt_s)
    for given, told in (
        ([good, moved], "moved was imported with --zero"),
        ([good, as_a_rate], "one has a wrong unit: give time, or dt_s, in s"),
        ([], "no recordings"),
    ):
        with pytest.raises(DataError, match=told):
            fit_model("rf-fd", "x", given, FitOptions(trees=2))


@pytest.mark.parametrize(("surface", "waits_m"), [(False, 1e-3), (True, 0.0)])
def test_in_a_pause_the_tool_is_where_it_gives_least(surface: bool, waits_m: float) -> None:
    depths_m = [np.linspace(3e-3, end_m, 10) for end_m in (1e-3, 2e-3)]
    pairs = enumerate(depths_m)
    items = [Recording(f"{k}", x, x, DT_S, session="one", start_s=k) for k, x in pairs]
    (joined,) = join_motions(items, depths_m, surface)
    assert joined.depth_m[10:12].tolist() == [waits_m] * 2
    assert joined.pauses == ((11, pytest.approx(1.0 - 10 * DT_S)),)


def test_what_holds_the_tool_is_not_let_go() -> None:
    glued = [lossy(item, pull=True) for item in training()]
    data = build_training_set(glued, smooth_s=0.0)
    assert data.contact == "always"
    assert "it holds the tool, and the model pulls" in data.warnings[-1]
    fit = fit_model("hammerstein", "x", glued, FitOptions(smooth_s=0.0))
    least_n = min(float(predict_n(fit.model, item).min()) for item in glued)
    assert least_n == pytest.approx(min(float(item.force_n.min()) for item in glued), rel=0.1)
    assert not is_adhesive([replace(item, force_n=item.force_n - 1.5 * least_n) for item in glued])


@pytest.mark.parametrize("noise_share", [0.0, 0.03, 0.1])
@pytest.mark.parametrize("hum_share", [0.0, 0.08])
@pytest.mark.parametrize("tare_share", [-0.3, 0.0, 0.3])
@pytest.mark.parametrize("step", [1, 10])
def test_what_lets_go_has_a_surface_whatever_disturbs_its_force(
    noise_share: float, hum_share: float, tare_share: float, step: int
) -> None:
    """Noise, hum of the mains, a tare in some of the recordings, at 1 kHz and at 100 Hz."""
    items = [lossy(item, pull=False) for item in training()]
    disturbed_items = [
        disturbed(item, noise_share, hum_share, tare_share * (number > 0), seed=number)
        for number, item in enumerate(items)
    ]
    assert not is_adhesive([
        dataclasses.replace(
            item, position_m=item.position_m[::step], force_n=item.force_n[::step],
            dt_s=step * item.dt_s,
        )
        for item in disturbed_items
    ])  # fmt: skip


def disturbed(
    item: Recording, noise_share: float, hum_share: float, tare_share: float, seed: int = 0
) -> Recording:
    """With white noise, a hum of 50 Hz and a tare, in shares of the peak."""
    time_s = np.arange(len(item.force_n)) * item.dt_s
    added = noise_share * np.random.default_rng(seed).normal(size=len(time_s)) + tare_share
    added += hum_share * np.sin(2.0 * np.pi * 50.0 * time_s + seed)
    return dataclasses.replace(item, force_n=item.force_n + item.force_n.max() * added)


def lossy(item: Recording, pull: bool) -> Recording:
    """A spring and a damper, which pulls as the tool leaves where the object is glued to it."""
    force_n = 200.0 * item.position_m + 10.0 * np.gradient(item.position_m, item.dt_s)
    return dataclasses.replace(item, force_n=force_n if pull else np.maximum(force_n, 0.0))


@pytest.mark.slow
def test_a_part_of_a_set_answers_for_itself() -> None:
    whole = build_training_set(training(), 0.0)
    fit_passive(whole, FitOptions())
    part = replace(whole, recordings=whole.recordings[:2], depths_m=whole.depths_m[:2])
    assert fit_passive(part, FitOptions()) is not fit_passive(whole, FitOptions())
    assert select_passive(part, FitOptions())[0].rows.rows.max() < part.rows_total


def test_same_seed_and_recordings_give_the_same_hash() -> None:
    first, again, other = (
        model_hash(fit_model("rf-fd", "a", training(), FitOptions(seed=k, trees=3, leaf=30)).model)
        for k in (3, 3, 4)
    )
    assert first == again != other


SHARES = (0.3, 0.7, 1.0)


def with_repeats() -> TrainingSet:
    """Every press twice: the repeat a little slower and shallower, as by a hand or a valve."""
    return build_training_set(
        [
            recording(f"{share}-{hz}-{slower}", press(hz * slower, share * DEPTH_M * deeper))
            for share in SHARES
            for hz in (0.5, 1.0, 3.0, 5.0)
            for slower, deeper in ((1.0, 1.0), (0.97, 0.99))
        ],
        smooth_s=0.0,
    )


def test_repeats_of_one_press_go_to_different_folds() -> None:
    data = with_repeats()
    for seed in range(20):
        number = split_repeats(data.depths_m, data.dt_s, 5, seed).number
        assert np.all(number[::2] != number[1::2])
        assert max(Counter(number.tolist()).values()) == 5  # 24 recordings in 5 folds
    full_m, half_m = press(1.0), DEPTH_M / 2 + press(2.0, DEPTH_M / 2)  # alike but for the top
    six_m = [full_m, full_m, half_m, full_m, half_m, half_m]
    assert set(split_repeats(six_m, DT_S, 3, 0).number[[0, 1, 3]].tolist()) == {0, 1, 2}


def test_other_seeds_put_the_recordings_into_other_folds() -> None:
    data = with_repeats()
    drawn = {
        tuple(split_repeats(data.depths_m, data.dt_s, 5, seed).number.tolist())
        for seed in range(20)
    }
    assert len(drawn) > 15


def test_each_depth_and_each_speed_is_held_out_whole() -> None:
    data = with_repeats()
    rows = data.bounds[:-1] + 1
    depth, speed = split_by_condition(data, rows)
    assert depth.number.tolist() == [group for group in (0, 1, 2) for _ in range(8)]
    assert np.all(speed.number[::2] == speed.number[1::2]) and speed.tested == (0, 1, 2, 3, 4)
    # Presses in one recording, of an object whose zero is elsewhere: each from top to top.
    in_a_row_m = 0.03 + np.concatenate([press(1.0, share * DEPTH_M) for share in SHARES])
    data = build_training_set([Recording("deep", in_a_row_m, in_a_row_m, DT_S)], smooth_s=0.0)
    both = split_by_condition(data, np.arange(250, 3000, 500))
    assert [folds.number.tolist() for folds in both] == [[0, 0, 1, 1, 2, 2]] * 2


def test_what_is_as_deep_as_nothing_else_is_not_held_out() -> None:
    data = with_repeats()
    _, depth, speed = build_cv_schemes(data, np.arange(data.rows_total), seed=0)
    assert depth.tested == (0, 1)  # without the deepest, only extrapolation is measured
    assert speed.tested == (0, 1, 2, 3, 4)


def test_noise_on_repeats_makes_no_further_conditions() -> None:
    noise, item = np.random.default_rng(1), training()[5]
    noisy_m = [item.position_m + noise.normal(0.0, 2e-6, 1000) for _ in range(6)]
    same = [dataclasses.replace(item, position_m=position_m) for position_m in noisy_m]
    data = build_training_set(same, smooth_s=0.0)
    assert split_by_condition(data, np.arange(data.rows_total)) == []


def test_a_piece_is_in_one_fold_of_each_family() -> None:
    data = build_training_set(training(), smooth_s=0.0)
    families = build_cv_schemes(data, np.arange(data.rows_total), seed=3)
    assert len(families) == 3
    piece = compute_fold_cells(families)
    for folds in families:
        pairs = set(zip(piece.tolist(), folds.number.tolist(), strict=True))
        assert len(pairs) == piece.max() + 1


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["ecoflex-00-10", "ecoflex-00-30", "ecoflex-00-50", "dragon-skin-10", "dragon-skin-fx"],
)
def test_the_pair_of_orders_is_tried_as_it_ships(name: str) -> None:
    """On its own motions the pair of least error; by held-out presses one that errs little more."""
    pressed, signals = paper_presses(name), validation_signals(name, 10)
    measured_n = np.concatenate([signal.force_n for signal in signals])

    def error_n(**of_fit: object) -> float:
        model = fit_model("rbf-fd", "x", pressed, FitOptions(**of_fit), signals).model
        return rms(np.concatenate([predict_n(model, item) for item in signals]) - measured_n)

    errors_n = [error_n(orders=pair) for pair in combinations(PAPER_ORDERS, 2)]
    assert error_n(select="paper") <= 1.02 * min(errors_n)
    assert error_n() <= 1.4 * min(errors_n)


def test_what_is_linear_but_for_a_single_row_is_not_linear() -> None:
    values = np.random.default_rng(1).normal(size=(2000, 3))
    regressor = SimpleNamespace(predict=lambda features: features @ [1.0, 2.0, 3.0] + 0.5)
    predicted_n = regressor.predict(values)
    linear = convert_linear(regressor, values, predicted_n)
    assert linear is not None and linear.intercept_n == pytest.approx(0.5)
    np.testing.assert_allclose(linear.weights_n, [1.0, 2.0, 3.0])
    predicted_n[7] += 1e-5 * np.abs(predicted_n).max()
    assert convert_linear(regressor, values, predicted_n) is None


def test_the_recording_with_the_clearest_step_of_its_force_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    compared = [
        doubts._Compared(Recording(name, press(1.0), press(1.0), DT_S), *[np.zeros(3)] * 4)
        for name in ("weak", "strong", "none")
    ]
    steps = iter([doubts.ForceStep(1, 10, 1.1, 3.0), doubts.ForceStep(5, 10, 1.4, 30.0), None])
    monkeypatch.setattr(doubts, "find_force_step", lambda *_: next(steps))
    (line,) = doubts._force_step_message(compared, 10.0)
    assert line.startswith("strong: from 0.5 s on") and "1.4 times" in line


def test_pairs_are_tried_with_less_damping_than_they_ship_with() -> None:
    """Two columns alike but for a millionth, whose difference is all of the force."""
    rng = np.random.default_rng(4)
    column, small = rng.normal(size=(2, 60))
    system = np.stack([column, column + 1e-5 * small], axis=1)
    force_n = small
    halves = Folds(np.arange(60) % 2, (0, 1))
    assert rbf._held_out_rmse(system, force_n, halves) < 0.02
    damped = rbf.solve_damped(normal_equations(system, force_n))
    assert rms(system @ damped - force_n) > 0.1
