"""Fractional derivatives of the whole past, by another scheme than springpot's own."""

from math import gamma

import numpy as np

from springpot.codegen.arrays import Samples


def caputo_derivative(position_m: Samples, order: float, dt_s: float) -> Samples:
    """D^order of all samples since the first, shape (n,), m/s^order; before it they rested there.

    The L1 scheme: exact for a motion that is linear between samples, with all its memory; order
    in (0, 1). By convolution through the FFT: n log n.
    """
    n = len(position_m)
    k = np.arange(n + 1, dtype=np.float64) ** (1.0 - order)
    kernel = np.diff(k) * dt_s**-order / gamma(2.0 - order)
    rises = np.diff(position_m, prepend=position_m[:1])
    size = 1 << (2 * n - 1).bit_length()
    product = np.fft.rfft(rises, size) * np.fft.rfft(kernel, size)
    return np.fft.irfft(product, size)[:n]
