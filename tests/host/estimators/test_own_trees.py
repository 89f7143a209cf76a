"""Regressors of one's own: those fitted on ensemble_data become C, all others are refused."""

import contextlib
import json
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from sklearn import ensemble, linear_model, preprocessing, svm, tree
from sklearn.base import clone
from sklearn.compose import TransformedTargetRegressor
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.model_selection import GridSearchCV
from sklearn.neighbors import KNeighborsRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import MinMaxScaler, QuantileTransformer, StandardScaler
from support.c.same_bits import require_same_bits
from support.messages import refusing
from support.paths import ROOT
from support.small import DEPTH_M, passive_model, press, scene, training, wandering

from springpot import Recording, predict
from springpot.codegen.errors import UsageError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.notes import LIMITED
from springpot.codegen.scene import Runtime, Scene
from springpot.host import ensemble as own
from springpot.host.ensemble import ensemble_data, from_ensemble, require_same_data
from springpot.trainer.models import rf_fd
from springpot.trainer.models.ensembles import convert_ensemble
from springpot.trainer.models.expressions import WRITTEN as WRITTEN_BY_M2CGEN
from springpot.trainer.models.predict import regressor_force
from springpot.trainer.models.training_set import build_training_set

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
    BAGGED(n_estimators=5, max_features=0.1, random_state=0),
    BAGGED(tree.ExtraTreeRegressor(min_samples_leaf=5), n_estimators=5, random_state=0),
    make_pipeline(StandardScaler(), FOREST(5, min_samples_leaf=20, random_state=0)),
    make_pipeline(MinMaxScaler(), "passthrough", BOOSTED(max_iter=30, random_state=0)),
]
LINEAR = [
    Ridge(),
    linear_model.Lasso(max_iter=100_000),
    linear_model.HuberRegressor(max_iter=1000),
    linear_model.TweedieRegressor(power=0, alpha=0.1),
    svm.SVR(kernel="linear"),
    svm.NuSVR(kernel="linear"),
    svm.LinearSVR(C=10.0, max_iter=100_000),
    make_pipeline(StandardScaler(), linear_model.BayesianRidge()),
    BAGGED(Ridge(), n_estimators=3, random_state=0),
    GridSearchCV(Ridge(), {"alpha": [0.1, 1.0]}, cv=2),
]
SCALED_SVR = make_pipeline(StandardScaler(), svm.SVR(C=10.0, epsilon=0.05))
TREES = [("a", FOREST(5, random_state=0)), ("b", GRADIENT(n_estimators=20, random_state=0))]
ADDED += [
    ensemble.VotingRegressor(TREES, weights=[1, 3]),
    TransformedTargetRegressor(FOREST(5, random_state=0), transformer=StandardScaler()),
]
WRITTEN = [  # by m2cgen
    svm.SVR(),
    svm.NuSVR(kernel="poly"),
    TransformedTargetRegressor(SCALED_SVR, transformer=StandardScaler()),
    ensemble.VotingRegressor([("a", SCALED_SVR), ("b", Ridge()), ("c", FOREST(2, max_depth=4))]),
]
with contextlib.suppress(ModuleNotFoundError):
    from lightgbm import LGBMRegressor

    LIGHT = LGBMRegressor(n_estimators=30, verbose=-1, n_jobs=1)
    bagged = {"boosting_type": "rf", "subsample": 0.5, "subsample_freq": 1}
    ADDED += [LIGHT, clone(LIGHT).set_params(**bagged)]
    WRITTEN.append(clone(LIGHT).set_params(objective="poisson"))
with contextlib.suppress(ModuleNotFoundError):
    from xgboost import XGBRegressor, XGBRFRegressor

    ADDED += [XGBRegressor(n_estimators=30, n_jobs=1), XGBRFRegressor(n_estimators=10, n_jobs=1)]
STIFF = [Recording(it.name, it.position_m, it.force_n**1.5, it.dt_s) for it in training()]
OBJECTS = {"soft": training(), "stiff": STIFF}
STRONG = [RIGHT[i] for i in (0, 1, 5, 7)]
OTHER_FEATURES = {
    "standardised": lambda x: StandardScaler().fit_transform(x),
    "0 to 1": lambda x: MinMaxScaler().fit_transform(x),
    "reversed": lambda x: x[:, ::-1],
    "permuted": lambda x: x[:, np.random.default_rng(0).permutation(x.shape[1])],
    "twice": lambda x: 2.0 * x,
}
BOOSTED_ELSEWHERE = json.loads((ROOT / "tests" / "data" / "boosted.json").read_text())
VALUES, FORCE_N = ensemble_data(training(), seed=1)
CHECKED = ensemble_data(training(), fraction=0.1, seed=2)


def check(regressor, values):
    fitted = clone(regressor).fit(values, FORCE_N)
    require_same_data(fitted, fitted.predict(CHECKED[0]), *CHECKED)


@pytest.mark.parametrize("regressor", [*RIGHT, *ADDED], ids=str)
def test_an_ensemble_on_the_right_features_is_taken_however_weak(regressor):
    check(regressor, VALUES)


def test_in_tests_as_in_training_the_features_are_those_of_the_c():
    forest = FOREST(5, min_samples_leaf=5, random_state=1).fit(VALUES, FORCE_N)
    noise_m = 1e-5 * np.random.default_rng(1).standard_normal(len(training()[0].position_m))
    test = replace(training()[0], position_m=training()[0].position_m + noise_m)
    values, _ = ensemble_data(test, fraction=1.0)
    rendered_n = predict(from_ensemble(forest, training()), test)
    pushes = rendered_n > 0.0  # a model with a surface never pulls
    off_n = np.abs(forest.predict(values) - rendered_n)[pushes]
    assert np.median(off_n) < 1e-4 * rendered_n.max()


@pytest.mark.parametrize("other", OTHER_FEATURES.values(), ids=OTHER_FEATURES)
@pytest.mark.parametrize("regressor", STRONG, ids=str)
def test_an_ensemble_on_other_features_is_refused_with_its_error(regressor, other):
    with refusing(UsageError, "R2 of ", "other features", "ensemble_data"):
        check(regressor, other(VALUES))


@pytest.mark.few(4)
@pytest.mark.parametrize("regressor", [SCALED_SVR, *LINEAR, *ADDED, *WRITTEN], ids=str)
@pytest.mark.parametrize("kind", OBJECTS)
def test_the_c_of_a_regressor_gives_its_predictions(regressor, kind, monkeypatch):
    written = regressor in (SCALED_SVR, *WRITTEN)
    if not written:
        monkeypatch.setitem(sys.modules, "m2cgen", None)
    passive = passive_model().hammerstein  # what lies outside the trained depth is not looked at
    monkeypatch.setattr(own, "fit_passive", lambda data, options: passive)
    values, force_n = ensemble_data(OBJECTS[kind], fraction=0.2, seed=1)
    fitted = clone(regressor).fit(values, np.maximum(force_n, 1e-9))
    model, position_m = from_ensemble(fitted, OBJECTS[kind]), press(3.0, 0.8 * DEPTH_M)
    require_same_bits(make_plan(model, scene("float64"), True), position_m)
    plan = make_plan(model, scene("float32"), True)
    require_same_bits(plan, wandering(1))
    given_n, notes = require_same_bits(plan, position_m)
    features = np.zeros((len(position_m), values.shape[1]), np.float32)  # as the C computes them
    computed = plan.features.reference(position_m.astype(np.float32), np.zeros(0, dtype=int))
    features[:, model.regressor.used_columns(values.shape[1])] = computed
    differs = np.abs(given_n - np.maximum(fitted.predict(own.FEATURE_SCALE * features), 0.0))
    differs = differs[(position_m > 0.1 * DEPTH_M) & ~(notes & LIMITED > 0)]  # nearer it fades in
    assert differs.max() < 1e-4 * given_n.max()
    assert model.provenance["predict_error_n"] < 1e-4 * given_n.max()
    if written:
        with refusing(UsageError, 'runtime.target = "cortex-m4f"', "libm", "fit trees"):
            make_plan(model, Scene(1, "x", "m", runtime=Runtime(target="cortex-m4f")))


class StoredBooster(SimpleNamespace):
    def __getitem__(self, trees):
        return SimpleNamespace(get_dump=lambda dump_format: self.dump[trees])


@pytest.mark.parametrize("made_by", BOOSTED_ELSEWHERE)
def test_boosted_trees_of_others_decide_as_they_did_at_every_threshold(made_by):
    its = SimpleNamespace(**BOOSTED_ELSEWHERE[made_by])
    booster = StoredBooster(dump=its.dump, dump_model=lambda: its.dump)
    parts = {"booster_": booster, "get_booster": lambda self: booster, **vars(its)}
    forest = convert_ensemble(type(its.kind, (), parts | {"intercept_": np.array(its.intercept)})())
    given_n = regressor_force(forest, np.array(its.values))
    np.testing.assert_allclose(given_n, its.force_n, atol=5e-5 * max(its.force_n))


def test_what_is_no_fitted_ensemble_is_told_what_to_give(monkeypatch):
    monkeypatch.setitem(sys.modules, "m2cgen", None)  # without it as with it
    vote = ensemble.VotingRegressor([("a", svm.SVR()), ("b", KNeighborsRegressor())])
    small = FOREST(2, max_depth=2)
    on_line = GRADIENT(n_estimators=2, init=LinearRegression())
    squares = make_pipeline(preprocessing.PolynomialFeatures(2), Ridge())
    logarithmic = TransformedTargetRegressor(clone(small), func=np.log1p, inverse_func=np.expm1)
    bent = make_pipeline(QuantileTransformer(n_quantiles=9), clone(small))
    search = GridSearchCV(small, {"max_depth": [1]}, cv=2)
    two = np.stack([FORCE_N, FORCE_N], axis=1)
    poisson = BOOSTED(max_iter=50, loss="poisson").fit(VALUES, np.maximum(FORCE_N, 0.0))
    for given, says in (
        (clone(small).fit(VALUES[:, :4], FORCE_N), "fitted on 4 features, these are 10"),
        (clone(STRONG[1]).fit(VALUES / 1000, FORCE_N), "R2 of "),
        (clone(small).fit(VALUES, two), "outputs: fit it on one force"),
        (poisson, "no weighted sum of its trees"),
        (on_line.fit(VALUES, FORCE_N), "an init of its own"),
        (bent.fit(VALUES, FORCE_N), "step quantiletransformer is no scaling"),
        (BAGGED(svm.SVR()).fit(*CHECKED), "give one of trees"),
        (KNeighborsRegressor().fit(*CHECKED), "no sum of trees or weighted features, and m2cgen"),
        (vote.fit(*CHECKED), "KNeighborsRegressor: the force is no sum of trees"),
        (squares.fit(*CHECKED), "polynomialfeatures is no scaling"),
        (logarithmic.fit(CHECKED[0], np.maximum(CHECKED[1], 0.0)), "transform of the force"),
        (search, "GridSearchCV: give a regressor fitted"),
        (linear_model.Lars().fit(*CHECKED), "cancel"),  # its weights run away
        (FOREST(9).fit(VALUES, FORCE_N), "fit fewer trees or larger leaves"),
        (type("Booster", (), {})(), "Booster: give LGBMRegressor or XGBRegressor"),
        (LinearRegression().fit(*CHECKED), "Ridge(1.0)"),
        (FOREST, "RandomForestRegressor: give a regressor fitted"),
        (None, "NoneType: give"),
    ):
        with refusing(UsageError, says):
            from_ensemble(given, training())


def test_without_m2cgen_what_it_writes_alone_is_told_to_install_it(monkeypatch):
    from m2cgen.assemblers import SUPPORTED_MODELS

    assert {name.partition("_")[2] for name in SUPPORTED_MODELS} >= WRITTEN_BY_M2CGEN
    monkeypatch.setitem(sys.modules, "m2cgen", None)
    with refusing(UsageError, "SVR: m2cgen writes its C", "pip install 'springpot[m2cgen]'"):
        from_ensemble(svm.SVR().fit(*CHECKED), training())


def test_the_error_of_the_c_counts_and_not_that_of_its_weights_in_double() -> None:
    double = SimpleNamespace(predict=lambda values: values @ [3e4, -3e4])
    data = build_training_set(training(), 0.0)
    bank, rows = own._features([0.3, 0.3001], data.dt_s), data.even_rows()
    values = own._scaled(data, bank, rows)
    with refusing(UsageError, "weights, up to 3e+04 N, cancel", "C errs by", "Ridge(1.0)"):
        own._convert(double, data, bank, rows, values, double.predict(values))


def test_other_orders_and_errors_of_libraries_are_refused_in_one_line() -> None:
    orders = [order + 0.02 for order in rf_fd.PAPER_ORDERS]
    for regressor in (BOOSTED(max_iter=100), FOREST(5, min_samples_leaf=5, random_state=0)):
        fitted = regressor.fit(*ensemble_data(training(), orders, seed=1))
        with refusing(UsageError, "R2 of 0.9", "other orders"):
            from_ensemble(fitted, training())

    fussy = type("Fussy", (Ridge,), {"predict": lambda self, values: int("one\nline")})()
    with refusing(UsageError, "Fussy fails on rows of ensemble_data (invalid literal", "fit it"):
        from_ensemble(fussy.fit(VALUES, FORCE_N), training())


def test_a_forest_on_thresholds_that_are_not_finite_is_refused() -> None:
    features, force_n = ensemble_data(training(), fraction=0.1, seed=1)
    holed = np.where(np.arange(len(features))[:, None] % 3 == 0, np.nan, features)
    forest = FOREST(2, max_depth=3, random_state=0).fit(holed, force_n)
    for each in forest.estimators_:
        each.tree_.threshold[0] = np.inf
    with refusing(UsageError, "not finite", "NaN"):
        from_ensemble(forest, training())
