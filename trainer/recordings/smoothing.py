"""Offline smoothing of recordings: the paper's zero-phase moving average (section III-C)."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.recording import Recording

MAX_SMOOTHED = 0.25  # of the shortest recording
_FLATTENED = 0.03  # of a peak: an impact of 30 ms once lost half of its own
_HALVINGS = 3
_STRONG = 0.5  # of the set's largest force: in weaker recordings noise makes the peaks
_NOISE_OF_STEPS = 0.605  # 1 / (0.6745 sqrt 6), of the median of second differences' sizes


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


def longest_smoothing_s(recordings: Sequence[Recording], most_s: float) -> float:
    """Return the longest of most_s, its half, ... that takes noise and no peak; 0 if none does."""
    longest_s = min(most_s, MAX_SMOOTHED * min(each.duration_s for each in recordings))
    peaks_n = [float(np.abs(each.force_n).max()) for each in recordings]
    strong = [
        (each, peak_n - 3.0 * _noise_n(each.force_n))
        for each, peak_n in zip(recordings, peaks_n, strict=True)
        if peak_n >= _STRONG * max(peaks_n)
    ]
    for halvings in range(_HALVINGS + 1):
        smooth_s = longest_s * 0.5**halvings
        if all(
            np.abs(smoothed(each, smooth_s).force_n).max() >= (1.0 - _FLATTENED) * peak_n
            for each, peak_n in strong
        ):
            return smooth_s
    return 0.0


def _noise_n(force_n: Samples) -> float:
    """Standard deviation of white noise on a smooth force, from its second differences."""
    return _NOISE_OF_STEPS * float(np.median(np.abs(np.diff(force_n, 2, prepend=0.0))))
