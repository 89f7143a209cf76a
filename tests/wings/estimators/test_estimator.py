"""scikit-learn's tools on springpot's models, and the user's own ensembles in C."""

import pickle
import warnings
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.ensemble import (
    ExtraTreesRegressor,
    HistGradientBoostingRegressor,
    RandomForestRegressor,
)
from sklearn.exceptions import NotFittedError
from sklearn.model_selection import GridSearchCV, cross_val_score
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import FunctionTransformer
from support.small import recording, scene, training, wandering

from springpot.codegen.errors import DataError, SpringpotError, UsageError
from springpot.codegen.plan.make_plan import make_plan
from springpot.host.native.trial_build import built
from springpot.host.wings.estimators.ensemble import ensemble_data, from_ensemble
from springpot.host.wings.estimators.estimator import PositionRegressor
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.limited import limited_n
from springpot.trainer.models.predict import predict_n
from springpot.trainer.models.rf_fd import history_features

X = [item.position_m for item in training()]
Y = [item.force_n for item in training()]


def small(kind: str = "rf-fd") -> PositionRegressor:
    sizes = {"trees": 5, "leaf": 20} if kind == "rf-fd" else {}
    return PositionRegressor(kind, 1e-3, **sizes)


@pytest.mark.parametrize("kind", ["rf-fd", "rbf-fd", "hammerstein", "springpot"])
def test_predictions_are_the_models(kind: str) -> None:
    fitted = small(kind).fit(X, Y)
    model = fit_model(kind, "x", training(), FitOptions(trees=5, leaf=20)).model
    for item, force_n in zip(training(), fitted.predict(X), strict=True):
        np.testing.assert_array_equal(force_n, limited_n(model, item))
    assert fitted.score(X, Y) > 0.9


def test_parameters_clones_and_pickles() -> None:
    regressor = small().set_params(dt_s=2e-3, window_s=0.1)
    assert clone(regressor).get_params() == regressor.get_params()
    assert clone(regressor).get_params()["dt_s"] == 2e-3
    fitted = small("hammerstein").fit(X, Y)
    again = pickle.loads(pickle.dumps(fitted))
    np.testing.assert_array_equal(again.predict(X[:1])[0], fitted.predict(X[:1])[0])
    with pytest.raises(NotFittedError):
        clone(fitted).predict(X)


def test_cross_validation_holds_out_recordings_in_a_pipeline() -> None:
    steps = Pipeline([("as it is", FunctionTransformer()), ("model", small("hammerstein"))])
    scores = cross_val_score(steps, X, Y, cv=3)
    assert scores.shape == (3,)
    assert scores.min() > 0.9
    search = GridSearchCV(small(), {"kind": ["springpot", "hammerstein"]}, cv=3).fit(X, Y)
    assert search.best_params_["kind"] in {"springpot", "hammerstein"}
    assert len(search.predict(X[:2])) == 2


def test_weights_count_recordings() -> None:
    fitted = small("springpot").fit(X, Y)
    only = np.zeros(len(X))
    only[3] = 1.0
    assert fitted.score(X, Y, only) == pytest.approx(fitted.score(X[3:4], Y[3:4]))


def test_time_between_samples_is_asked_for_or_the_recordings() -> None:
    with pytest.warns(UserWarning, match="dt_s is not given: arrays are taken at 1 ms a sample"):
        assert PositionRegressor("springpot").fit(X[:2], Y[:2]).dt_s_ == 1e-3
    slow = [replace(item, dt_s=2e-3) for item in training()[:2]]
    assert PositionRegressor("springpot").fit(slow, Y[:2]).dt_s_ == 2e-3
    with pytest.raises(DataError, match="has dt_s="):
        small("springpot").fit(slow, Y[:2])


@pytest.mark.parametrize("dt_s", [None, 1e-3])
@pytest.mark.parametrize(
    ("bad_x", "bad_y", "name"),
    [(X[0], Y[0], "X"), (X[:2], Y[0], "y"), ([X[0][:, None]], Y[:1], "X"), (0.0, Y, "X")],
)
def test_other_shapes_are_refused_before_their_time_is_asked_for(
    bad_x: Any, bad_y: Any, name: str, dt_s: float | None
) -> None:
    """A warning would be an error here."""
    with pytest.raises(DataError, match=rf"^{name}(\[0\])? "):
        PositionRegressor("springpot", dt_s=dt_s).fit(bad_x, bad_y)


def test_the_list_of_predict_says_how_its_arrays_are_taken() -> None:
    forces = small("springpot").fit(X[:2], Y[:2]).predict(X[:1])
    with pytest.raises(UsageError, match=r"take one, predict\(X\)\[0\], or numpy\.stack"):
        np.asarray(forces)
    np.testing.assert_array_equal(np.stack(forces)[0], forces[0])


def test_what_is_no_recording_is_refused() -> None:
    with pytest.raises(DataError, match=r"X\[0\] has shape \(\): .*for one recording, \[X\]"):
        small().fit(X[0], Y[0])
    alone = training()[0]
    with pytest.raises(DataError, match="X is one recording: give a list of them"):
        small().fit(alone, alone)
    with pytest.raises(DataError, match=r"X is a table: .*Recording\.from_frame"):
        small().fit(SimpleNamespace(columns=["time_s", "x_m"]), Y)  # type: ignore[arg-type]
    with pytest.raises(DataError, match="11 position and 12 force"):
        small().fit(X[1:], Y)
    with pytest.raises(UsageError, match="kind 'forest': use one of auto, rf-fd"):
        small("forest").fit(X, Y)
    with pytest.raises(SpringpotError, match="recording 0"):
        small().fit([X[0][:-1]], [Y[0]])


ENSEMBLES = [
    RandomForestRegressor(5, min_samples_leaf=20, random_state=0),
    ExtraTreesRegressor(5, min_samples_leaf=20, random_state=0),
    HistGradientBoostingRegressor(max_iter=30, learning_rate=0.3, random_state=0),
    HistGradientBoostingRegressor(
        max_iter=30, learning_rate=0.3, random_state=0, loss="absolute_error"
    ),
]


@pytest.mark.parametrize("lags", [False, True])
@pytest.mark.parametrize("number", ["float32", "float64"])
@pytest.mark.parametrize("ensemble", ENSEMBLES, ids=["forest", "extra", "boosted", "absolute"])
def test_ensembles_become_c(ensemble: object, number: str, lags: bool) -> None:
    features = history_features(1e-3, None) if lags else None
    values, force_n = ensemble_data(training(), features)
    regressor = clone(ensemble).fit(values, force_n)
    model = from_ensemble(regressor, training(), features, name="mine")
    item = recording("new", 0.8 * X[-1])
    assert predict_n(model, item).max() == pytest.approx(item.force_n.max(), rel=0.2)
    with built(make_plan(model, scene(number=number))) as library:
        assert library.selftest() == 0
        force_c, _ = library.new_state().run(item.position_m)
        library.new_state().run(wandering(3))
    inside = item.position_m > 0.002
    error_n = force_c[inside] - predict_n(model, item)[inside]
    assert np.percentile(np.abs(error_n), 99) < 0.03 * item.force_n.max()


def test_sequences_are_checked_as_recordings_are() -> None:
    with pytest.raises(ValueError, match="columns='position=COL:-1mm,force=COL:-1N'"):
        small("hammerstein").fit([-x for x in X], [-f for f in Y])
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        small("hammerstein").fit([1e2 * x for x in X[:4]], Y[:4])
    assert any("recording 2: 3.392 m/s of pressing" in str(each.message) for each in found)
