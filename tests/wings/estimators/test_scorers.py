"""scikit-learn's scoring of whole recordings, of one length or of several."""

import warnings

import numpy as np
import pytest
from sklearn.metrics import get_scorer
from sklearn.model_selection import KFold, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer
from support.messages import refusing
from support.small import training

from springpot.codegen.errors import DataError, UsageError
from springpot.host.wings.estimators.estimator import PositionRegressor, neg_rmse_n

LENGTH = min(len(item.force_n) for item in training())
X = [item.position_m for item in training()]
Y = [item.force_n for item in training()]
EVEN = [x[:LENGTH] for x in X], [y[:LENGTH] for y in Y]
CUT = [LENGTH - 9 * i for i in range(len(X))]
RAGGED = (
    [x[:n] for x, n in zip(X, CUT, strict=True)],
    [y[:n] for y, n in zip(Y, CUT, strict=True)],
)
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")


@pytest.mark.parametrize("data", [EVEN, RAGGED], ids=["even", "ragged"])
def test_the_scorer_pools_the_samples_of_all_recordings(data):
    positions, forces = data
    model = make_pipeline(FunctionTransformer(), PositionRegressor("springpot", 1e-3))
    scores = cross_val_score(model, positions, forces, cv=2, scoring=neg_rmse_n)
    for score, (fitted, held) in zip(scores, KFold(2).split(positions), strict=True):
        one = PositionRegressor("springpot", 1e-3)
        one.fit([positions[i] for i in fitted], [forces[i] for i in fitted])
        errors_n = [one.predict([positions[i]])[0] - forces[i] for i in held]
        assert -score == pytest.approx(np.sqrt(np.mean(np.concatenate(errors_n) ** 2)))


@pytest.mark.parametrize("data", [EVEN, RAGGED], ids=["even", "ragged"])
@pytest.mark.parametrize("name", ["r2", "neg_root_mean_squared_error", "neg_mean_absolute_error"])
def test_scorers_that_take_samples_for_outputs_give_no_number(data, name):
    fitted = PositionRegressor("springpot", 1e-3).fit(*data)
    with refusing(UsageError, "scoring=springpot.neg_rmse_n"):
        get_scorer(name)(fitted, EVEN[0], EVEN[1])
    scores = cross_val_score(PositionRegressor("springpot", 1e-3), *data, cv=2, scoring=name)
    assert np.isnan(scores).all()


def test_recordings_are_taken_for_their_sequences():
    whole = PositionRegressor("springpot", 1e-3).fit(training(), training())
    parts = PositionRegressor("springpot", 1e-3).fit(X, Y)
    np.testing.assert_array_equal(whole.predict(training())[0], parts.predict(X)[0])
    assert whole.score(training(), training()) == parts.score(X, Y)
    for other in (
        PositionRegressor("springpot", 2e-3),
        PositionRegressor("springpot", 1e-3, zero="min"),
    ):
        with refusing(DataError, "dt_s=0.001 and zero='none'", "the regressor"):
            other.fit(training(), training())


@pytest.mark.parametrize("times", [1.0, 1.4, 1.6, 4.0])
def test_what_goes_beyond_the_training_presses_is_said(times):
    fitted = PositionRegressor("springpot", 1e-3).fit(X, Y)
    deepest_m = fitted.model_.trained.max_m
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        fitted.predict([X[0], times * deepest_m * np.linspace(0.0, 1.0, 50)])
    assert [str(one.message).startswith("X[1]: goes to") for one in told] == [True] * (times > 1.5)


def test_recordings_of_other_lengths_are_not_scored() -> None:
    """Two lengths that change places have the same sum."""
    fitted = PositionRegressor("springpot", 1e-3).fit(X, Y)
    of_two = [X[0], X[1][:-5]]
    for wrong in ([Y[0][:-5], Y[1]], [Y[0], Y[1]]):
        with pytest.raises(DataError, match="pair them"):
            fitted.score(of_two, wrong)
        with pytest.raises(DataError, match="pair them"):
            neg_rmse_n(fitted, of_two, wrong)
