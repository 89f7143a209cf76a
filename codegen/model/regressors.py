"""Kinds of regressors, features -> force: what each stores, and what others ask of it."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Indices, Samples, require, require_positive, require_shape
from springpot.codegen.errors import DataError
from springpot.codegen.messages import short_repr

MAX_DEPTH = 256  # splits on a path; fully grown trees on 50 000 rows have about 45


class Regressor(ABC):
    """Force, N, of a vector of features.

    needs_libm: its C calls more of libm than sqrt, which bare boards and pages lack.

    A kind of one's own has a stage that is registered with `regressor_stage`
    (codegen/stages/stage.py) and a float64 force registered with `regressor_force`
    (trainer/models/predict.py).
    """

    needs_libm: ClassVar[bool] = False

    @property
    def jumps(self) -> bool:
        """True if the force jumps where a feature crosses a threshold."""
        return False

    @abstractmethod
    def on_scaled(self, scale: float) -> Self:
        """Return the regressor r' with r'(z) = r(scale z)."""

    def require_valid(self, n_features: int) -> None:  # noqa: B027 (no rules)
        """Raise DataError, with field and reason, for what its types cannot tell."""

    def used_columns(self, n_features: int) -> Indices:
        """Columns of the features that it reads, ascending, (used,); all by default."""
        return np.arange(n_features)


@dataclass(frozen=True, eq=False)
class Quantisation:
    """Features as bins: floor((x - feature_min) bins_per_unit + 1/2), within 0 .. 65535.

    feature_min, bins_per_unit: shape (features,), of all features that the bank has.
    """

    feature_min: Samples
    bins_per_unit: Samples
    __repr__ = short_repr

    def on_scaled(self, scale: float) -> "Quantisation":
        """Return the same bins for features that are smaller by a factor."""
        return Quantisation(self.feature_min / scale, self.bins_per_unit * scale)

    def require_valid(self, n_features: int) -> None:
        """Raise DataError, with field and reason."""
        require_shape("quantisation.feature_min", self.feature_min, (n_features,))
        require_positive("quantisation.bins_per_unit", self.bins_per_unit, (n_features,))

    def take(self, columns: Indices) -> "Quantisation":
        return Quantisation(self.feature_min[columns], self.bins_per_unit[columns])


@dataclass(frozen=True, eq=False)
class Forest(Regressor):
    """Weighted sum of binary trees in one node table; left where float32(x) <= threshold.

    feature: shape (nodes,), int32, column of the split; -1 marks a leaf.
    threshold: (nodes,), float64, in the feature's unit.
    left, right: (nodes,), int32, children's rows; of leaves, without meaning.
    value_n: (nodes,), float64, force of a leaf.
    roots: (trees,), int32, each tree's first row.
    weight, bias_n: force = bias_n + weight x sum of the leaves (weight 1/trees for a mean).
    quantisation: where the trees were fitted on quantised features; thresholds are bins then.
    """

    feature: NDArray[np.int32]
    threshold: Samples
    left: NDArray[np.int32]
    right: NDArray[np.int32]
    value_n: Samples
    roots: NDArray[np.int32]
    weight: float
    bias_n: float
    quantisation: Quantisation | None = None
    __repr__ = short_repr

    @property
    def jumps(self) -> bool:
        return True

    def require_valid(self, n_features: int) -> None:
        require(self.weight > 0.0, f"weight: {self.weight:g} is not above 0")
        require_trees(self, n_features)
        if self.quantisation is not None:
            self.quantisation.require_valid(n_features)

    def on_scaled(self, scale: float) -> "Forest":
        if self.quantisation is not None:
            return replace(self, quantisation=self.quantisation.on_scaled(scale))
        return replace(self, threshold=self.threshold / scale)

    def on_columns(self, columns: Indices) -> "Forest":
        """The same on `build_design_matrices` alone, which are all that it uses, ascending."""
        inner, steps = self.feature >= 0, self.quantisation
        feature = np.where(inner, np.searchsorted(columns, self.feature), -1).astype(np.int32)
        return replace(self, feature=feature, quantisation=steps and steps.take(columns))

    def used_columns(self, n_features: int) -> Indices:
        used = np.unique(self.feature[self.feature >= 0]).astype(np.intp)
        return used if len(used) else np.zeros(1, dtype=np.intp)  # trees without a split


@dataclass(frozen=True, eq=False)
class Rbf(Regressor):
    """Cubic radial basis functions with a linear tail, on standardised features.

    z = (clip(feature, feature_min, feature_max) - mean) / scale, each of shape (features,).
    force = weights_n @ |z - centers|^3 + tail_n[0] + tail_n[1:] @ z; centers (n, features).
    """

    mean: Samples
    scale: Samples
    feature_min: Samples
    feature_max: Samples
    centers: Samples
    weights_n: Samples
    tail_n: Samples

    def require_valid(self, n_features: int) -> None:
        """Raise DataError, with field and reason, for shapes or numbers that C can not evaluate."""
        require_positive("scale", self.scale, (n_features,))
        for name in ("mean", "feature_min", "feature_max"):
            require_shape(name, getattr(self, name), (n_features,))
        ordered = bool(np.all(self.feature_min <= self.feature_max))
        require(ordered, "feature_min: above feature_max")
        require_shape("centers", self.centers, (len(self.weights_n), n_features))
        require_shape("weights_n", self.weights_n, (len(self.weights_n),))
        require_shape("tail_n", self.tail_n, (n_features + 1,))

    def on_scaled(self, scale: float) -> "Rbf":
        """Return the same function of features that are `scale` times smaller."""
        return replace(
            self,
            mean=self.mean / scale,
            scale=self.scale / scale,
            feature_min=self.feature_min / scale,
            feature_max=self.feature_max / scale,
        )


@dataclass(frozen=True, eq=False)
class Linear(Regressor):
    """force = intercept_n + weights_n @ features; weights_n (features,), N per feature's unit."""

    intercept_n: float
    weights_n: Samples
    __repr__ = short_repr

    def require_valid(self, n_features: int) -> None:
        require(bool(np.isfinite(self.intercept_n)), f"intercept_n: is {self.intercept_n}")
        require_shape("weights_n", self.weights_n, (n_features,))

    def on_scaled(self, scale: float) -> "Linear":
        return replace(self, weights_n=self.weights_n * scale)

    def used_columns(self, n_features: int) -> Indices:
        used = np.flatnonzero(self.weights_n)
        return used if len(used) else np.zeros(1, dtype=np.intp)


# Of an `Expression`: names of m2cgen's nodes, and how many results each takes from the stack. A
# file holds their places in this list: append alone.
OPERATIONS = {
    "NumVal": 0, "FeatureRef": 0, "ADD": 2, "SUB": 2, "MUL": 2, "DIV": 2, "PowExpr": 2,
    "AbsExpr": 1, "AtanExpr": 1, "ExpExpr": 1, "LogExpr": 1, "Log1pExpr": 1, "SqrtExpr": 1,
    "TanhExpr": 1, "LT": 2, "LTE": 2, "GT": 2, "GTE": 2, "EQ": 2, "NOT_EQ": 2, "IfExpr": 3,
}  # fmt: skip
MAX_NESTING = 4000  # of operations: m2cgen writes them by recursion, and Python ends that
COMPARISONS = ("LT", "LTE", "GT", "GTE", "EQ", "NOT_EQ")


@dataclass(frozen=True, eq=False)
class Expression(Regressor):
    """What no table here holds, such as an SVR: operations that m2cgen writes as C.

    operation: (n,), int32, places in OPERATIONS, operands first; the force is the sum of the
    results that are left. operand: (n,), of a number its value, of a feature which input it is.
    Inputs are zero + gain * feature[column], each (inputs,).
    """

    needs_libm: ClassVar[bool] = True

    operation: NDArray[np.int32]
    operand: Samples
    column: NDArray[np.int32]
    zero: Samples
    gain: Samples
    __repr__ = short_repr

    @property
    def jumps(self) -> bool:
        """True if it has branches, as m2cgen writes trees."""
        return list(OPERATIONS).index("IfExpr") in self.operation

    def on_scaled(self, scale: float) -> "Expression":
        return replace(self, gain=self.gain * scale)

    def require_valid(self, n_features: int) -> None:
        """Raise DataError, with field and reason, unless the program leaves numbers alone."""
        require_shape("operand", self.operand, self.operation.shape)
        for name in ("zero", "gain"):
            require_shape(name, getattr(self, name), self.column.shape)
        _require_range("column", self.column, 0, n_features)
        _require_range("operation", self.operation, 0, len(OPERATIONS))
        names = list(OPERATIONS)
        inputs = self.operand[self.operation == names.index("FeatureRef")]
        _require_range("operand", inputs.astype(np.int32), 0, len(self.column))
        stack: list[bool] = []  # whether each result is a comparison, which an IfExpr alone takes
        depths: list[int] = []  # and how deep its operations are nested
        for name in (names[i] for i in self.operation):
            count = OPERATIONS[name]
            taken = stack[len(stack) - count :]
            fits = len(taken) == count and taken == [name == "IfExpr", False, False][:count]
            require(fits, f"operation: {name} has no operands")
            stack[len(stack) - count :] = [name in COMPARISONS]
            depths[len(depths) - count :] = [1 + max(depths[len(depths) - count :], default=0)]
            require(depths[-1] <= MAX_NESTING, f"operation: nested deeper than {MAX_NESTING}")
        require(stack != [] and not any(stack), "operation: leaves no force")


def require_trees(forest: Forest, n_features: int) -> None:
    """Raise DataError, with the field's name, where traversing the forest could go astray."""
    n = len(forest.feature)
    for name in ("feature", "threshold", "left", "right", "value_n"):
        require_shape(name, getattr(forest, name), (n,))
    require(forest.roots.ndim == 1 and len(forest.roots) > 0, "roots: no list of trees")
    _require_range("feature", forest.feature, -1, n_features)
    for name in ("left", "right", "roots"):  # of leaves too: tables are built by indexing with them
        _require_range(name, getattr(forest, name), 0, n)
    inner = forest.feature >= 0
    children = np.concatenate([forest.left[inner], forest.right[inner], forest.roots])
    visits = np.bincount(children, minlength=n)
    if (bad := np.flatnonzero(visits != 1)).size:
        raise DataError(f"left, right: node {bad[0]} is reached {visits[bad[0]]} times, not once")
    # Every node has one parent: what is still not reached from the roots lies on cycles.
    level, reached = forest.roots, 0
    for _ in range(MAX_DEPTH + 1):
        reached += len(level)
        split = level[inner[level]]
        level = np.concatenate([forest.left[split], forest.right[split]])
        if not len(level):
            break
    else:
        raise DataError(f"left, right: a tree deeper than {MAX_DEPTH} splits")
    if reached != n:
        raise DataError(f"left, right: {n - reached} nodes lie on cycles")


def _require_range(name: str, values: NDArray[np.int32], begin: int, end: int) -> None:
    if values.size and not (values.min() >= begin and values.max() < end):
        bad = int(np.flatnonzero((values < begin) | (values >= end))[0])
        raise DataError(f"{name}: {values[bad]} at {bad} is outside {begin} .. {end - 1}")
