"""Regressors of one's own on springpot's features, as models that can be emitted."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone
from sklearn.metrics import r2_score

from springpot.codegen.arrays import Indices, Samples, to_float64
from springpot.codegen.errors import SpringpotError, UsageError
from springpot.codegen.messages import notice
from springpot.codegen.model.features import Features
from springpot.codegen.model.model import Model
from springpot.codegen.model.regressors import Forest, Regressor
from springpot.codegen.scene import Runtime
from springpot.codegen.stages.stage import regressor_stage
from springpot.trainer.models.ensembles import convert_ensemble, convert_linear, require_fitted
from springpot.trainer.models.expressions import convert_expression
from springpot.trainer.models.fit import FitOptions, assemble
from springpot.trainer.models.passive.passive_fit import fit_passive
from springpot.trainer.models.rendered import (
    FEATURE_SCALE,
    features_of_c,
    why_it_differs,
)
from springpot.trainer.models.rf_fd import (
    PAPER_ORDERS,
    build_fractional_features,
)
from springpot.trainer.models.training_set import MAX_ROWS, TrainingSet, build_training_set
from springpot.trainer.recordings.quality.spikes import replace_spikes
from springpot.trainer.recordings.recording_file import Recordings, resolve_recordings

KIND = "ensemble"
GivenFeatures = Features | Sequence[float] | None
_AGREES = 1e-4  # of the peak force: what the C may err by against `predict`
_CHECKED_ROWS = 10_000  # of another fit, which may take seconds
# Of XGBoost and LightGBM.
_EARLY_STOPPING = {"early_stopping_rounds", "early_stopping_round", "callbacks"}
# Of 1 - R2 of the same regressor on right features, or of the mean force. On a silicone five kinds
# had up to 1.3 times that of their like, and 0.0016 to its 0.0007 if fitted on a fiftieth of the
# rows; on orders that are 0.02 higher they had 0.005 to 0.011, 2.1 to 7 times that. With twice the
# limits those would pass.
_TIMES, _MORE = 2.0, 0.001


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
    fraction: of the rows, in their order of time; default all, from 20 000 rows on a fifth at
    random. `fraction=1.0` takes all in order, 50 000 at most: of more, call it for each recording.
    return_groups: also the number of each row's recording, (rows,), as scikit-learn's GroupKFold
    takes them. Raises UsageError for an order.

    >>> features, force_n = ensemble_data(recordings)
    >>> features.shape[1], len(features) == len(force_n)
    (10, True)
    """
    held = [replace_spikes(recording)[0] for recording in resolve_recordings(recordings)]
    data = build_training_set(held, smooth_s)
    rows = data.rows(fraction, seed)
    if fraction is None and len(rows) < data.rows_total:
        notice(
            f"ensemble_data takes {len(rows)} of {data.rows_total} rows, at random: fraction=1.0 "
            f"takes all, up to {MAX_ROWS}"
        )
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

    It was fitted on `ensemble_data` of the same recordings, features and smooth_s: give the same
    here. Its R2 tells other recordings and columns in another order; it may not tell ten other
    orders, and tells no other smooth_s. The passive model for what lies outside the trained depth
    is fitted here.
    Raises UsageError for another kind of regressor, or an R2 that tells another fit.

    >>> forest = RandomForestRegressor(5, random_state=1).fit(*ensemble_data(recordings))
    >>> from_ensemble(forest, recordings).kind
    'ensemble'
    """
    held = [replace_spikes(recording)[0] for recording in resolve_recordings(recordings)]
    data = build_training_set(held, smooth_s)
    features = _features(features, data.dt_s)
    rows = data.even_rows()
    values = _scaled(data, features, rows)
    regressor = getattr(regressor, "best_estimator_", regressor)  # of a search
    require_fitted(regressor)
    if regressor.n_features_in_ != values.shape[1]:
        raise UsageError(
            f"{type(regressor).__name__} was fitted on {regressor.n_features_in_} features, these "
            f"are {values.shape[1]}: fit it on ensemble_data of the same features"
        )
    with _one_line(regressor):
        predicted_n = np.asarray(regressor.predict(values), dtype=np.float64)
    if predicted_n.ndim != 1:
        raise UsageError(f"the regressor has {predicted_n.shape[1]} outputs: fit it on one force")
    regressor_model, error_n = _convert(regressor, data, features, rows, values, predicted_n)
    checked = np.linspace(0, len(rows) - 1, min(len(rows), _CHECKED_ROWS)).astype(np.intp)[::2]
    require_same_data(regressor, predicted_n[checked], values[checked], data.force_n(rows[checked]))
    options = FitOptions(smooth_s=smooth_s)
    passive = fit_passive(data, options)
    metadata = {"regressor": type(regressor).__name__, "predict_error_n": error_n, "rows": None}
    parts = (features, regressor_model)
    return assemble(KIND, name, data, options, data.rows_total, parts, passive, False, metadata)


@contextmanager
def _one_line(regressor: Any) -> Iterator[None]:
    """Turn errors of a regressor's library, of any kind, into a UsageError."""
    try:
        yield
    except (SpringpotError, KeyError, ModuleNotFoundError):  # of a converter
        raise
    except Exception as error:
        reason = " ".join(str(error).split())[:100]
        raise UsageError(
            f"{type(regressor).__name__} fails on rows of ensemble_data ({reason}): fit it on "
            "those, with a squared error"
        ) from error


def _convert(
    regressor: Any,
    data: TrainingSet,
    features: Features,
    rows: Indices,
    values: Samples,
    predicted_n: Samples,
) -> tuple[Regressor, float]:
    """Convert a regressor to weights, trees or m2cgen's operations; return N that the C errs by.

    Compared at each row in contact. Of trees, whose force jumps where the C's rounding of a feature
    crosses a threshold, on the features that the C computes, and at 99 of 100 rows.
    """
    linear = convert_linear(regressor, values, predicted_n)
    air_m = 0.0 if data.contact == "surface" else -np.inf
    contact = np.concatenate(data.depths_m)[rows] > air_m
    peak_n = float(np.abs(predicted_n).max())
    c_values = features_of_c(data, features, rows[contact])
    refusals = []
    for convert in (lambda _: linear,) if linear else (convert_ensemble, convert_expression):
        try:
            with _one_line(regressor):
                found: Regressor = convert(regressor)
        except KeyError:  # a kind that is no sum of trees
            continue
        except ModuleNotFoundError:
            raise UsageError(
                f"{type(regressor).__name__}: m2cgen writes its C: pip install 'springpot[m2cgen]'"
            ) from None
        except UsageError as refusal:
            refusals.append(refusal)
            continue
        if isinstance(found, Forest) and not np.isfinite(found.threshold).all():
            raise UsageError(
                f"{type(regressor).__name__} decides on thresholds that are not finite: fit it on "
                "rows without NaN or infinity, as ensemble_data returns them"
            )
        found = found.on_scaled(FEATURE_SCALE)  # a power of two: exact
        law = regressor_stage(found, np.arange(features.n_features), Runtime(), np.float32)
        expected_n, most = predicted_n[contact], 100
        if found.jumps:
            expected_n, most = regressor.predict(FEATURE_SCALE * c_values.astype(np.float64)), 99
        error_n = float(np.percentile(np.abs(law.reference(c_values) - expected_n), most))
        if error_n <= _AGREES * peak_n:
            return found, error_n
        refusals.append(UsageError(why_it_differs(regressor, found, error_n, peak_n)))
    raise refusals[0]


def require_same_data(
    regressor: Any, predicted_n: Samples, values: Samples, force_n: Samples
) -> None:
    """Raise UsageError if the regressor was plainly fitted on other features than these.

    It explains less of the force than its like on them. Its like has the same settings, however
    weak, and is fitted on every other row alone, or on as few as the regressor was: what is worse
    has seen other features, such as scaled ones.
    """
    like = clone(regressor)
    if like.get_params().get("max_samples") is not None:
        like.set_params(max_samples=1.0)  # `fitted` has as few rows as one of its trees had
    stops = like.get_params().keys() & _EARLY_STOPPING  # nothing is held out here to stop by
    like.set_params(**dict.fromkeys(stops))
    if hasattr(regressor, "best_iteration"):
        like.set_params(n_estimators=regressor.best_iteration + 1)
    fitted = np.zeros(len(values), dtype=bool)
    fitted[:: max(2, len(values) // _rows_of(regressor))] = True
    tested = ~fitted
    with _one_line(regressor):
        like.fit(values[fitted], force_n[fitted])
        r2_of_like = r2_score(force_n[tested], like.predict(values[tested]))
    r2 = r2_score(force_n[tested], predicted_n[tested])
    if 1.0 - r2 > _TIMES * min(1.0 - r2_of_like, 1.0) + _MORE:
        raise UsageError(
            f"the regressor has an R2 of {r2:.4f} on these recordings, and {r2_of_like:.4f} if it "
            "is fitted on their ensemble_data: it has seen other features (scaled, in another "
            "order, of other orders) or recordings: fit it on what ensemble_data returns, as it is"
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
