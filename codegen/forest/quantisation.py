"""Features in 16-bit fixed point: what sp_quantise.h does, for a forest that was fitted on them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.model.regressors import Quantisation

MAX = 2**16 - 1


def rounded(quantisation: Quantisation, features: NDArray[Any]) -> NDArray[np.float32]:
    """Bins of features (n, features), 0 .. 65535, as the float32 that scikit-learn takes."""
    feature_min = quantisation.feature_min.astype(np.float32)
    bins_per_unit = quantisation.bins_per_unit.astype(np.float32)
    steps = (features.astype(np.float32) - feature_min) * bins_per_unit + np.float32(0.5)
    inside = np.clip(steps, np.float32(0), np.float32(MAX))
    whole: NDArray[np.float32] = np.floor(inside)
    return whole


def quantisation_over(features: NDArray[np.float64]) -> Quantisation:
    """Bins that cover the values of each column, (n, features)."""
    feature_min, feature_max = features.min(axis=0), features.max(axis=0)
    span = np.where(feature_max > feature_min, feature_max - feature_min, 1.0)
    return Quantisation(feature_min=feature_min, bins_per_unit=MAX / span)
