"""Regressors of one's own on springpot's features, as models that can be emitted."""

import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone
from sklearn.metrics import r2_score

from springpot.codegen.arrays import Samples, to_float64
from springpot.codegen.errors import UsageError
from springpot.codegen.model.features import Features
from springpot.codegen.model.model import Model
from springpot.codegen.model.regressors import Forest, Linear, Regressor
from springpot.trainer.models.ensembles import convert_ensemble, convert_linear, require_fitted
from springpot.trainer.models.expressions import convert_expression
from springpot.trainer.models.fit import FitOptions, assemble
from springpot.trainer.models.passive.passive_fit import fit_passive
from springpot.trainer.models.predict import regressor_force
from springpot.trainer.models.rf_fd import (
    PAPER_ORDERS,
    build_fractional_features,
)
from springpot.trainer.models.training_set import TrainingSet, build_training_set
from springpot.trainer.recordings.quality.spikes import replace_spikes
from springpot.trainer.recordings.recording_file import Recordings, resolve_recordings

KIND = "ensemble"
GivenFeatures = Features | Sequence[float] | None
_AGREES = 1e-4  # of the peak force: float32 leaves a tree now and then on the other side
_SINGLE_PRECISION = 1e-4  # of the peak force: what the C may err by against `predict`
_CHECKED_ROWS = 10_000
# Of depths in m: scikit-learn takes values closer than 1e-7 for equal, 0.8 nm. The same for every
# set: one that followed the depth gave a shallower test other features than its training.
FEATURE_SCALE = 128.0
# Of XGBoost and LightGBM.
_EARLY_STOPPING = {"early_stopping_rounds", "early_stopping_round", "callbacks"}
# Of 1 - R2 of the same regressor on right features, or of the mean force.
_TIMES, _MORE = 2.0, 0.005


def ensemble_data(
    recordings: Recordings,
    features: GivenFeatures = None,
    fraction: float | None = None,
    smooth_s: float | None = 0.0,
    seed: int = 0,
    return_groups: bool = False,
) -> tuple[NDArray[Any], ...]:
    """Features (rows, features) to fit an ensemble on, and forces (rows,), N.

    Without `smooth_s` they are what the C computes from these positions, in training and in tests:
    smoothed, a regressor differed from its own C by 0.3 to 0.6 N there. Forests trained on
    either miss the true force alike (0.81 and 0.82, 0.93 and 0.91 % of the peak).
    features: default the paper's ten orders; also a list of orders, each 0 to 1. They are scaled by
    a power of two and rounded to float32; `from_ensemble` undoes it.
    return_groups: also the number of each row's recording, (rows,), as scikit-learn's GroupKFold
    takes them. Raises UsageError for an order.

    >>> features, force_n = ensemble_data(recordings)
    >>> features.shape[1], len(features) == len(force_n)
    (10, True)
    """
    held = [replace_spikes(recording)[0] for recording in resolve_recordings(recordings)]
    data = build_training_set(held, smooth_s)
    rows = data.rows(fraction, seed)
    columns = _scaled(data, _features(features, data.dt_s), rows), data.force_n(rows)
    return (*columns, data.recording_index(rows)) if return_groups else columns


def from_ensemble(
    regressor: Any,
    recordings: Recordings,
    features: GivenFeatures = None,
    name: str = KIND,
    smooth_s: float | None = 0.0,
) -> Model:
    """Model of a sum of trees, scaled columns in front or not, or of a law linear in features.

    It was fitted on `ensemble_data` of the same recordings, features and smooth_s, which is checked
    by its R2. The passive model for what lies outside the trained depth is fitted here.
    Raises UsageError for another kind of regressor, or one that was fitted on something else.

    >>> forest = RandomForestRegressor(5, random_state=1).fit(*ensemble_data(recordings))
    >>> from_ensemble(forest, recordings).kind
    'ensemble'
    """
    held = [replace_spikes(recording)[0] for recording in resolve_recordings(recordings)]
    data = build_training_set(held, smooth_s)
    features = _features(features, data.dt_s)
    rows = data.even_rows(_CHECKED_ROWS)
    values = _scaled(data, features, rows)
    regressor = getattr(regressor, "best_estimator_", regressor)  # of a search
    require_fitted(regressor)
    if regressor.n_features_in_ != values.shape[1]:
        raise UsageError(
            f"{type(regressor).__name__} was fitted on {regressor.n_features_in_} features, these "
            f"are {values.shape[1]}: fit it on ensemble_data of the same features"
        )
    predicted_n = np.asarray(regressor.predict(values), dtype=np.float64)
    force_n = data.force_n(rows)
    if predicted_n.ndim != 1:
        raise UsageError(f"the regressor has {predicted_n.shape[1]} outputs: fit it on one force")
    regressor_model, error_n = _convert(regressor, values, predicted_n)
    if isinstance(regressor_model, Linear):
        _require_single_precision(regressor_model, values, predicted_n)
    elif isinstance(regressor_model, Forest) and not np.isfinite(regressor_model.threshold).all():
        raise UsageError(
            f"{type(regressor).__name__} decides on thresholds that are not finite: fit it on rows "
            "without NaN or infinity, as ensemble_data returns them"
        )
    require_same_data(regressor, predicted_n[::2], values[::2], force_n[::2])
    options = FitOptions(smooth_s=smooth_s)
    passive = fit_passive(data, options)
    metadata = {"regressor": type(regressor).__name__, "predict_error_n": error_n}
    parts = (features, regressor_model.on_scaled(FEATURE_SCALE))  # a power of two: exact
    return assemble(KIND, name, data, options, data.rows_total, parts, passive, False, metadata)


def _convert(regressor: Any, values: Samples, predicted_n: Samples) -> tuple[Regressor, float]:
    """What renders a regressor: weights, trees, or what m2cgen writes; N that it errs by at most.

    Of 99 in 100 rows: float32 leaves a tree now and then on the other side.
    """
    linear = convert_linear(regressor, values, predicted_n)
    refusals = []
    for convert in (lambda _: linear,) if linear else (convert_ensemble, convert_expression):
        try:
            found: Regressor = convert(regressor)
        except KeyError:  # a kind that is no sum of trees
            continue
        except UsageError as refusal:
            refusals.append(refusal)
            continue
        differs_n = np.abs(regressor_force(found, values) - predicted_n)
        error_n = float(np.percentile(differs_n, 99))
        if error_n <= _AGREES * np.abs(predicted_n).max():
            return found, error_n
        refusals.append(
            UsageError(
                f"{type(regressor).__name__} is no weighted sum of its trees: fit it with a "
                "squared or absolute error, without dart, linear_tree or an init of its own"
            )
        )
    raise refusals[0]


def _require_single_precision(law: Linear, values: Samples, predicted_n: Samples) -> None:
    """Raise UsageError where weights that cancel leave the C's sum off by 1e-4 of the peak.

    values (rows, features) are exact in float32, and the C adds their products one by one.
    """
    weights = law.weights_n.astype(np.float32)
    sums = np.full(len(values), law.intercept_n, dtype=np.float32)
    for column, weight in zip(values.T.astype(np.float32), weights, strict=True):
        sums += column * weight
    off_n, peak_n = float(np.abs(sums - predicted_n).max()), float(np.abs(predicted_n).max())
    if off_n > _SINGLE_PRECISION * peak_n:
        raise UsageError(
            f"the weights, up to {np.abs(law.weights_n).max():.3g} N, cancel: in single precision "
            f"the force errs by up to {off_n:.2g} N of {peak_n:.3g} N: fit with a stronger "
            "penalty, such as Ridge(1.0)"
        )


def require_same_data(
    regressor: Any, predicted_n: Samples, values: Samples, force_n: Samples
) -> None:
    """Raise UsageError if the regressor was plainly fitted on other features than these.

    It explains less of the force than its like on them. Its like has the same settings, however
    weak, and is fitted on every other row alone, or on as few as the regressor was: what is worse
    has seen other features, such as scaled ones.
    """
    like = clone(regressor)
    if isinstance(like.get_params().get("max_samples"), int):
        like.set_params(max_samples=None)  # more rows than there are here
    stops = like.get_params().keys() & _EARLY_STOPPING  # nothing is held out here to stop by
    like.set_params(**dict.fromkeys(stops))
    if hasattr(regressor, "best_iteration"):
        like.set_params(n_estimators=regressor.best_iteration + 1)
    fitted = np.zeros(len(values), dtype=bool)
    fitted[:: max(2, len(values) // _rows_of(regressor))] = True
    like.fit(values[fitted], force_n[fitted])
    tested = ~fitted
    r2 = r2_score(force_n[tested], predicted_n[tested])
    r2_of_like = r2_score(force_n[tested], like.predict(values[tested]))
    if 1.0 - r2 > _TIMES * min(1.0 - r2_of_like, 1.0) + _MORE:
        raise UsageError(
            f"the regressor has an R2 of {r2:.3f} on these recordings, and {r2_of_like:.3f} if it "
            "is fitted on their ensemble_data: it has seen other features (scaled, in another "
            "order) or recordings: fit it on what ensemble_data returns, as it is"
        )


def _rows_of(regressor: Any) -> int:
    """Rows that a regressor's first tree was fitted on, such as a fraction of all; else many."""
    if hasattr(regressor, "steps"):
        return _rows_of(regressor.steps[-1][1])
    if hasattr(regressor, "_predictors"):
        return int(regressor._predictors[0][0].nodes["count"][0])
    first = getattr(regressor, "estimators_", regressor)
    while isinstance(first, list | np.ndarray):
        first = first[0]
    return int(first.tree_.weighted_n_node_samples[0]) if hasattr(first, "tree_") else sys.maxsize


def _features(given: GivenFeatures, dt_s: float) -> Features:
    """Features themselves, or fractional derivatives of these orders, by default the paper's."""
    if not (given is None or isinstance(given, Sequence | np.ndarray)):
        return given
    orders = (
        PAPER_ORDERS if given is None else tuple(to_float64(given, "features").ravel().tolist())
    )
    if not orders or not all(0.0 <= order <= 1.0 for order in orders):
        raise UsageError(f"features={given!r}: give Features, or orders from 0 to 1")
    return build_fractional_features(dt_s, None, orders=orders)


def _scaled(data: TrainingSet, features: Features, rows: Any) -> Samples:
    return (FEATURE_SCALE * data.features(features, rows)).astype(np.float32).astype(np.float64)
