"""Kind `springpot`: a fractional solid, three or four numbers for a material scientist.

force = stiffness x + coefficient D^order x; where recordings show that this stops to grow at high
frequencies, a fractional Zener solid with a stiffness of an instant step besides.
"""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from springpot import Fit, FitOptions, Recording
from springpot.basics import Samples
from springpot.host.wings.material.law.fractional_solid import Branches, Solid
from springpot.host.wings.material.law.identifiability import law_metadata
from springpot.host.wings.material.law.law_moments import Moments, law_moments
from springpot.modelling import Hammerstein, TrainingSet, assemble, model_along, sensor_noise_n

_ORDERS = np.linspace(0.02, 0.98, 49)
_ZENER_ORDERS = _ORDERS[_ORDERS < 0.71]
_TIMES = 25
_NEARBY, _ZOOMS, _FIRST_FACTOR = np.arange(-3.0, 4.0), 5, 1.6
_TOUCHES, _NOISES = 0.01, 4.0  # of the peak force, of noise
_SELDOM = 0.002  # of the samples
_ROUNDS = 3  # along the way of the surface
_BETTER = 0.95  # of the error on what was left out: a fourth number has to be worth it


def fit_springpot(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Fit the law's numbers by least squares; intervals by leaving out each recording in turn."""
    begin = time.perf_counter()
    rows = data.even_rows() if options.fraction is None else data.rows(options.fraction, 0)
    way, pressed = _own_way(data, rows)
    moments = law_moments(way, pressed)
    everything = np.ones(len(moments.products), dtype=bool)
    simple = _best(moments, everything, zener=False)
    zener = _best(moments, everything, zener=True)
    is_zener = _left_out(moments, zener) < _BETTER * _left_out(moments, simple)
    solid = _with_bias(zener if is_zener else simple, moments)
    others = [
        _refined(moments, everything & (np.arange(len(everything)) != k), solid)
        for k in range(len(everything))
    ]
    metadata = law_metadata(
        solid, others, _profile(moments, solid), _sizes_n(moments, solid), data.recordings
    )
    passive = replace(to_hammerstein(solid, moments.branches, data), recovers=way is not data)
    model = assemble(
        "springpot", name, data, options, len(pressed), (None, None), passive, True, metadata
    )
    return Fit(model, len(pressed), 0.0, time.perf_counter() - begin, metadata=metadata)


def _own_way(data: TrainingSet, rows: NDArray[np.intp]) -> tuple[TrainingSet, NDArray[np.intp]]:
    """Return the set along the way of its surface, and the rows in which the object pushes.

    It lets the tool go where the law, which is linear, would pull: it gives 0 N there, and its
    surface stays dented. The set and its rows as they are if that is seldom.
    """
    force_n = data.force_n(rows)
    noise_n = max(sensor_noise_n(each.force_n) for each in data.recordings)
    least_n = max(_TOUCHES * float(force_n.max()), _NOISES * noise_n)
    pushes = force_n > least_n
    if data.contact == "always" or pushes.all() or not pushes.any():
        return data, rows
    way, motions = data, data.motions
    for _ in range(_ROUNDS):
        moments = law_moments(way, rows[pushes])
        solid = _best(moments, np.ones(len(moments.products), dtype=bool), zener=False)
        law = to_hammerstein(solid, moments.branches, data)
        if way is data:
            bare = [model_along(law, motion, data.dt_s, surface=False)[0] for motion in motions]
            if float(np.mean(np.concatenate(bare) < -least_n)) < _SELDOM:
                return data, rows
        law = replace(law, recovers=True)
        found = [model_along(law, motion, data.dt_s, surface=True)[1] for motion in motions]
        way = replace(data, depths_m=tuple(found), _found={})
    return way, rows[pushes]


def to_hammerstein(solid: Solid, branches: Branches, data: TrainingSet) -> Hammerstein:
    """Return the same law as a spring and Maxwell branches: passive, and rendered by the same C."""
    weights, slow = branches.weights(solid.order, solid.time_s)
    span_m = data.trained.max_m - data.trained.min_m
    branch_n = (solid.weight * weights * span_m)[:, None]
    kept = branch_n[:, 0] > 0.0
    return Hammerstein(
        origin_m=data.trained.min_m,
        span_m=span_m,
        elastic_n=np.array([(solid.stiffness_npm + solid.weight * slow) * span_m]),
        tau_s=branches.tau_s[kept],
        branch_n=branch_n[kept],
        radius_m=np.empty(0),
        stop_n=np.empty((0, 1)),
        bias_n=solid.bias_n,
    )


def _solved(
    moments: Moments, products: Samples, order: float, time_s: float | None
) -> tuple[Solid, float]:
    """Return spring and weight >= 0 for an order and a time, and the mean squared error, N^2."""
    terms = _terms(moments, order, time_s)
    matrix, vector = terms @ products[:-1, :-1] @ terms.T, terms @ products[:-1, -1]
    best, square = np.zeros(2), float(products[-1, -1])
    for chosen in ([0, 1], [0], [1]):
        weights = np.zeros(2)
        part = matrix[np.ix_(chosen, chosen)]
        weights[chosen] = np.linalg.lstsq(part, vector[chosen], rcond=None)[0]
        error = _error(products, weights @ terms)
        if weights.min() >= 0.0 and error < square:
            best, square = weights, error
    return Solid(float(best[0]), float(best[1]), order, time_s), max(square, 0.0)


def _terms(moments: Moments, order: float, time_s: float | None) -> Samples:
    """Return spring and fractional part as combinations of the columns: (2, 1 + branches)."""
    weights, slow = moments.branches.weights(order, time_s)
    return np.stack([np.eye(1, 1 + len(weights))[0], np.concatenate([[slow], weights])])


def _best(moments: Moments, units: NDArray[np.bool_], zener: bool) -> Solid:
    """Return the solid of lowest error: a search on a grid, then from its best point."""
    products = moments.of(units)
    tau_s = moments.branches.tau_s
    times: list[float | None] = [None]
    if zener:
        times = list(np.geomspace(tau_s[0], tau_s[-1], _TIMES).tolist())
    grid = [(o, t) for o in (_ZENER_ORDERS if zener else _ORDERS).tolist() for t in times]
    order, time_s = min(grid, key=lambda point: _solved(moments, products, *point)[1])
    return _refined(moments, units, Solid(0.0, 0.0, order, time_s))


def _refined(moments: Moments, units: NDArray[np.bool_], start: Solid) -> Solid:
    """Return the solid of lowest error near another one: finer and finer grids."""
    products = moments.of(units)
    top = _ZENER_ORDERS[-1] if start.time_s else _ORDERS[-1]
    shortest_s, longest_s = moments.branches.tau_s[[0, -1]].tolist()
    best, step, factor = start, _ORDERS[1] - _ORDERS[0], _FIRST_FACTOR
    for _ in range(_ZOOMS):
        orders = np.clip(best.order + step * _NEARBY, _ORDERS[0], top).tolist()
        times: list[float | None] = [None]
        if best.time_s:
            times = list(np.clip(best.time_s * factor**_NEARBY, shortest_s, longest_s).tolist())
        found = [_solved(moments, products, o, t) for o in orders for t in times]
        best = min(found, key=lambda pair: pair[1])[0]
        step, factor = step / 3.0, factor ** (1.0 / 3.0)
    return best


def _left_out(moments: Moments, start: Solid) -> float:
    """Mean squared error on each unit of the fit without it, N^2."""
    errors = []
    for k in range(len(moments.products)):
        out = np.arange(len(moments.products)) == k
        solid = _refined(moments, ~out, start)
        errors.append(_error(moments.of(out), _weights(moments, solid)))
    return float(np.mean(errors))


def _weights(moments: Moments, solid: Solid) -> Samples:
    terms = _terms(moments, solid.order, solid.time_s)
    return np.array([solid.stiffness_npm, solid.weight]) @ terms


def _error(products: Samples, weights: Samples) -> float:
    matrix, vector = products[:-1, :-1], products[:-1, -1]
    return float(products[-1, -1] - 2 * weights @ vector + weights @ matrix @ weights)


def _with_bias(solid: Solid, moments: Moments) -> Solid:
    if not moments.free:
        return solid
    sums = moments.products.sum(axis=0)[:, 0] / moments.products.sum(axis=0)[:, :1, 0]
    mean = sums.mean(axis=0)  # over recordings: 1, depth, branches, force
    bias_n = float(mean[-1] - _weights(moments, solid) @ mean[1:-1])
    return replace(solid, bias_n=bias_n)


def _profile(moments: Moments, solid: Solid) -> tuple[Samples, Samples]:
    """Return orders and the RMS error, N, of the best solid of each order: (orders,) both."""
    products = moments.of(np.ones(len(moments.products), dtype=bool))
    times: list[float | None] = [None]
    if solid.time_s:
        tau_s = moments.branches.tau_s
        times = [solid.time_s, *np.geomspace(tau_s[0], tau_s[-1], _TIMES).tolist()]
    orders = np.append(_ZENER_ORDERS if solid.time_s else _ORDERS, solid.order)
    errors = [min(_solved(moments, products, o, t)[1] for t in times) for o in orders.tolist()]
    count = len(moments.products[0])
    return orders, np.sqrt(np.array(errors) / count)


def _sizes_n(moments: Moments, solid: Solid) -> tuple[float, float, float]:
    """Return RMS, N, of the force (without its means), of what the law misses, and of its rate
    dependence: what the fractional part has beyond a spring."""
    products = moments.of(np.ones(len(moments.products), dtype=bool))
    count = len(moments.products[0])
    part = _terms(moments, solid.order, solid.time_s)[1] * solid.weight
    matrix = products[:-1, :-1]
    beyond = float(part @ matrix @ part - (matrix[0] @ part) ** 2 / matrix[0, 0])
    missed = _error(products, _weights(moments, solid))
    squares = np.array([products[-1, -1], missed, beyond]) / count
    force_n, missed_n, rate_n = np.sqrt(np.maximum(squares, 0.0)).tolist()
    return force_n, missed_n, rate_n
