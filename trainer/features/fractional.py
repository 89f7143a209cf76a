"""Fractional derivatives by Grünwald-Letnikov sums (the paper's appendix A), and by exponentials.

Sums of exponentials are true to the derivative at any rate.
"""

import numpy as np
from scipy.optimize import nnls

from springpot.codegen.arrays import Samples
from springpot.codegen.model.features import RecursiveBank

POLES_PER_DECADE = 2.5
_FASTEST_STEPS = 0.25  # shortest time constant
_BEYOND = 3.0  # longest time constant, of the memory asked for: the kernel's tail needs it
_POINTS_PER_DECADE = 60


def gl_weights(order: float, length: int) -> Samples:
    """Grünwald-Letnikov weights c_k h^r, (length,): (-1)^k binomial(order, k) from k = 0 on.

    By the recurrence c_k = c_(k-1) (k - 1 - r)/k, which overflows at no length (the gamma
    functions of the paper's equation (15) do from k = 171 on). Raises ValueError where the order
    is not in [0, 1] or there is no tap.
    """
    if not 0.0 <= order <= 1.0:
        raise ValueError(f"fractional order {order}: give one in [0, 1]")
    if length < 1:
        raise ValueError(f"{length} taps: give at least one")
    k = np.arange(1, length)
    return np.concatenate([[1.0], np.cumprod((k - 1 - order) / k)])


def gl_taps(order: float, length: int, dt_s: float) -> Samples:
    """Taps c(r, k) of equation (16), shape (length,), newest sample first, 1/s^order.

    The sum is over f(t - k h), the samples that exist; the paper prints f(t + (r - k) h).
    """
    weights: Samples = gl_weights(order, length) * dt_s**-order
    return weights


def recursive_bank(orders: tuple[float, ...], dt_s: float, longest_s: float) -> RecursiveBank:
    """Log-spaced poles, one bank for all orders, true to motion between longest_s/2 and two steps.

    Weights are non-negative: each feature is then a sum of Maxwell branches, locally dissipative.
    """
    fastest_s, slowest_s = _FASTEST_STEPS * dt_s, _BEYOND * longest_s
    n_poles = 1 + round(POLES_PER_DECADE * np.log10(slowest_s / fastest_s))
    tau_s = np.geomspace(fastest_s, slowest_s, max(n_poles, 2))
    ends = _BEYOND / longest_s, 0.5 / dt_s
    n_points = round(_POINTS_PER_DECADE * np.log10(ends[1] / ends[0]))
    omega = np.geomspace(*ends, max(n_points, _POINTS_PER_DECADE))
    weights = np.stack([_weights(order, tau_s, omega) for order in orders], axis=1)
    return RecursiveBank(orders=orders, tau_s=tau_s, weights=weights)


def _weights(order: float, tau_s: Samples, omega: Samples) -> Samples:
    """Weights w >= 0, (poles,), with sum of w s/(s + 1/tau) ~ s^r on s = j omega (relative)."""
    s = 1j * omega[:, None]
    system = s / (s + 1.0 / tau_s) / s**order
    wanted = np.concatenate([np.ones(len(omega)), np.zeros(len(omega))])
    columns = np.concatenate([system.real, system.imag])
    size = np.linalg.norm(columns, axis=0)  # far from 1 for high orders, and nnls goes in circles
    weights, _ = nnls(columns / size, wanted)
    return np.asarray(weights / size, dtype=np.float64)
