"""A model's own prediction on recordings: no guard, contact, coupling or limits."""

from collections.abc import Sequence
from functools import singledispatch

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.forest.leaves import used_features
from springpot.codegen.forest.quantisation import rounded
from springpot.codegen.forest.traverse import forest_force, table_sums
from springpot.codegen.forest.wide import forest_table
from springpot.codegen.model.model import Model
from springpot.codegen.model.regressors import Forest, Rbf, Regressor
from springpot.trainer.features.values import feature_values
from springpot.trainer.models.passive.passive_terms import hammerstein_force
from springpot.trainer.models.radial import rbf_force
from springpot.trainer.models.training_set import depth_m
from springpot.trainer.recordings.recording import Recording


def predict_n(model: Model, recording: Recording, rows: Indices | None = None) -> Samples:
    """Force along a recording's positions, (n,), N; or at `rows` of them, (rows,)."""
    rows = np.arange(len(recording.position_m)) if rows is None else rows
    return predict_each_n(model, [(recording, rows)])


def predict_each_n(model: Model, pieces: Sequence[tuple[Recording, Indices]]) -> Samples:
    """Force at rows of several recordings, (rows,), N: a forest's table is made once for all."""
    depths = [(depth_m(recording, model.contact), rows) for recording, rows in pieces]
    force_n = np.zeros(sum(len(rows) for _, rows in pieces))
    if model.features is not None and model.regressor is not None:
        values = [feature_values(model.features, depth, model.dt_s, rows) for depth, rows in depths]
        force_n += regressor_force(model.regressor, np.concatenate(values))
    if model.hammerstein is not None and model.hammerstein_adds:
        parts = [hammerstein_force(model.hammerstein, d, model.dt_s, rows) for d, rows in depths]
        force_n += np.concatenate(parts)
    return force_n


@singledispatch
def regressor_force(regressor: Regressor, values: Samples) -> Samples:
    """Force of features (n, features), N, shape (n,). Each kind of regressor registers its own."""
    raise TypeError(f"{type(regressor).__name__} has no force: register it with regressor_force")


@regressor_force.register
def _forest_force(forest: Forest, values: Samples) -> Samples:
    features = values.astype(np.float32)
    if forest.quantisation is not None:
        features = rounded(forest.quantisation, features)
    table = forest_table(forest, np.float64)
    kept = used_features(forest)
    force_n: Samples = forest_force(table, table_sums(table, features[:, kept]))
    return force_n


regressor_force.register(Rbf, rbf_force)
