"""Ensembles of one's own: those fitted on ensemble_data are taken, all others refused."""

import numpy as np
import pytest
from sklearn import ensemble, tree
from sklearn.base import clone
from sklearn.linear_model import LinearRegression
from sklearn.model_selection import GridSearchCV
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import MinMaxScaler, QuantileTransformer, StandardScaler
from support.messages import refusing
from support.small import training

from springpot.codegen.errors import UsageError
from springpot.host.ensemble import ensemble_data, from_ensemble, require_same_data
from springpot.trainer.models.ensembles import ensemble_ir
from springpot.trainer.models.predict import regressor_force

FOREST, EXTRA = ensemble.RandomForestRegressor, ensemble.ExtraTreesRegressor
BOOSTED, BAGGED = ensemble.HistGradientBoostingRegressor, ensemble.BaggingRegressor
GRADIENT = ensemble.GradientBoostingRegressor
RIGHT = [
    FOREST(5, random_state=0),
    FOREST(20, max_samples=0.35, min_samples_leaf=20, random_state=1),
    FOREST(1, max_depth=2, max_features=1, random_state=3),
    FOREST(3, min_samples_leaf=0.1, random_state=0),
    FOREST(10, max_samples=100, random_state=0),
    EXTRA(5, random_state=0),
    BOOSTED(max_iter=1, random_state=0),
    BOOSTED(max_iter=30, random_state=0),
]
ADDED = [
    tree.DecisionTreeRegressor(min_samples_leaf=20, random_state=0),
    tree.ExtraTreeRegressor(min_samples_leaf=20, random_state=0),
    GRADIENT(n_estimators=40, random_state=0),
    GRADIENT(n_estimators=40, init="zero", loss="huber", random_state=0),
    BAGGED(n_estimators=5, max_features=0.5, random_state=0),
    BAGGED(tree.ExtraTreeRegressor(min_samples_leaf=5), n_estimators=5, random_state=0),
    make_pipeline(StandardScaler(), FOREST(5, min_samples_leaf=20, random_state=0)),
    make_pipeline(MinMaxScaler(), "passthrough", BOOSTED(max_iter=30, random_state=0)),
]
STRONG = [RIGHT[i] for i in (0, 1, 5, 7)]
OTHER_FEATURES = {
    "standardised": lambda x: StandardScaler().fit_transform(x),
    "0 to 1": lambda x: MinMaxScaler().fit_transform(x),
    "reversed": lambda x: x[:, ::-1],
    "permuted": lambda x: x[:, np.random.default_rng(0).permutation(x.shape[1])],
    "twice": lambda x: 2.0 * x,
}
VALUES, FORCE_N = ensemble_data(training(), seed=1)
CHECKED = ensemble_data(training(), fraction=0.1, seed=2)


def check(regressor, values):
    fitted = clone(regressor).fit(values, FORCE_N)
    require_same_data(fitted, fitted.predict(CHECKED[0]), *CHECKED)


@pytest.mark.parametrize("regressor", [*RIGHT, *ADDED], ids=str)
def test_an_ensemble_on_the_right_features_is_taken_however_weak(regressor):
    check(regressor, VALUES)


@pytest.mark.parametrize("other", OTHER_FEATURES.values(), ids=OTHER_FEATURES)
@pytest.mark.parametrize("regressor", STRONG, ids=str)
def test_an_ensemble_on_other_features_is_refused_with_its_error(regressor, other):
    with refusing(UsageError, "R2 of ", "other features", "ensemble_data"):
        check(regressor, other(VALUES))


@pytest.mark.parametrize("regressor", ADDED, ids=str)
def test_a_sum_of_trees_is_its_predictions(regressor):
    fitted = clone(regressor).fit(VALUES, FORCE_N)
    given_n, wanted_n = regressor_force(ensemble_ir(fitted), VALUES), fitted.predict(VALUES)
    # Leaves are rounded to a fixed point; a scaler's rounding moves a few rows past a threshold.
    assert np.mean(np.abs(given_n - wanted_n) > 5e-5 * FORCE_N.max()) < 5e-3
    assert from_ensemble(fitted, training()).kind == "ensemble"


def test_what_is_no_fitted_ensemble_is_told_what_to_give():
    small = FOREST(2, max_depth=2)
    on_line = GRADIENT(n_estimators=2, init=LinearRegression())
    bent = make_pipeline(QuantileTransformer(n_quantiles=9), clone(small))
    search = GridSearchCV(small, {"max_depth": [1]}, cv=2)
    two = np.stack([FORCE_N, FORCE_N], axis=1)
    poisson = BOOSTED(max_iter=50, loss="poisson").fit(VALUES, np.maximum(FORCE_N, 0.0))
    for given, says in (
        (clone(small).fit(VALUES[:, :4], FORCE_N), "fitted on 4 features, these are 10"),
        (clone(STRONG[0]).fit(VALUES / 1000, FORCE_N), "R2 of "),
        (clone(small).fit(VALUES, two), "outputs: fit it on one force"),
        (poisson, "no weighted sum of its trees"),
        (on_line.fit(VALUES, FORCE_N), "begins with LinearRegression: leave init out"),
        (bent.fit(VALUES, FORCE_N), "step quantiletransformer is no scaling"),
        (BAGGED(LinearRegression()).fit(VALUES, FORCE_N), "give one of trees"),
        (LinearRegression().fit(VALUES, FORCE_N), "is no sum of trees"),
        (search, "best_estimator_"),
        (small, "is not fitted"),
        (FOREST, "is not fitted"),
        (None, "give a fitted"),
    ):
        with refusing(UsageError, says):
            from_ensemble(given, training())
