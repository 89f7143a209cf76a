"""Kind `springpot`: a fractional Kelvin-Voigt solid, two or three numbers for a material scientist.

force = stiffness x + coefficient D^order x. The derivative remembers the longest recording.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar, nnls

from springpot.codegen.arrays import Samples
from springpot.codegen.model.model import Hammerstein
from springpot.trainer.features.exponentials import recursive_bank
from springpot.trainer.features.fractional import caputo_derivative
from springpot.trainer.models.fit import Fit, FitOptions, assemble
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording

_ORDERS = (0.02, 0.98)
_GROUPS = 10
_CONFIDENCE = 1.96  # standard errors of a 95 % interval


@dataclass(frozen=True)
class Solid:
    """stiffness_npm, N/m; coefficient, N s^order/m; order."""

    stiffness_npm: float
    coefficient: float
    order: float


def fit_springpot(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Least squares on the three numbers; intervals by leaving out tenths of the rows in turn."""
    begin = time.perf_counter()
    rows = data.many_rows() if options.fraction is None else data.rows(options.fraction, 0)
    depth_m = data.along(rows, lambda depth, at: depth[at]) - data.trained.min_m
    force_n = data.force_n(rows)
    solid = _fit(data, rows, depth_m, force_n, np.ones(len(rows), dtype=bool), _ORDERS)
    group = np.arange(len(rows)) * _GROUPS // len(rows)
    near = (max(solid.order - 0.1, 0.01), min(solid.order + 0.1, 0.99))
    others = [_fit(data, rows, depth_m, force_n, group != i, near) for i in range(_GROUPS)]
    metadata = {"n_parameters": 3, "material": _material(solid, others)}
    passive = to_hammerstein(_discretised(data, rows, depth_m, force_n, solid.order), data)
    model = assemble(
        "springpot", name, data, options, len(rows), (None, None), passive, True, metadata
    )
    return Fit(model, len(rows), 0.0, time.perf_counter() - begin, metadata=metadata)


def to_hammerstein(solid: Solid, data: TrainingSet) -> Hammerstein:
    """The same law as a spring and Maxwell branches: passive, and rendered by the same C."""
    bank = recursive_bank((solid.order,), data.dt_s, data.longest_s)
    span_m = data.trained.max_m - data.trained.min_m
    weights = solid.coefficient * bank.weights[:, 0] * span_m
    kept = weights > 0.0
    branch = np.zeros((int(kept.sum()), 3))
    branch[:, 0] = weights[kept]
    return Hammerstein(
        basis="powers",
        origin_m=data.trained.min_m,
        span_m=span_m,
        elastic_n=np.array([solid.stiffness_npm * span_m, 0.0, 0.0]),
        tau_s=bank.tau_s[kept],
        branch_n=branch,
        radius_m=np.empty(0),
        stop_n=np.empty((0, 3)),
        bias_n=0.0,
    )


def _fit(
    data: TrainingSet,
    rows: NDArray[np.intp],
    depth_m: Samples,
    force_n: Samples,
    used: NDArray[np.bool_],
    orders: tuple[float, float],
) -> Solid:
    def solved(order: float) -> tuple[Samples, float]:
        # Exact, not by the poles that render it: their ripple shifts the order by 0.03.
        derivative = data.along(
            rows, lambda depth, at: caputo_derivative(depth, float(order), data.dt_s)[at]
        )
        system = np.stack([depth_m, derivative], axis=1)[used]
        weights, residual = nnls(system, force_n[used])
        return weights, float(residual)

    best = minimize_scalar(
        lambda order: solved(order)[1], bounds=orders, method="bounded", options={"xatol": 1e-4}
    )
    weights, _ = solved(best.x)
    return Solid(float(weights[0]), float(weights[1]), float(best.x))


def _discretised(
    data: TrainingSet, rows: NDArray[np.intp], depth_m: Samples, force_n: Samples, order: float
) -> Solid:
    """The numbers of lowest error with the poles that the C has for this order."""
    bank = recursive_bank((order,), data.dt_s, data.longest_s)
    system = np.stack([depth_m, data.features(bank, rows)[:, 0]], axis=1)
    weights, _ = nnls(system, force_n)
    return Solid(float(weights[0]), float(weights[1]), order)


def _material(solid: Solid, others: list[Solid]) -> dict[str, list[float]]:
    """Value and half width of its 95 % interval (jackknife over blocks of rows)."""
    found = {}
    for name in ("stiffness_npm", "coefficient", "order"):
        values = np.array([getattr(other, name) for other in others])
        n = len(values)
        error = np.sqrt((n - 1) / n * np.sum(np.square(values - values.mean())))
        found[name] = [getattr(solid, name), float(_CONFIDENCE * error)]
    return found
