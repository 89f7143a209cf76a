"""Formulas that a fit and the emitted C share, in any number type.

A curve of the passive model is given by its slopes at nodes of the depth (`Hammerstein`); rates of
relaxation change with the depth along the same nodes. Filters follow a motion.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Indices, Real, Reals, Samples
from springpot.codegen.types import RealType, Scalar

SMALLEST = 1e-30  # SP_FLUSH_BELOW of sp_number.h
CurveLocation = tuple[Indices, Reals]  # piece of a curve and share of the way through it, both (n,)


def integrate_slopes(slopes_n: Reals) -> Samples:
    """Compute values and slopes a piece at the nodes: (J + 1, 2, curves); the last slope goes on.

    slopes_n: (curves, J), for u from 0 to 1, straight between the nodes.
    """
    per_piece = slopes_n.T / count_intervals(slopes_n.shape[1])
    nodes = np.zeros((len(per_piece) + 1, 2, len(slopes_n)))
    nodes[1:-1, 0] = np.cumsum(0.5 * (per_piece[1:] + per_piece[:-1]), axis=0)
    nodes[-1, 0] = nodes[-2, 0]
    nodes[:-1, 1], nodes[-1, 1] = per_piece, per_piece[-1]
    return nodes


def count_intervals(nodes: int) -> int:
    """Pieces from u = 0 to 1; of a single node one, which goes on."""
    return max(nodes - 1, 1)


def locate_on_curve(u: Reals, nodes: int) -> CurveLocation:
    """sp_curve_locate: the piece that u is in and the way from its start, both (n,)."""
    real = u.dtype.type
    interval_position = np.fmax(u, real(0)) * real(count_intervals(nodes))
    interval = np.minimum(interval_position, real(nodes - 1)).astype(np.intp)
    return interval, interval_position - interval.astype(u.dtype)


def evaluate_curves(nodes: Reals, location: CurveLocation) -> Reals:
    """sp_curve: values (n, curves) of nodes (J + 1, 2, curves), each curve at a place of its own.

    Or all of them at one place, if the place is (n,).
    """
    real, (interval, fraction) = nodes.dtype.type, location
    curve_index = () if fraction.ndim == 1 else (np.arange(nodes.shape[2]),)
    fraction = fraction if curve_index else fraction[:, None]
    value, slope, end = (
        nodes[interval + later, column, *curve_index] for later, column in ((0, 0), (0, 1), (1, 1))
    )
    values: Reals = value + fraction * (slope + real(0.5) * fraction * (end - slope))
    return values


def interpolate_linear(nodes: Reals, location: CurveLocation) -> Reals:
    """Evaluate functions that are straight between nodes (J + 1, columns): (n, columns)."""
    interval, fraction = location
    begin = nodes[interval]
    values: Reals = begin + fraction[:, None] * (nodes[interval + 1] - begin)
    return values


def compute_depth_rates(tau_s: Samples, rate_ratio: float, nodes: int) -> Samples:
    """Rate of each pole at the nodes, and for ever beyond the last one: (J + 1, poles), 1/s.

    ratio^(1/2 - u)/tau: `rate_ratio` is the rate at the surface over that at u = 1.
    """
    u = np.linspace(0.0, 1.0, nodes)
    return rate_ratio ** (0.5 - np.append(u, u[-1])[:, None]) / tau_s


def compute_depth_loss(tau_s: Samples, rate_ratio: float, dt_s: float, nodes: int) -> Samples:
    """Loss of each pole in a tick at the nodes, (J + 1, poles)."""
    return compute_loss_and_gain(1.0 / compute_depth_rates(tau_s, rate_ratio, nodes), dt_s)[0]


def evaluate_flow_functions(u: Reals) -> Reals:
    """sp_flow_inputs: u, u^2 and u^4, straight beyond u = 1, (n, 3)."""
    real = u.dtype.type
    v = np.where(u > 0, u, real(0))
    inside = np.where(v < real(1), v, real(1))
    beyond, square = v - inside, inside * inside
    return np.stack([v, square + real(2) * beyond, square * square + real(4) * beyond], axis=-1)


def compute_flow_loss(rate_ps: Samples, power: NDArray[np.int64], dt_s: float) -> Samples:
    """(p - 1) rate dt of each flowing branch, (F,)."""
    return (power - 1.0) * rate_ps * dt_s


def to_scalars(values: Reals) -> list[Scalar]:
    """Numbers of an array, (n,), for loops over ticks: Python's own are doubles, and fast."""
    return values.tolist() if values.dtype == np.float64 else list(values)


def scalar_type(dtype: RealType) -> Callable[[Scalar], Scalar]:
    """Return the type of the numbers that `to_scalars` makes of such an array."""
    return float if dtype is np.float64 else dtype


def play_operator(u: Reals, begin: Scalar, radius: Real) -> list[Scalar]:
    """sp_stops_play: play of a stop after each tick, (n,), from `begin` on."""
    p, bounds = begin, zip(to_scalars(u - radius), to_scalars(u + radius), strict=True)
    return [p := low if not p > low else p if p < high else high for low, high in bounds]


def relax_pole(loss: Scalar, rises: Reals, begin: Scalar) -> list[Scalar]:
    """sp_poles.h: state of a pole after each tick, (n,), 0 where it would be near denormal."""
    h = begin
    return [
        h := x if (x := h + (rise - loss * h)) >= SMALLEST or x <= -SMALLEST else x * 0
        for rise in to_scalars(rises)
    ]


def compute_loss_and_gain(tau_s: Samples, dt_s: float) -> tuple[Reals, Reals]:
    """1 - exp(-dt/tau), and the gain of an input that is linear within the step: both (poles,)."""
    loss = -np.expm1(-dt_s / tau_s)
    return loss, loss * tau_s / dt_s


def estimate_foaw_velocity(per_step: Reals, band_m: Real, windows: Reals) -> Reals:
    """Velocity at the end of each window, shape (n,), m/s; windows: (n, steps + 1), m.

    The slope over the longest window in which a line through its ends passes within `band_m` of
    every sample (end-fit; Janabi-Sharifi, Hayward, Chen 2000).
    """
    newest = windows[:, -1]
    slope, still_fits = np.zeros_like(newest), np.ones(len(newest), dtype=bool)
    minimum, maximum = slope - np.inf, slope + np.inf
    for j, per_s in enumerate(per_step):
        rise = newest - windows[:, -2 - j]
        candidate = rise * per_s
        low, high = (rise - band_m) * per_s, (rise + band_m) * per_s
        still_fits &= (candidate >= minimum) & (candidate <= maximum)
        slope = np.where(still_fits, candidate, slope)
        minimum = np.where(still_fits & (low > minimum), low, minimum)
        maximum = np.where(still_fits & (high < maximum), high, maximum)
    return slope
