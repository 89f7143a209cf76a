"""Regressors that m2cgen knows and no table here holds, such as an SVR, as expressions."""

import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import UsageError
from springpot.codegen.model.regressors import OPERATIONS, Expression
from springpot.trainer.models.ensembles import probe_scaler, probe_target, vote_shares

if TYPE_CHECKING:
    from m2cgen.ast import Expr

# m2cgen's kinds of regressors, by which one that it lacks is refused without it. Not XGBoost's:
# m2cgen 0.10 reads a base score that XGBoost no longer states.
WRITTEN = frozenset({
    "ARDRegression", "BayesianRidge", "DecisionTreeRegressor", "ElasticNet", "ElasticNetCV",
    "ExtraTreeRegressor", "ExtraTreesRegressor", "GammaRegressor", "HuberRegressor",
    "LGBMRegressor", "Lars", "LarsCV", "Lasso", "LassoCV", "LassoLars", "LassoLarsCV",
    "LassoLarsIC", "LinearRegression", "LinearSVR", "NuSVR", "OrthogonalMatchingPursuit",
    "OrthogonalMatchingPursuitCV", "PassiveAggressiveRegressor", "PoissonRegressor",
    "RANSACRegressor", "RandomForestRegressor", "Ridge", "RidgeCV", "SGDRegressor", "SVR",
    "TheilSenRegressor", "TweedieRegressor",
})  # fmt: skip
_MAX_OPERATIONS = 300_000  # an SVR of 6500 vectors, which a compiler takes half a minute over
_OPERANDS = ("test", "body", "orelse", "left", "right", "base_expr", "exp_expr", "expr")


def convert_expression(regressor: Any) -> Expression:
    """Operations of a regressor that m2cgen knows, also behind scalers or in a vote.

    Raises UsageError for another one, and ModuleNotFoundError without m2cgen.
    """
    n_features = regressor.n_features_in_
    writer = _Writer(np.arange(n_features))
    parts = list(_parts(regressor, np.zeros(n_features), np.ones(n_features), 1.0))
    import m2cgen  # noqa: F401 (is it there?)

    sys.setrecursionlimit(max(sys.getrecursionlimit(), 20_000))  # of hundreds of trees in an exp
    for part in parts:
        writer.add(*part)
    if len(writer.operations) > _MAX_OPERATIONS:
        raise UsageError(
            f"{type(regressor).__name__} takes {len(writer.operations)} operations, and a compiler "
            f"minutes over its C (limit {_MAX_OPERATIONS}): fit it on fewer rows, such as "
            "ensemble_data(..., fraction=0.05), or with a larger epsilon"
        )
    expression = writer.expression()
    if not np.isfinite(expression.operand).all():
        raise UsageError(
            f"{type(regressor).__name__}: m2cgen writes it with a number that is not finite"
        )
    return expression


class _Writer:
    """Operations, operands first, and the inputs that they read."""

    def __init__(self, columns: Any) -> None:
        self.columns = columns
        self.operations: list[int] = []
        self._operands: list[float] = []
        self._scales: list[tuple[Samples, Samples]] = []  # zero, gain of each group of inputs

    def expression(self) -> Expression:
        """Return the written program with the scaling of each column that it reads."""
        zero, gain = map(np.concatenate, zip(*self._scales, strict=True))
        return Expression(
            operation=np.array(self.operations, np.int32),
            operand=np.array(self._operands),
            column=np.tile(self.columns, len(self._scales)).astype(np.int32),
            zero=zero,
            gain=gain,
        )

    def add(self, part: Any, zero: Samples, gain: Samples, weight: float) -> None:
        """Add weight times a number, or a regressor of the features zero + gain x."""
        if isinstance(part, float):
            self._put("NumVal", weight * part)
            return
        self._scales.append((zero, gain))
        for term in _terms(_assemble(part)):
            self._walk(term)
            if weight != 1.0:
                self._put("NumVal", weight)
                self._put("MUL")

    def _put(self, name: str, operand: float = 0.0) -> None:
        self.operations.append(list(OPERATIONS).index(name))
        self._operands.append(operand)

    def _walk(self, node: "Expr") -> None:
        """Write an expression of m2cgen as postfix operations: operands first.

        Raises UsageError for an operation that springpot does not take.
        """
        kind = type(node).__name__
        if kind == "IdExpr":
            self._walk(node.expr)
            return
        name = node.op.name if hasattr(node, "op") else kind
        if name not in OPERATIONS:
            raise UsageError(f"m2cgen writes it with {name}, which springpot does not take")
        for operand in (getattr(node, each) for each in _OPERANDS if hasattr(node, each)):
            self._walk(operand)
        first = (len(self._scales) - 1) * len(self.columns)
        value = first + node.index if kind == "FeatureRef" else getattr(node, "value", 0.0)
        self._put(name, float(value))


def _parts(
    regressor: Any, zero: Samples, gain: Samples, weight: float
) -> Iterator[tuple[Any, Samples, Samples, float]]:
    """Yield regressors of the features zero + gain x, and numbers: their sum is weight times it.

    Raises UsageError for what m2cgen cannot write, whether or not it is installed.
    """
    kind = type(regressor).__name__
    if kind == "Pipeline":
        *before, (_, last) = regressor.steps
        for name, step in before:
            if step not in ("passthrough", None):
                step_zero, step_gain = probe_scaler(name, step)
                zero, gain = step_zero + step_gain * zero, step_gain * gain
        yield from _parts(last, zero, gain, weight)
    elif kind == "VotingRegressor":
        for share, each in zip(vote_shares(regressor), regressor.estimators_, strict=True):
            yield from _parts(each, zero, gain, weight * share)
    elif kind == "TransformedTargetRegressor":
        target_zero, target_gain = probe_target(regressor)
        yield target_zero, zero, gain, weight
        yield from _parts(regressor.regressor_, zero, gain, weight * target_gain)
    elif kind in WRITTEN:
        yield regressor, zero, gain, weight
    else:
        raise UsageError(_refusal(kind))


def _refusal(kind: str, reason: str = "") -> str:
    return (
        f"{kind}: the force is no sum of trees or weighted features, and m2cgen cannot write it"
        f"{reason}: fit trees (scikit-learn, LightGBM, XGBoost), an SVR or a linear regressor"
    )


def _assemble(regressor: Any) -> "Expr":
    """m2cgen's tree of a regressor. Raises UsageError where it has none."""
    from m2cgen.assemblers import get_assembler_cls

    try:
        return get_assembler_cls(regressor)(regressor).assemble()
    except Exception as error:  # of another release of the regressor's library: of any kind
        reason = f" ({' '.join(str(error).split())[:100]})"
        raise UsageError(_refusal(type(regressor).__name__, reason)) from None


def _terms(node: "Expr") -> "list[Expr]":
    """Addends of a sum, the last one first: a support vector or a tree each."""
    terms = []
    while getattr(node, "op", None) is not None and node.op.name == "ADD":
        terms.append(node.right)
        node = node.left
    return [*terms, node]
