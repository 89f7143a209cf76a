"""What a sensor adds to a signal: white noise, and the steps of its grid."""

import math

import numpy as np

from springpot.codegen.arrays import Samples

_SAME = 1e-9  # of the range: the same value, converted or interpolated twice
_ALONE = 0.02  # of moves: those unlike the one before and the one after, of a ramp at its ends
_ORDER = 4  # of differences: they keep white noise, and leave next to nothing of a press
_NORMAL = 1.4826  # standard deviation of normal noise over the median of its size


def noise_n(samples: Samples) -> float:
    """Standard deviation of what differs from sample to sample, by the median of second steps."""
    second = np.diff(samples, 2)
    return _NORMAL * float(np.median(np.abs(second))) / math.sqrt(6.0) if len(second) else 0.0


def sensor_noise_n(force_n: Samples) -> float:
    """RMS of white noise in a force (n,), N, and at least that of its steps' rounding."""
    differences = np.abs(np.diff(force_n, _ORDER))
    moved = differences[differences > 0.0]  # a sensor slower than the recording holds its values
    if not len(moved):
        return 0.0
    white_n = _NORMAL * float(np.median(moved)) / math.sqrt(math.comb(2 * _ORDER, _ORDER))
    return max(white_n, (quantisation_step(force_n) or 0.0) / math.sqrt(12))


def quantisation_step(samples: Samples) -> float | None:
    """Smallest step between values on a grid, in the channel's unit; None without a grid.

    Values a constant speed apart, on ramps between holds, are on no sensor's grid: on one, a speed
    takes now more, now fewer of its steps.
    """
    values = np.unique(samples)
    steps = np.diff(values)
    steps = steps[steps > _SAME * float(values[-1] - values[0])]
    if not len(steps):
        return None
    step = float(steps.min())
    off_grid = np.abs(steps / step - np.round(steps / step))
    if len(values) >= len(samples) / 2 or off_grid.max() >= 0.2:
        return None
    moves = np.round(np.diff(samples) / step)  # steps of the grid from sample to sample
    before, after = np.append(0.0, moves[:-1]), np.append(moves[1:], 0.0)
    alone = (moves != 0.0) & (moves != before) & (moves != after)
    return step if np.count_nonzero(alone) > _ALONE * np.count_nonzero(moves) else None
