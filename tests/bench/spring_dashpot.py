"""A spring beside a dashpot, fitted to recordings: what most devices render today."""

from collections.abc import Sequence

import numpy as np
from scipy.signal import savgol_filter

from springpot.codegen.arrays import Reals
from springpot.trainer.recordings.recording import Recording

_SMOOTH_S = 0.02  # a dashpot of raw differences would be judged by their noise
_TOUCHES = 0.02  # of the peak: below it the tool may be in the air


def spring_dashpot_percent(training: Sequence[Recording], test: Sequence[Recording]) -> float:
    """RMSE on `test` in % of its peak force, of F = max(0, k x + c v + b) fitted to `training`."""
    rows = np.concatenate([_rows(each) for each in training])
    force_n = np.concatenate([each.force_n for each in training])
    touches = force_n > _TOUCHES * force_n.max()
    law = np.linalg.lstsq(rows[touches], force_n[touches], rcond=None)[0]
    error_n = np.concatenate([np.maximum(_rows(each) @ law, 0.0) - each.force_n for each in test])
    peak_n = max(float(np.abs(each.force_n).max()) for each in test)
    return float(100.0 * np.sqrt(np.mean(error_n**2)) / peak_n)


def _rows(recording: Recording) -> Reals:
    """Position, velocity and one of each sample, (n, 3)."""
    window = max(3, 2 * int(0.5 * _SMOOTH_S / recording.dt_s) + 1)
    position_m = recording.position_m
    velocity_mps = savgol_filter(position_m, window, 2, deriv=1, delta=recording.dt_s)
    return np.stack([position_m, velocity_mps, np.ones_like(position_m)], axis=1)
