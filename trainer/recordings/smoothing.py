"""Offline smoothing of recordings: the paper's zero-phase moving average (section III-C)."""

import dataclasses

import numpy as np
from numpy.typing import NDArray

from springpot.trainer.recordings.recording import Recording

_MIN_SAMPLES = 3


def smoothing_samples(smooth_s: float, dt_s: float) -> int:
    """Odd number of samples nearest to `smooth_s`; 1 (no smoothing) where that is under three."""
    samples = 2 * round((smooth_s / dt_s - 1) / 2) + 1
    return samples if samples >= _MIN_SAMPLES else 1


def smoothed(recording: Recording, smooth_s: float) -> Recording:
    """Centred moving average of both channels over `smooth_s`; ends repeat the end samples."""
    samples = smoothing_samples(smooth_s, recording.dt_s)
    if samples == 1:
        return recording
    return dataclasses.replace(
        recording,
        position_m=_average(recording.position_m, samples),
        force_n=_average(recording.force_n, samples),
    )


def _average(values: NDArray[np.float64], samples: int) -> NDArray[np.float64]:
    """Running sum, as scipy.ndimage.uniform_filter1d: what replays recordings has no scipy."""
    padded = np.pad(values, samples // 2, mode="edge")
    first = np.add.accumulate(padded[:samples])[-1]
    changes = padded[samples:] - padded[:-samples]
    averaged: NDArray[np.float64] = np.add.accumulate(np.append(first, changes)) / samples
    return averaged
