"""One tone in samples: its frequency, its amplitude, and what it leaves."""

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples

TONE_SHARE = 0.5  # of the position's variance that one tone must explain
_HARMONICS = 5


def find_frequency(position_m: Samples) -> float | None:
    """Frequency of the one tone, cycles a sample, by least squares around the spectrum's peak."""
    n = len(position_m)
    centred = position_m - position_m.mean()
    # A Hann window, so that drift and harmonics do not leak into the peak; four times as many
    # points as samples, so that the true frequency is within an eighth of a cycle a recording.
    spectrum = np.abs(np.fft.rfft(centred * np.hanning(n), 4 * n))
    peak = int(np.argmax(spectrum[2:])) + 2  # from half a cycle a recording on
    low, high = (peak - 4) / (4 * n), (peak + 4) / (4 * n)
    # At least 2000 samples, or 16 a cycle, are plenty for one tone; it is fitted 33 times.
    step = max(1, min(n // 2000, int(4 * n / peak) // 16))
    thin, time = centred[::step], np.arange(n)[::step]
    tried = np.linspace(max(low, 0.2 / n), high, 11)
    for _ in range(3):  # each grid is five times finer than the one before
        left = [tone_residual(thin, 2.0 * np.pi * t * time) for t in tried]
        best = float(tried[int(np.argmin(left))])
        width = float(tried[1] - tried[0])
        tried = np.linspace(best - width, best + width, 11)
    explained = 1.0 - min(left) / float(thin @ thin)
    return best if explained > TONE_SHARE and best * n >= 0.5 else None


def _basis(phase: Samples, harmonics: int) -> NDArray[np.float64]:
    """Mean, drift, and cosine and sine of each harmonic, (n, 2 + 2 harmonics)."""
    drift = np.linspace(-1.0, 1.0, len(phase))
    tones = [g(k * phase) for k in range(1, harmonics + 1) for g in (np.cos, np.sin)]
    return np.stack([np.ones(len(phase)), drift, *tones], axis=1)


def tone_residual(samples: Samples, phase: Samples) -> float:
    """Sum of squares that one tone and a drift leave."""
    basis = _basis(phase, 1)
    # Normal equations: these columns are nearly orthogonal, and this is called often.
    found = np.linalg.lstsq(basis.T @ basis, basis.T @ samples, rcond=None)[0]
    return float(np.sum((samples - basis @ found) ** 2))


def fundamental(samples: Samples, phase: Samples) -> complex:
    """Complex amplitude A of the fundamental, Re(A e^(j phase)), harmonics and drift beside it."""
    found = np.linalg.lstsq(_basis(phase, _HARMONICS), samples, rcond=None)[0]
    return complex(found[2], -found[3])


def even_drift(samples: Samples, phase: Samples) -> Samples:
    """Even change beside the tones: an object that relaxes loses no more energy for it."""
    basis = _basis(phase, _HARMONICS)
    found = np.linalg.lstsq(basis, samples, rcond=None)[0]
    drift: Samples = found[1] * basis[:, 1]
    return drift
