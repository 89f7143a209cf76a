"""A model's own prediction on recordings: no guard, contact, coupling or limits."""

import numpy as np

from springpot.codegen.forest_quanta import used_features
from springpot.codegen.forest_table import forest_table
from springpot.codegen.forest_walk import forest_force, table_sums
from springpot.codegen.ir import Forest, Model, Rbf
from springpot.codegen.rounding import rounded
from springpot.trainer.feature_values import Rows, Samples, feature_values
from springpot.trainer.hammerstein import hammerstein_force
from springpot.trainer.rbf import rbf_force
from springpot.trainer.recording import Recording
from springpot.trainer.training_set import depth_m


def predict_n(model: Model, recording: Recording, rows: Rows | None = None) -> Samples:
    """Force of the model along a recording's positions, N; at all samples, or at `rows` of it."""
    depth = depth_m(recording, model.contact)
    rows = np.arange(len(depth)) if rows is None else rows
    force_n = np.zeros(len(rows))
    if model.features is not None and model.regressor is not None:
        values = feature_values(model.features, depth, model.dt_s, rows)
        force_n += regressor_force(model.regressor, values)
    if model.hammerstein is not None and model.hammerstein_adds:
        force_n += hammerstein_force(model.hammerstein, depth, model.dt_s, rows)
    return force_n


def regressor_force(regressor: Forest | Rbf, values: Samples) -> Samples:
    """Force of features (n, features), N."""
    if isinstance(regressor, Forest):
        kept = used_features(regressor)
        table = forest_table(regressor, np.float64)
        features = values.astype(np.float32)
        if regressor.rounding is not None:
            features = rounded(regressor.rounding, features)
        force_n: Samples = forest_force(table, table_sums(table, features[:, kept]))
        return force_n
    return rbf_force(regressor, values)
