"""Stages of radial basis functions (sp_rbf.h), and of weighted sums of the features."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.errors import UsageError
from springpot.codegen.literals import array_text, constant_text
from springpot.codegen.model.regressors import Linear, Rbf
from springpot.codegen.scene import Runtime
from springpot.codegen.stages.stage import (
    Columns,
    RegressorStage,
    regressor_stage,
    round_up,
    stage_code,
)
from springpot.codegen.types import RealType, Scalar

RBF_VECTOR_WIDTH = 8  # SP_RBF_WIDTH


@dataclass(frozen=True, eq=False)
class RbfStage(RegressorStage):
    """standard: shape (2, 4): feature_min, feature_max, mean, 1/scale of each feature.

    centers: (2, padded centers); weights_n: (padded centers,); tail_n: (3,).
    """

    standard: Reals
    centers: Reals
    weights_n: Reals
    tail_n: Reals

    headers = ("sp_number.h", "sp_rbf.h")

    code = stage_code("rbf")

    def tables(self) -> list[str]:
        """Render the C tables: scaling of the features, centres, weights, linear tail."""
        return [
            f"enum {{\n    N_CENTERS = {len(self.weights_n)}\n}};",
            "/* feature_min, feature_max, mean, 1/scale of each feature */",
            array_text("standard", "sp_real", self.standard),
            array_text("centers", "sp_real", self.centers),
            array_text("center_weights", "sp_real", self.weights_n),
            array_text("tail", "sp_real", self.tail_n),
        ]

    def reference(self, features: Reals) -> Reals:
        """Return the force at features (n, 2), (n,), N, by the operations of the C in numpy."""
        z = []
        for i in range(2):
            feature_min, feature_max, mean, per_scale = self.standard[i]
            below = np.where(features[:, i] < feature_max, features[:, i], feature_max)
            inside = np.where(below > feature_min, below, feature_min)
            z.append((inside - mean) * per_scale)
        # Eight partial sums, as the C's vectors add them: another order rounds otherwise.
        sums = np.zeros((RBF_VECTOR_WIDTH, len(features)), dtype=features.dtype)
        for block in range(0, len(self.weights_n), RBF_VECTOR_WIDTH):
            for i in range(RBF_VECTOR_WIDTH):
                d0 = z[0] - self.centers[0, block + i]
                d1 = z[1] - self.centers[1, block + i]
                square = d0 * d0 + d1 * d1
                sums[i] += self.weights_n[block + i] * (square * np.sqrt(square))
        s = sums
        radial = ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]))
        tail = self.tail_n
        force_n: Reals = radial + (tail[0] + (tail[1] * z[0] + tail[2] * z[1]))
        return force_n


@regressor_stage.register
def rbf_stage(rbf: Rbf, used: Columns, runtime: Runtime, dtype: RealType) -> RbfStage:
    """Make the C stage of radial basis functions; centres are padded to whole vectors.

    Raises UsageError for anything but two features.
    """
    n, n_features = rbf.centers.shape
    if n_features != 2:
        raise UsageError(f"radial basis functions on {n_features} features: the C has two")
    capacity = round_up(n, RBF_VECTOR_WIDTH)
    centers: Reals = np.zeros((2, capacity), dtype=dtype)
    centers[:, :n] = rbf.centers.T
    weights: Reals = np.zeros(capacity, dtype=dtype)
    weights[:n] = rbf.weights_n
    standard = np.stack([rbf.feature_min, rbf.feature_max, rbf.mean, 1.0 / rbf.scale], axis=1)
    return RbfStage(
        standard=standard.astype(dtype),
        centers=centers,
        weights_n=weights,
        tail_n=rbf.tail_n.astype(dtype),
    )


@dataclass(frozen=True, eq=False)
class LinearStage(RegressorStage):
    """A sum of the weighted features, one after another. weights_n: (features,)."""

    intercept_n: Scalar
    weights_n: Reals

    headers = ("sp_number.h",)
    code = stage_code("linear")

    def tables(self) -> list[str]:
        return [
            f"enum {{\n    N_FEATURES = {len(self.weights_n)}\n}};",
            constant_text("linear_intercept_n", self.intercept_n),
            array_text("linear_weights_n", "sp_real", self.weights_n),
        ]

    def reference(self, features: Reals) -> Reals:
        force_n: Reals = np.full(len(features), self.intercept_n)
        for weight_n, feature in zip(self.weights_n, features.T, strict=True):
            force_n += weight_n * feature
        return force_n


@regressor_stage.register
def linear_stage(linear: Linear, used: Columns, runtime: Runtime, dtype: RealType) -> LinearStage:
    """Weights of the columns that the regressor uses."""
    return LinearStage(dtype(linear.intercept_n), linear.weights_n[used].astype(dtype))
