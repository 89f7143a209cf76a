"""Cubic radial basis functions with a linear tail on two standardised features."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.model.regressors import Rbf

_RIDGE = 1e-10
_GREEDY_CANDIDATES = 500


@dataclass(frozen=True, eq=False)
class Standard:
    """Standardisation of features: mean, scale and extremes, each of shape (features,)."""

    mean: Samples
    scale: Samples
    feature_min: Samples
    feature_max: Samples

    def __call__(self, features: Samples) -> Samples:
        """Clip to the extremes, then to mean 0 and scale 1."""
        inside = np.clip(features, self.feature_min, self.feature_max)
        return (inside - self.mean) / self.scale


def standard(features: Samples) -> Standard:
    """Mean, deviation and extremes of each column of features (n, features)."""
    scale = features.std(axis=0)
    return Standard(
        mean=features.mean(axis=0),
        scale=np.where(scale > 0.0, scale, 1.0),
        feature_min=features.min(axis=0),
        feature_max=features.max(axis=0),
    )


def kernel(z: Samples, centers: Samples) -> Samples:
    """Rows of the linear system: |z - center|^3 for each center, 1, z. Shape (n, centers + 3)."""
    square = np.zeros((len(z), len(centers)))
    for i in range(z.shape[1]):
        square += np.square(z[:, i : i + 1] - centers[:, i])
    return np.concatenate([square * np.sqrt(square), np.ones((len(z), 1)), z], axis=1)


def farthest_points(z: Samples, count: int) -> NDArray[np.intp]:
    """Rows of at most `count` points, (centers,), each the farthest from those before it."""
    chosen = [int(np.argmax(np.square(z).sum(axis=1)))]
    distance = np.square(z - z[chosen[0]]).sum(axis=1)
    while len(chosen) < min(count, len(z)) and distance.max() > 0.0:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.square(z - z[chosen[-1]]).sum(axis=1))
    return np.array(chosen)


def greedy_points(z: Samples, force_n: Samples, count: int) -> NDArray[np.intp]:
    """Rows of at most `count` centers, (centers,), each the one that lowers the error most ([17]).

    Orthogonal least squares over at most 500 candidates, spread by farthest point.
    """
    candidates = farthest_points(z, _GREEDY_CANDIDATES)
    system = kernel(z, z[candidates])
    n = len(candidates)
    tail, _ = np.linalg.qr(system[:, n:])
    columns = system[:, :n] - tail @ (tail.T @ system[:, :n])
    residual = force_n - tail @ (tail.T @ force_n)
    chosen: list[int] = []
    for _ in range(min(count, n)):
        size = np.square(columns).sum(axis=0)
        gain = np.where(size > 1e-12, np.square(columns.T @ residual) / np.maximum(size, 1e-12), -1)
        best = int(np.argmax(gain))
        if gain[best] <= 0.0:
            break
        direction = columns[:, best] / np.sqrt(size[best])
        columns -= np.outer(direction, direction @ columns)
        residual = residual - direction * (direction @ residual)
        chosen.append(best)
    return candidates[np.array(chosen, dtype=np.intp)]


def solve(system: Samples, force_n: Samples) -> tuple[Samples, float]:
    """Weights, (columns,), and the condition number, of least squares with a little damping.

    Without it the weights of near centers are large, of both signs: their sum loses digits in
    float32, and between the samples it is far off.
    """
    size = np.sqrt(np.square(system).sum(axis=0))
    left, singular, right = np.linalg.svd(system / size, full_matrices=False)
    condition = float(singular[0] / max(singular[-1], 1e-300))
    inverse = singular / (np.square(singular) + _RIDGE * singular[0] ** 2)
    weights: Samples = (right.T @ (inverse * (left.T @ force_n))) / size
    return weights, condition


def fit_rbf(
    features: Samples, force_n: Samples, count: int, choice: Literal["farthest", "greedy"]
) -> tuple[Rbf, float]:
    """Fit on rows; returns the functions and the condition number of their system."""
    scaling = standard(features)
    z = scaling(features)
    rows = greedy_points(z, force_n, count) if choice == "greedy" else farthest_points(z, count)
    centers = z[rows]
    weights, condition = solve(kernel(z, centers), force_n)
    n = len(centers)
    rbf = Rbf(
        mean=scaling.mean,
        scale=scaling.scale,
        feature_min=scaling.feature_min,
        feature_max=scaling.feature_max,
        centers=centers,
        weights_n=weights[:n],
        tail_n=weights[n:],
    )
    return rbf, condition


def rbf_force(rbf: Rbf, features: Samples) -> Samples:
    """Force at rows of features (n, features), (n,), N, in float64."""
    scaling = Standard(rbf.mean, rbf.scale, rbf.feature_min, rbf.feature_max)
    system = kernel(scaling(features), rbf.centers)
    force_n: Samples = system @ np.concatenate([rbf.weights_n, rbf.tail_n])
    return force_n
