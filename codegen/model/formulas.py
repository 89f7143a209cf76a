"""Formulas that a fit and the emitted C share, in any number type.

A curve of the passive model along the depth is a basis of functions in the fit, and polynomials on
equal pieces of the trained depth in the C (sp_curve.h); its last piece goes on. Its stretch and the
rate of relaxation change with the depth, as curves too (sp_depth.h). Filters follow a motion.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Real, Reals, Samples
from springpot.codegen.model.model import BASIS_SIZE, Basis

PIECES = 9  # SP_DEPTH_PIECES of sp_depth.h: eight of the trained depth, and one beyond it
_NODES = np.linspace(0.0, 1.0, PIECES)  # shares of the trained depth
Place = tuple[NDArray[np.intp], Reals]  # piece of a curve and way from its start, both (n,)


def basis(kind: Basis, u: Reals) -> Iterator[Reals]:
    """The functions of a basis one after another, each (n,); `curve_terms` has them by pieces."""
    real = u.dtype.type
    if kind == "powers":
        v = np.maximum(u, real(0))
        yield v
        yield v * v
        yield v * v * v
        return
    width = real(1) / real(8)
    for j in range(8):
        risen = np.maximum(u - real(j) * width, real(0))
        yield np.minimum(risen, width) if j < 7 else risen


def curve_terms(kind: Basis, weights: Reals) -> NDArray[np.float64]:
    """Weights (curves, J) on a basis as polynomials: (pieces, degree + 1, curves)."""
    if kind == "powers":
        constant = np.zeros((1, len(weights)))
        return np.concatenate([weights.T[::-1], constant])[None]
    # In piece j ramp j rises; those before it are full, at weight / n_pieces; those after it are 0.
    n_pieces = BASIS_SIZE[kind]
    starts = np.concatenate([np.zeros((1, len(weights))), np.cumsum(weights.T, axis=0)[:-1]])
    return np.stack([weights.T, starts / n_pieces], axis=1)


def curve_place(u: Reals, n_pieces: int) -> Place:
    """sp_curve_at: the piece that u is in and the way from its start, both (n,)."""
    real = u.dtype.type
    v = np.where(u > 0, u, real(0))
    found = np.where(v * real(n_pieces) < real(n_pieces - 1), v * real(n_pieces),
                     real(n_pieces - 1))  # fmt: skip
    piece = found.astype(np.intp)
    return piece, v - piece.astype(u.dtype) / real(n_pieces)


def curve_values(terms: Reals, place: Place) -> Reals:
    """sp_curve: values (n, curves) of terms (pieces, degree + 1, curves)."""
    piece, way = place
    values: Reals = terms[piece, 0]
    for power in range(1, terms.shape[1]):
        values = values * way[:, None] + terms[piece, power]
    return values


def stretch_terms(stretch: float) -> Samples:
    """Polynomials of v(u) = (u + expm1(c u)/expm1(c))/2, c = stretch, (pieces, 4).

    Highest power first, of the way from a piece's start in shares of all nine pieces. A cubic
    between nodes, so that the C needs no exp; straight beyond the trained depth.
    """
    value = 0.5 * (_NODES + np.expm1(stretch * _NODES) / np.expm1(stretch))
    slope = 0.5 * (1.0 + stretch * np.exp(stretch * _NODES) / np.expm1(stretch))
    width = _NODES[1]
    rise = np.diff(value)
    begin, end = width * slope[:-1], width * slope[1:]
    # Hermite's cubic in the way through a piece, 0 to 1.
    inside = np.stack([begin + end - 2 * rise, 3 * rise - 2 * begin - end, begin, value[:-1]], 1)
    beyond = np.array([[0.0, 0.0, width * slope[-1], value[-1]]])
    terms: Samples = np.concatenate([inside, beyond]) * float(PIECES) ** np.arange(3, -1, -1)
    return terms


def stretched(u: Samples, stretch: float) -> Samples:
    """v(u) of `stretch_terms`, (n,); 0 below the surface. u: share of the trained depth, (n,)."""
    return curve_values(stretch_terms(stretch)[:, :, None], depth_place(u))[:, 0]


def rates_by_depth(tau_s: Samples, rate_ratio: float) -> Samples:
    """Rate of each pole at the nodes, and for ever beyond the last one: (pieces + 1, poles), 1/s.

    ratio^(1/2 - u)/tau: `rate_ratio` is the rate at the surface over that at the trained depth.
    """
    nodes = np.append(_NODES, _NODES[-1])
    rates: Samples = rate_ratio ** (0.5 - nodes[:, None]) / tau_s
    return rates


def loss_by_depth(tau_s: Samples, rate_ratio: float, dt_s: float) -> Samples:
    """Loss of each pole in a tick as straight pieces of the depth, (pieces, 2, poles)."""
    loss, _ = loss_and_gain(1.0 / rates_by_depth(tau_s, rate_ratio), dt_s)
    return np.stack([PIECES * np.diff(loss, axis=0), loss[:-1]], axis=1)


def depth_place(u: Reals) -> Place:
    """sp_depth_place: piece and way of each share of the trained depth, both (n,)."""
    return curve_place(u * u.dtype.type((PIECES - 1) / PIECES), PIECES)


def loss_and_gain(tau_s: NDArray[np.float64], dt_s: float) -> tuple[Reals, Reals]:
    """1 - exp(-dt/tau), and the gain of an input that is linear within the step: both (poles,)."""
    loss = -np.expm1(-dt_s / tau_s)
    return loss, loss * tau_s / dt_s


def foaw(per_step: Reals, band_m: Real, windows: Reals) -> Reals:
    """Velocity at the end of each window, shape (n,), m/s; windows: (n, steps + 1), m.

    The slope over the longest window in which a line through its ends passes within `band_m` of
    every sample (end-fit; Janabi-Sharifi, Hayward, Chen 2000).
    """
    newest = windows[:, -1]
    slope = minimum = maximum = np.zeros_like(newest)
    longer = np.ones(len(newest), dtype=bool)
    for j, per_s in enumerate(per_step):
        rise = newest - windows[:, -2 - j]
        candidate = rise * per_s
        low, high = (rise - band_m) * per_s, (rise + band_m) * per_s
        if j == 0:
            slope, minimum, maximum = candidate, low, high
            continue
        longer &= (candidate >= minimum) & (candidate <= maximum)
        slope = np.where(longer, candidate, slope)
        minimum = np.where(longer & (low > minimum), low, minimum)
        maximum = np.where(longer & (high < maximum), high, maximum)
    return slope
