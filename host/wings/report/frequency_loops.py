"""The loops that a sum of sines is made of: what of depth and force swings at each frequency."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.validation import Series

_SHARE = 0.2  # of the largest swing: smaller ones are harmonics and noise
_MOST = 6
_MIN_CYCLES = 3.0


@dataclass(frozen=True)
class LoopRow:
    """One frequency. measured, predicted: complex force (N) where depth is depth_m cos(w t)."""

    frequency_hz: float
    depth_m: float
    measured: complex
    predicted: complex


def frequency_loops(item: Series) -> list[LoopRow]:
    """Frequencies that the depth holds, lowest first, fitted together by least squares."""
    frequencies = _frequencies(item.position_m, item.dt_s)
    if not len(frequencies):
        return []
    time_s = np.arange(len(item.position_m)) * item.dt_s
    waves = np.exp(2j * np.pi * np.outer(time_s, frequencies))
    basis = np.column_stack([waves.real, -waves.imag, np.ones_like(time_s), time_s])
    signals = np.column_stack([item.position_m, item.measured_n, item.predicted_n])
    found = np.linalg.lstsq(basis, signals, rcond=None)[0]
    n = len(frequencies)
    depth, measured, predicted = (found[:n] + 1j * found[n : 2 * n]).T
    turned = depth / np.abs(depth)
    return [
        LoopRow(float(f), float(abs(x)), complex(m / t), complex(p / t))
        for f, x, m, p, t in zip(frequencies, depth, measured, predicted, turned, strict=True)
    ]


def _frequencies(position_m: NDArray[np.float64], dt_s: float) -> NDArray[np.float64]:
    """Peaks of the depth's spectrum, Hz, lowest first."""
    n = len(position_m)
    size = np.abs(np.fft.rfft((position_m - position_m.mean()) * np.hanning(n)))
    inner = size[1:-1]
    peaks = 1 + np.flatnonzero((inner > size[:-2]) & (inner >= size[2:]))
    peaks = peaks[(peaks >= _MIN_CYCLES) & (size[peaks] > _SHARE * size.max(initial=0.0))]
    largest = peaks[np.argsort(size[peaks])[::-1][:_MOST]]
    # Between two lines the peak's place is that of a parabola through the logarithms beside it.
    left, middle, right = (np.log(np.maximum(size[largest + k], 1e-300)) for k in (-1, 0, 1))
    bend = left - 2.0 * middle + right
    shift = np.where(bend < 0.0, 0.5 * (left - right) / np.where(bend == 0.0, 1.0, bend), 0.0)
    found: NDArray[np.float64] = np.sort((largest + shift) / (n * dt_s))
    return found
