"""Cubic radial basis functions with a linear tail on two standardised features."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.model.regressors import Rbf
from springpot.codegen.short_repr import short_repr


@dataclass(frozen=True, eq=False)
class Standard:
    """Standardisation of features: mean, scale and extremes, each of shape (features,)."""

    mean: Samples
    scale: Samples
    feature_min: Samples
    feature_max: Samples
    __repr__ = short_repr

    def __call__(self, features: Samples) -> Samples:
        """Clip to the extremes, then to mean 0 and scale 1."""
        inside = np.clip(features, self.feature_min, self.feature_max)
        return (inside - self.mean) / self.scale


def kernel(z: Samples, centers: Samples) -> Samples:
    """Rows of the linear system: |z - center|^3 for each center, 1, z. Shape (n, centers + 3)."""
    square = np.zeros((len(z), len(centers)))
    for i in range(z.shape[1]):
        square += np.square(z[:, i : i + 1] - centers[:, i])
    return np.concatenate([square * np.sqrt(square), np.ones((len(z), 1)), z], axis=1)


def rbf_force(rbf: Rbf, features: Samples) -> Samples:
    """Force at rows of features (n, features), (n,), N, in float64."""
    scaling = Standard(rbf.mean, rbf.scale, rbf.feature_min, rbf.feature_max)
    system = kernel(scaling(features), rbf.centers)
    force_n: Samples = system @ np.concatenate([rbf.weights_n, rbf.tail_n])
    return force_n
