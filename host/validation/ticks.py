"""Recordings that are slower than a scene, at the scene's ticks, and forces back at their samples.

Between two samples the position is taken to be on a straight line; forces are compared where they
were measured, so that neither the error nor the noise floor is of made-up samples.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from springpot.trainer.recordings.recording import Recording

_SAME_RATE = 1e-3  # apart, relatively: one rate, as `require_compatible` has it


def at_ticks(recording: Recording, dt_s: float) -> Recording:
    """A recording at a scene's time step; itself, if that is its own."""
    if abs(recording.dt_s / dt_s - 1.0) <= _SAME_RATE:
        return recording
    own_s = np.arange(len(recording.position_m)) * recording.dt_s
    tick_s = np.arange(int(own_s[-1] / dt_s + 1e-6) + 1) * dt_s
    return replace(
        recording,
        position_m=np.interp(tick_s, own_s, recording.position_m),
        force_n=np.interp(tick_s, own_s, recording.force_n),
        dt_s=dt_s,
    )


def at_samples(
    force_n: NDArray[np.float64], recording: Recording, dt_s: float
) -> NDArray[np.float64]:
    """Forces of a scene's ticks, (ticks,), N, at the recording's samples, (samples,)."""
    if len(force_n) == len(recording.position_m):
        return force_n
    own_s = np.arange(len(recording.position_m)) * recording.dt_s
    found_n: NDArray[np.float64] = np.interp(own_s, np.arange(len(force_n)) * dt_s, force_n)
    return found_n


def samples_of(ticks: int, recording: Recording, dt_s: float) -> int:
    """How many of the recording's samples lie in its first `ticks` ticks."""
    return -(-ticks * round(1e6 * dt_s) // round(1e6 * recording.dt_s))
