"""Features in 16-bit fixed point: what sp_quantise.h does, for a forest that was fitted on them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.model.regressors import Quantisation

GREATEST = 2**16 - 1


def rounded(rounding: Quantisation, features: NDArray[Any]) -> NDArray[np.float32]:
    """Whole steps, 0 .. 65535, of each column, shape (n, features), as scikit-learn takes them."""
    least = rounding.least.astype(np.float32)
    per_step = rounding.per_step.astype(np.float32)
    steps = (features.astype(np.float32) - least) * per_step + np.float32(0.5)
    inside = np.clip(steps, np.float32(0), np.float32(GREATEST))
    whole: NDArray[np.float32] = np.floor(inside)
    return whole


def rounding_over(features: NDArray[np.float64]) -> Quantisation:
    """Steps that cover the values of each column, shape (n, features)."""
    least, greatest = features.min(axis=0), features.max(axis=0)
    span = np.where(greatest > least, greatest - least, 1.0)
    return Quantisation(least=least, per_step=GREATEST / span)
