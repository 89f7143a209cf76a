"""Filters of a motion: exponentials, and velocity by first-order adaptive windowing."""

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Real, Reals


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
