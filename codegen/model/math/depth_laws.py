"""What changes with the depth in the passive model: its stretch, and the rate of relaxation.

Both are curves of sp_curve.h on eight pieces of the trained depth; a ninth goes on beyond it.
"""

import numpy as np

from springpot.codegen.arrays import Reals, Samples
from springpot.codegen.model.math.curves import Place, curve_place, curve_values
from springpot.codegen.model.math.filters import loss_and_gain

PIECES = 9  # SP_DEPTH_PIECES of sp_depth.h
_NODES = np.linspace(0.0, 1.0, PIECES)  # shares of the trained depth


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
