"""Fractional derivatives by convolution, as the definition has them."""

import numpy as np

from springpot.codegen.arrays import Samples


def fir_derivatives(position_m: Samples, taps: Samples) -> Samples:
    """Filter positions with each column of `taps` (length, orders): shape (n, orders), m/s^r.

    Before the first sample the object has rested at that sample.
    """
    held = np.concatenate([np.full(len(taps) - 1, position_m[0]), position_m])
    columns = [np.convolve(held, column, mode="valid") for column in taps.T]
    return np.stack(columns, axis=1)
