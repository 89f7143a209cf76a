"""A model's own prediction on recordings: no guard, contact, coupling or limits."""

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.forest_table import forest_table, used_features
from springpot.codegen.ir import Model
from springpot.codegen.reference import forest_force
from springpot.trainer.fractional import fir_derivatives
from springpot.trainer.recording import Recording
from springpot.trainer.training_set import depth_m


def predict_n(model: Model, recording: Recording) -> NDArray[np.float64]:
    """Force of the model along a recording's positions, shape (n,), N."""
    depth = depth_m(recording, model.contact)
    kept = used_features(model.regressor)
    features = fir_derivatives(depth, model.features.taps[:, kept]).astype(np.float32)
    force_n: NDArray[np.float64] = forest_force(forest_table(model.regressor, np.float64), features)
    return force_n
