"""Kind `auto`: chosen by cross-validation on the training recordings, and why."""

import logging
from dataclasses import replace

import numpy as np
import pytest
from support.small import DEPTH_M, DT_S, passive_model, press, recording, small_fit, training

from springpot import Model, Recording
from springpot.trainer.kinds import fit_model
from springpot.trainer.models import predict
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.predict import predict_n
from springpot.trainer.models.training_set import build_training_set
from springpot.trainer.selection import auto, scores
from springpot.trainer.selection.auto import explain_choice, forest_wins
from springpot.trainer.selection.scores import Score
from springpot.trainer.selection.small_signal import SmallMotion, count_active_cells

OPTIONS = FitOptions(seed=3, trees=10, smooth_s=0.0)


def spring(name: str, depth_m: np.ndarray) -> Recording:
    return Recording(name, depth_m, 400.0 * depth_m + 3e4 * depth_m**2, DT_S)


def rmse_n(model: Model, test: Recording) -> float:
    return float(np.sqrt(np.mean((predict_n(model, test) - test.force_n) ** 2)))


@pytest.mark.slow
def test_a_plain_spring_needs_no_forest(caplog):
    caplog.set_level(logging.INFO, "springpot.progress")
    presses = [spring(f"{k}", press(k, 0.01)) for k in (2.0, 3.0, 4.0)]
    fit = fit_model("auto", "x", presses, OPTIONS)
    tried = [score["name"] for score in fit.metadata["scores"]]
    assert tried == ["hammerstein", "rf-fd"]
    said = dict.fromkeys(caplog.messages)
    assert list(said) == [f"{k} of {len(tried)}: {n}" for k, n in enumerate(tried, 1)]
    steps = [(record.done, record.total) for record in caplog.records]
    assert steps == sorted(steps) and steps[-1][0] <= steps[-1][1]
    assert fit.metadata["chosen"] == "hammerstein" and fit.model.regressor is None
    other, forest = spring("other", press(2.4, 0.008)), fit_model("rf-fd", "x", presses, OPTIONS)
    assert rmse_n(fit.model, other) < 0.1 * rmse_n(forest.model, other)


@pytest.mark.slow
def test_what_it_chooses_beats_the_papers_kinds_and_trees_are_for_what_is_felt():
    fit = fit_model("auto", "x", training(), FitOptions(smooth_s=0.0))
    other = recording("other", press(1.7, 0.9 * DEPTH_M, 3))
    errors = {
        kind: rmse_n(fit_model(kind, "x", training(), FitOptions(smooth_s=0.0)).model, other)
        for kind in ("hammerstein", "rf-fd", "rbf-fd")
    }
    others = [errors[kind] for kind in ("rf-fd", "rbf-fd")]
    assert errors["hammerstein"] == rmse_n(fit.model, other) < min(others)
    scores = {score["name"]: score["mean_n"] for score in fit.metadata["scores"]}
    felt_n = auto.FORCE_TOLERANCE * fit.model.trained.max_n
    assert scores["hammerstein"] - min(scores.values()) < felt_n
    assert fit.metadata["chosen"] == "hammerstein" and count_active_cells(fit.model) == 0


def test_a_forest_that_gives_energy_is_passed_over(monkeypatch):
    monkeypatch.setattr(auto, "count_active_cells", lambda model: 3)
    monkeypatch.setattr(auto, "forest_wins", lambda passive, forest, gain, peak_n: True)
    fit = fit_model("auto", "x", training(), OPTIONS)
    assert fit.metadata["chosen"] == "hammerstein"
    assert "rf-fd gives energy in 3 of its small motions" in fit.metadata["why"]


def score(name: str, ratio: float, without: float | None = None) -> Score:
    return Score(name, ratio, ratio, ratio, 5, ratio, ratio if without is None else without)


@pytest.mark.parametrize(
    ("ratio", "without", "wins"), [(0.94, 0.945, True), (0.96, 0.96, False), (0.5, 0.99, False)]
)
def test_trees_only_for_a_gain_that_does_not_rest_on_one_fold(ratio, without, wins):
    scores = score("hammerstein", 1.0), score("trees", ratio, without)
    assert forest_wins(*scores, gain=0.05, peak_n=1.0) is wins
    words = explain_choice(*scores, 0.05, 1.0, 0)
    assert ("one fold" in words) == (ratio == 0.5)
    assert f"{round(100 * (1 - ratio))} % less error" in words


def test_one_recording_asks_more_of_trees(monkeypatch):
    found = score("hammerstein", 1.0), score("rf-fd", 0.93)
    monkeypatch.setattr(auto, "find_scores", lambda *_: found)
    monkeypatch.setattr(auto, "fit_kind", lambda *_: small_fit())
    monkeypatch.setattr(auto, "count_active_cells", lambda _: 0)
    sets = [build_training_set(training()[-n:], 0.0) for n in (1, 2)]
    chosen = [auto.fit_auto("x", data, OPTIONS).metadata["chosen"] for data in sets]
    assert chosen == ["hammerstein", "rf-fd"]


def test_what_is_felt_is_of_the_greatest_force_either_way(monkeypatch):
    peaks_n = []
    monkeypatch.setattr(auto, "find_scores", lambda *_: (score("a", 1.0), score("b", 1.0)))
    monkeypatch.setattr(auto, "fit_kind", lambda *_: small_fit())
    monkeypatch.setattr(auto, "forest_wins", lambda *its: peaks_n.append(its[-1]))
    data = build_training_set(training(), 0.0)
    for max_n, min_n in ((3.0, -9.0), (9.0, -3.0)):
        trained = replace(data.trained, max_n=max_n, min_n=min_n)
        auto.fit_auto("x", replace(data, trained=trained), OPTIONS)
    assert set(peaks_n) == {9.0}


def test_small_motions_are_within_the_trained_depth(monkeypatch):
    model, begins_m = passive_model(), set()
    glued = replace(model, contact="always", trained=replace(model.trained, min_m=4e-3, max_m=0.01))

    def predicted_n(_, motion):
        begins_m.add(float(motion.position_m[0].round(6)))
        return motion.position_m

    monkeypatch.setattr(predict, "predict_n", predicted_n)
    assert count_active_cells(glued) == 0 and begins_m == {0.0052, 0.0061, 0.007, 0.0079, 0.0088}


def test_trees_only_for_what_is_felt():
    scores = score("hammerstein", 1.0), score("trees", 0.5)
    assert forest_wins(*scores, 0.05, peak_n=10.0) and not forest_wins(*scores, 0.05, peak_n=2000.0)
    assert "nobody feels that" in explain_choice(*scores, 0.05, 2000.0, 0)


def test_the_best_fold_is_left_out_and_a_family_of_many_folds_counts_as_one_of_few():
    errors_n, one_family = np.array([0.2, 1.0, 1.0]), np.zeros(3, dtype=np.intp)
    found = scores._build_score("trees", errors_n, np.ones(3), one_family)
    assert found.ratio == pytest.approx(0.2 ** (1 / 3)) and found.ratio_without_best == 1.0
    lower_n, passive_n = np.array([0.4, 0.3]), np.array([1.0, 0.5])
    found = scores._build_score("trees", lower_n, passive_n, one_family[:2])
    assert found.ratio_without_best == pytest.approx(0.6)
    errors_n, families = np.array([1.0, 1.0, 1.0, 16.0]), np.array([0, 0, 0, 1])
    found = scores._build_score("trees", errors_n, np.ones(4), families)
    assert (found.recordings_n, found.conditions_n) == pytest.approx((1.0, 16.0))
    assert (found.mean_n, found.ratio) == pytest.approx((4.0, 4.0))


@pytest.mark.parametrize(("ratio", "ends"), [(1.2, []), (1.5, [3]), (2.5, [2, 3])])
def test_a_forest_is_given_up_after_two_folds_or_the_first_family(ratio, ends):
    families = np.array([0, 0, 0, 1, 1, 2])
    assert [n for n in range(1, 7) if scores._is_hopeless(np.full(n, ratio), families)] == ends


@pytest.mark.parametrize("late", [0, 1, 3])
def test_a_spring_gives_as_much_energy_as_it_is_late(late):
    least = SmallMotion(20.0, DT_S, late).min_sin_delta(lambda x, _: 400.0 * x, 5e-3, DEPTH_M)
    assert least == pytest.approx(-np.sin(2.0 * np.pi * 20.0 * late * DT_S), abs=1e-9)
