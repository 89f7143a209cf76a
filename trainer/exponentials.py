"""Fractional derivatives by sums of exponentials: true to the derivative at any rate."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.special import gamma

from springpot.codegen.ir import RecursiveBank

Samples = NDArray[np.float64]
POLES_PER_DECADE = 2.5
_FITTED_FROM = 0.05  # of the shortest time constant's step: faster motion sees a pure power law
_POINTS_PER_DECADE = 40


def recursive_bank(orders: tuple[float, ...], dt_s: float, longest_s: float) -> RecursiveBank:
    """Poles log-spaced from a quarter step to `longest_s`, one bank for all orders.

    Weights are non-negative: each feature is then a sum of Maxwell branches, locally dissipative.
    """
    fastest_s = dt_s / 4.0
    n_poles = 1 + round(POLES_PER_DECADE * np.log10(longest_s / fastest_s))
    tau_s = np.geomspace(fastest_s, longest_s, max(n_poles, 2))
    weights = np.stack([_weights(order, tau_s, fastest_s, longest_s) for order in orders], axis=1)
    return RecursiveBank(orders=orders, tau_s=tau_s, weights=weights)


def _weights(order: float, tau_s: Samples, fastest_s: float, longest_s: float) -> Samples:
    """Non-negative weights w with sum of w exp(-t/tau) ~ t^-r/gamma(1 - r), relative error.

    That is the kernel of D^r on x' from rest (Caputo). What lies before the first point counts by
    its integral, which a step of the input sees whole.
    """
    n = round(_POINTS_PER_DECADE * np.log10(longest_s / (fastest_s * _FITTED_FROM)))
    time_s = np.geomspace(fastest_s * _FITTED_FROM, longest_s, n)
    kernel = time_s**-order / gamma(1.0 - order)
    integral = time_s ** (1.0 - order) / gamma(2.0 - order)
    rows = [np.exp(-time_s[:, None] / tau_s) / kernel[:, None]]
    rows += [tau_s * -np.expm1(-time_s[:, None] / tau_s) / integral[:, None]]
    seen = time_s > 2.0 * fastest_s
    system = np.concatenate([rows[0][seen], rows[1]])
    weights, _ = nnls(system, np.ones(len(system)))
    return np.asarray(weights, dtype=np.float64)
