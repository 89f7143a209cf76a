"""Fractional derivatives by Grünwald-Letnikov sums (the paper's appendix A)."""

import numpy as np

from springpot.codegen.arrays import Samples


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


def fir_derivatives(position_m: Samples, taps: Samples) -> Samples:
    """Filter positions with each column of `taps` (length, orders): shape (n, orders), m/s^r.

    Before the first sample the object has rested at that sample.
    """
    held = np.concatenate([np.full(len(taps) - 1, position_m[0]), position_m])
    columns = [np.convolve(held, column, mode="valid") for column in taps.T]
    return np.stack(columns, axis=1)
