"""Tree ensembles of one's own on springpot's features, as models that can be emitted."""

from typing import Any

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import UsageError
from springpot.codegen.model.features import Features
from springpot.codegen.model.model import Model
from springpot.trainer.models.fit import FitOptions, assemble
from springpot.trainer.models.forests import depth_scale, ensemble_ir
from springpot.trainer.models.passive.passive_fit import fit_passive
from springpot.trainer.models.predict import regressor_force
from springpot.trainer.models.rf_fd import fractional_features
from springpot.trainer.models.training_set import TrainingSet, training_set
from springpot.trainer.paper import PAPER_SMOOTH_S
from springpot.trainer.recordings.recording_file import Recordings, given_recordings

KIND = "ensemble"
_AGREES = 1e-4  # of the peak force: float32 leaves a tree now and then on the other side
_CHECKED_ROWS = 5000


def ensemble_data(
    recordings: Recordings,
    features: Features | None = None,
    fraction: float | None = None,
    smooth_s: float = PAPER_SMOOTH_S,
    seed: int = 0,
) -> tuple[Samples, Samples]:
    """Features (rows, features) to fit an ensemble on, and forces (rows,), N.

    features: default the paper's ten orders. They are scaled by a power of two and rounded to
    float32, since scikit-learn takes values closer than 1e-7 for equal; `from_ensemble` undoes it.

    >>> features, force_n = ensemble_data(recordings)
    >>> features.shape[1], len(features) == len(force_n)
    (10, True)
    """
    data = training_set(given_recordings(recordings), smooth_s)
    features = features or fractional_features(data.dt_s, None)
    rows = data.rows(fraction, seed)
    return _scaled(data, features, rows), data.force_n(rows)


def from_ensemble(
    regressor: Any,
    recordings: Recordings,
    features: Features | None = None,
    name: str = KIND,
    smooth_s: float = PAPER_SMOOTH_S,
) -> Model:
    """Model of a RandomForest-, ExtraTrees- or HistGradientBoostingRegressor.

    It was fitted on `ensemble_data` of the same recordings, features and smooth_s. The passive
    model for what lies outside the trained depth is fitted here.
    Raises UsageError for another kind of regressor, or one that was fitted on something else.

    >>> forest = RandomForestRegressor(5, random_state=1).fit(*ensemble_data(recordings))
    >>> from_ensemble(forest, recordings).kind
    'ensemble'
    """
    data = training_set(given_recordings(recordings), smooth_s)
    features = features or fractional_features(data.dt_s, None)
    rows = np.unique(np.linspace(0, data.rows_total - 1, _CHECKED_ROWS).astype(np.intp))
    scale = _scale(data)
    forest = ensemble_ir(regressor).on_scaled(scale)  # a power of two: exact
    values = _scaled(data, features, rows)
    if regressor.n_features_in_ != values.shape[1]:
        raise UsageError(
            f"{type(regressor).__name__} was fitted on {regressor.n_features_in_} features, these "
            f"are {values.shape[1]}: fit it on ensemble_data of the same features"
        )
    predicted_n = np.asarray(regressor.predict(values), dtype=np.float64)
    force_n = data.force_n(rows)
    if predicted_n.ndim != 1:
        raise UsageError(f"the regressor has {predicted_n.shape[1]} outputs: fit it on one force")
    if np.mean(np.square(predicted_n - force_n)) >= np.var(force_n):
        raise UsageError(
            "the regressor is worse on these recordings than their mean force: fit it on "
            "ensemble_data of the same recordings and features"
        )
    differs = np.abs(regressor_force(forest, values / scale) - predicted_n)
    if np.percentile(differs, 99) > _AGREES * np.abs(predicted_n).max():
        raise UsageError(
            f"{type(regressor).__name__} is no weighted sum of its trees (loss "
            f"{getattr(regressor, 'loss', 'unknown')!r}): fit it with a squared error"
        )
    options = FitOptions(smooth_s=smooth_s)
    passive, _, _ = fit_passive(data, options)
    metadata = {"n_nodes": len(forest.feature), "regressor": type(regressor).__name__}
    parts = (features, forest)
    return assemble(KIND, name, data, options, data.rows_total, parts, passive, False, metadata)


def _scale(data: TrainingSet) -> float:
    return depth_scale(data.trained.max_m - min(data.trained.min_m, 0.0))


def _scaled(data: TrainingSet, features: Features, rows: Any) -> Samples:
    return (_scale(data) * data.features(features, rows)).astype(np.float32).astype(np.float64)
