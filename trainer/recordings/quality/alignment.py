"""The delay of force behind position, estimated from the data, with its uncertainty.

Energy lost a cycle mixes the material's loss and the channels' skew. They part by frequency: the
loss angle of soft solids changes slowly, about linearly with the logarithm of frequency; skew takes
off an angle proportional to frequency. With fewer than five cyclic recordings, or less than a
factor of four in frequency, the two look alike and nothing is estimated.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from springpot.trainer.recordings.quality.cycles import Cycles
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.recording import Recording

_MIN_POINTS = 5
_MIN_SPAN = 4.0
_AMPLITUDES = 0.2  # of their logarithm: beyond that the loss may change with amplitude
# 97.5 % quantile of Student's t, a series in 1 / freedom: `check` runs without scipy.
_STUDENT = (0.733, 1.59, 2.556, 2.8225, 2.3723, 1.95996)
_CURVATURE = 0.02  # rad, of the loss angle over the logarithm of frequency: as much is allowed for


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
    columns = [np.ones(len(cycles)), logs, -2.0 * np.pi * frequencies]
    amplitudes = np.log([c.amplitude_m for c in cycles])
    if np.ptp(amplitudes) > _AMPLITUDES:
        columns.append(amplitudes)
    design = np.stack(columns, axis=1)
    lead = np.array([c.lead_rad for c in cycles])
    freedom = len(cycles) - design.shape[1]
    if np.linalg.matrix_rank(design) < design.shape[1]:
        return None
    found = np.linalg.lstsq(design, lead, rcond=None)[0]
    variance = float(np.sum((lead - design @ found) ** 2)) / freedom
    covariance = variance * np.linalg.inv(design.T @ design)
    statistical_s = float(np.polyval(_STUDENT, 1.0 / freedom) * np.sqrt(covariance[2, 2]))
    # The delay that a loss angle with that much curvature looks like.
    model_s = _CURVATURE * abs(float(np.linalg.lstsq(design, logs**2, rcond=None)[0][2]))
    return Skew(float(found[2]), float(np.hypot(statistical_s, model_s)))


def loss_angle(recording: Recording, cycles: Cycles, skew: Skew | None) -> dict[str, float] | None:
    """Loss angle without the delay that is stated; None if the delay is unknown: it looks alike."""
    if skew is None:
        return None
    rate = 2.0 * np.pi * cycles.frequency_hz
    stated_s = recording.force_delay_s - recording.position_delay_s
    doubt_s = abs(skew.delay_s - stated_s) + skew.uncertainty_s
    angle_rad = cycles.lead_rad + rate * stated_s
    return {"angle_rad": angle_rad, "angle_uncertainty_rad": rate * doubt_s}


def skew_findings(recordings: Sequence[Recording], skew: Skew | None) -> Iterator[Finding]:
    """Yield a finding where force is later than stated by more than the estimate's uncertainty."""
    stated_s = float(np.mean([r.force_delay_s - r.position_delay_s for r in recordings]))
    if skew and min(abs(skew.delay_s), abs(skew.delay_s - stated_s)) > skew.uncertainty_s:
        whole_s = skew.delay_s + np.mean([r.details.get("aligned_s", 0.0) for r in recordings])
        delay = f"{skew.delay_s * 1e3:.2g} +- {skew.uncertainty_s * 1e3:.2g} ms"
        yield warning(
            "alignment", f"all {len(recordings)} recordings",
            f"force seems to come {delay} after position",
            "loss, and with it stability, would be learned wrong",
            f"import with --force-delay-s {whole_s:.2g} --align",
        )  # fmt: skip
