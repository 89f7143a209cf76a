"""The delay of force behind position, estimated from the data, with its uncertainty.

Energy lost a cycle mixes the material's loss and the channels' skew. They part by frequency: the
loss angle of soft solids changes slowly, about linearly with the logarithm of frequency; skew takes
off an angle proportional to frequency. With fewer than five cyclic recordings, or less than a
factor of four in frequency, the two look alike and nothing is estimated.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from springpot.trainer.recordings.quality.cycles import Cycles

_MIN_POINTS = 5
_MIN_SPAN = 4.0
_STUDENT = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228)
# Of the loss angle against the logarithm of frequency, rad, that is allowed for: it covers 16 of 16
# cases (four simulated silicones, each with force shifted by -1, 0, 1 and 3 ms); the worst was off
# by 1.35 ms.
_CURVATURE = 0.01


@dataclass(frozen=True)
class Skew:
    """Delay of force behind position, s: estimate, and half the width of its 95 % interval.

    It rests on a loss angle linear in the logarithm of frequency and of amplitude.
    """

    delay_s: float
    uncertainty_s: float


def estimate_skew(cycles: Sequence[Cycles]) -> Skew | None:
    """Estimate from cyclic recordings of several frequencies; None where delay looks like loss."""
    frequencies = np.array([c.frequency_hz for c in cycles])
    if len(cycles) < _MIN_POINTS or frequencies.max() < _MIN_SPAN * frequencies.min():
        return None
    logs = np.log(frequencies / np.median(frequencies))
    columns = [np.ones(len(cycles)), logs, np.array([c.skew_rad_per_s for c in cycles])]
    amplitudes = np.log([c.amplitude_m for c in cycles])
    if np.ptp(amplitudes) > 0.2:
        columns.append(amplitudes)
    design = np.stack(columns, axis=1)
    lead = np.array([c.lead_rad for c in cycles])
    freedom = len(cycles) - design.shape[1]
    if freedom < 1 or np.linalg.matrix_rank(design) < design.shape[1]:
        return None
    found = np.linalg.lstsq(design, lead, rcond=None)[0]
    variance = float(np.sum((lead - design @ found) ** 2)) / freedom
    covariance = variance * np.linalg.inv(design.T @ design)
    statistical_s = _student_95(freedom) * float(np.sqrt(covariance[2, 2]))
    # The delay that a loss angle with that much curvature looks like.
    model_s = _CURVATURE * abs(float(np.linalg.lstsq(design, logs**2, rcond=None)[0][2]))
    return Skew(float(found[2]), float(np.hypot(statistical_s, model_s)))


def low_pass_delay_s(order: int, cutoff_hz: float) -> float:
    """Delay of a Butterworth low-pass well below its cutoff, s: the sum of its poles' 1/(-p)."""
    angles = np.pi * (2 * np.arange(order) + order + 1) / (2 * order)
    poles = 2 * np.pi * cutoff_hz * np.exp(1j * angles)
    return float(np.sum(-1.0 / poles).real)


def _student_95(freedom: int) -> float:
    """97.5 % quantile of Student's t, by table and then to 1e-3 by its first term."""
    if freedom <= len(_STUDENT):
        return _STUDENT[freedom - 1]
    return 1.95996 + 2.3723 / freedom + 2.82 / freedom**2
