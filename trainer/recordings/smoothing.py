"""Offline smoothing of recordings: the paper's zero-phase moving average (section III-C)."""

from dataclasses import replace

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.recording import Recording


def smoothing_samples(smooth_s: float, dt_s: float) -> int:
    """Return the odd number of samples nearest to `smooth_s`; 1 (no smoothing) if under three."""
    return max(1, 2 * round((smooth_s / dt_s - 1) / 2) + 1)


def smoothed(recording: Recording, smooth_s: float) -> Recording:
    """Return the centred moving average over `smooth_s`; ends repeat the end samples."""
    samples = smoothing_samples(smooth_s, recording.dt_s)

    def average(values: Samples) -> Samples:
        """Running sum, as scipy.ndimage.uniform_filter1d: what replays recordings has no scipy."""
        padded = np.pad(values, samples // 2, mode="edge")
        first = np.add.accumulate(padded[:samples])[-1]
        changes = padded[samples:] - padded[:-samples]
        return np.asarray(np.add.accumulate(np.append(first, changes)) / samples)

    if samples == 1:
        return recording
    return replace(
        recording, position_m=average(recording.position_m), force_n=average(recording.force_n)
    )
