"""Kind `auto`: chosen by cross-validation on the training recordings, and why."""

import dataclasses
import logging

import numpy as np
import pytest
from support.small import DT_S, press, training

from springpot.codegen.model.model import Model
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import fold_families
from springpot.trainer.models.predict import predict_n
from springpot.trainer.models.training_set import training_set
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.selection.auto import Score, choose_score

OPTIONS = FitOptions(seed=3, trees=10, smooth_s=0.0)


def spring(name: str, depth_m: np.ndarray) -> Recording:
    return Recording(name, depth_m, 400.0 * depth_m + 3e4 * depth_m**2, DT_S)


def rmse_n(model: Model, test: Recording) -> float:
    return float(np.sqrt(np.mean((predict_n(model, test) - test.force_n) ** 2)))


def test_a_plain_spring_needs_no_forest(caplog):
    caplog.set_level(logging.INFO, "springpot.trainer")
    presses = [spring(f"{k}", press(k, 0.01)) for k in (2.0, 3.0, 4.0)]
    fit = fit_model("auto", "x", presses, OPTIONS)
    tried = [score["name"] for score in fit.metadata["scores"]]
    assert caplog.messages == [f"{k} of {len(tried)}: {n}" for k, n in enumerate(tried, 1)]
    scores = {score["name"]: score["mean_n"] for score in fit.metadata["scores"]}
    assert fit.metadata["chosen"].startswith("hammerstein")
    assert fit.model.regressor is None
    assert {"rf-fd", "rf-fd long", "rbf-fd", "boosted"} <= set(scores)
    assert len(scores) == len(fit.metadata["scores"])
    other, forest = spring("other", press(2.4, 0.008)), fit_model("rf-fd", "x", presses, OPTIONS)
    assert rmse_n(fit.model, other) < 0.1 * rmse_n(forest.model, other)


def test_the_choice_is_the_same_again_and_sees_one_recording_in_blocks():
    long = [spring("one", np.concatenate([press(k, 0.01) for k in (2.0, 3.0, 4.0)]))]
    first, again = (fit_model("auto", "x", long, OPTIONS) for _ in range(2))
    assert first.metadata["scores"] == again.metadata["scores"]
    data = training_set(long, 0.0)
    rows = np.arange(data.rows_total)
    (folds,) = fold_families(data, rows, seed=0)
    assert np.all(np.diff(folds.number) >= 0)
    assert folds.tested == (0, 1, 2, 3, 4)


def test_repeats_of_one_press_are_one_condition():
    same = [dataclasses.replace(training()[3], name=f"{k}") for k in range(4)]
    data = training_set(same, 0.0)
    assert len(fold_families(data, np.arange(data.rows_total), seed=0)) == 1
    assert fit_model("auto", "x", same, OPTIONS).metadata["chosen"]


@pytest.mark.parametrize(("dear_n", "chosen"), [(0.996, "cheap"), (0.99, "dear")])
def test_the_cheaper_of_two_within_half_a_per_cent(dear_n, chosen):
    """Or within 0.05 % of the maximum force."""
    scores = [Score("cheap", 1, 1.0, 1.0, 1.0), Score("dear", 5, dear_n, dear_n, dear_n)]
    assert choose_score(scores, peak_n=1.0).name == chosen
    assert choose_score(scores, peak_n=30.0).name == "cheap"
