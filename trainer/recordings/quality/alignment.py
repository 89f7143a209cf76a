"""The delay of force behind position, estimated from the data, with its uncertainty.

Energy lost a cycle mixes the material's loss and the channels' skew. They part by frequency: the
loss angle of soft solids changes slowly, about linearly with the logarithm of frequency; skew takes
off an angle proportional to frequency. With fewer than five cyclic recordings, or less than a
factor of four in frequency, the two look alike and nothing is estimated. Nor is anything from
single presses: the loss of a first press is that of an object that settles, not of a cycle.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from springpot.trainer.recordings.quality.cycles import Cycles
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.recording import Recording

_MIN_POINTS = 5
STEADY = 3  # cycles
_MIN_SPAN = 4.0
# A table, since `check` runs where scipy is not installed.
_STUDENT = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228)
_FILTERED_RAD = 0.005  # of phase at the recording's frequency: a hard silicone's loss is 0.06
# Of the loss angle against the logarithm of frequency, rad, that is allowed for. Nine simulated
# objects, four of them foreign to our models, cycles of 0.25 to 5 Hz from the surface and about a
# preload, force shifted by -3, 0, 1, 3 and 10 ms: the interval holds the truth in 269 of 270 cases.
_CURVATURE = 0.02


@dataclass(frozen=True)
class Skew:
    """Delay of force behind position, s: estimate, and half the width of its 95 % interval.

    It rests on a loss angle linear in the logarithm of frequency and of amplitude.
    """

    delay_s: float
    uncertainty_s: float


def estimate_skew(cycles: Sequence[Cycles]) -> Skew | None:
    """Estimate from cyclic recordings of several frequencies; None where delay looks like loss."""
    cycles = [found for found in cycles if found.count >= STEADY]
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


def filter_findings(
    recordings: Sequence[Recording], cycles: Sequence[Cycles | None], skew: Skew | None
) -> Iterator[Finding]:
    """Yield a finding for each filter of a load cell that delays force: no phase of the material's.

    cycles: of each recording, None if it has none.
    """
    late: dict[float, list[tuple[str, float | None]]] = {}
    for recording, own in zip(recordings, cycles, strict=True):
        if delay_s := filter_delay_s(recording, skew):
            hz = own.frequency_hz if own else None
            if hz is None or 2 * np.pi * hz * delay_s >= _FILTERED_RAD:
                late.setdefault(delay_s, []).append((recording.name, hz))
    for delay_s, found in late.items():
        names = [name for name, _ in found]
        fastest_hz = max((hz for _, hz in found if hz is not None), default=None)
        so_what = f"force comes about {delay_s * 1e3:.3g} ms late"
        if fastest_hz is not None:
            lag_rad = 2 * np.pi * fastest_hz * delay_s
            so_what += f", {lag_rad:.2g} rad at {fastest_hz:.3g} Hz"
        details = next(r.details for r in recordings if r.name == names[0])
        yield warning(
            "filter", names[0] if len(names) == 1 else f"{len(names)} recordings",
            f"the load cell was low-passed at {details['load_cell_low_pass_hz']:g} Hz, order "
            f"{details.get('load_cell_low_pass_order', 1)}",
            f"{so_what}: its phase is not the material's",
            f"state it on import, --force-delay-s {delay_s:.4g}, if position is not filtered alike",
        )  # fmt: skip


def filter_delay_s(recording: Recording, skew: Skew | None) -> float:
    """Delay of force by the load cell's own low-pass, s; 0 without one.

    0 too if a delay was stated or taken out, and if the data exclude it: where position went
    through a filter alike, force is not late.
    """
    cutoff_hz = recording.details.get("load_cell_low_pass_hz")
    if cutoff_hz is None or recording.force_delay_s or "aligned_s" in recording.details:
        return 0.0
    order = int(recording.details.get("load_cell_low_pass_order", 1))
    delay_s = low_pass_delay_s(order, float(cutoff_hz))
    if skew is not None and abs(delay_s - skew.delay_s) > skew.uncertainty_s:
        return 0.0
    return delay_s


def skew_findings(recordings: Sequence[Recording], skew: Skew | None) -> Iterator[Finding]:
    """Yield a finding where force is later than stated by more than the estimate's uncertainty."""
    if skew is None or abs(skew.delay_s) <= skew.uncertainty_s:
        return
    stated_s = np.mean([r.force_delay_s - r.position_delay_s for r in recordings])
    if abs(skew.delay_s - stated_s) <= skew.uncertainty_s:
        return
    remedy = "state the delay on import (--force-delay-s), with --align to take it out"
    taken_s = np.mean([r.details.get("aligned_s", 0.0) for r in recordings])
    if taken_s:
        remedy = (
            f"{taken_s * 1e3:.3g} ms were taken out on import: import again without --align, or "
            f"with {(taken_s + skew.delay_s) * 1e3:.2g} ms"
        )
    yield warning(
        "alignment", f"all {len(recordings)} recordings",
        f"force seems to come {skew.delay_s * 1e3:.2g} +- {skew.uncertainty_s * 1e3:.2g} ms after "
        "position",
        "loss, and with it stability, would be learned wrong",
        remedy,
    )  # fmt: skip


def _student_95(freedom: int) -> float:
    """97.5 % quantile of Student's t, by table and then to 1e-3 by its first term."""
    if freedom <= len(_STUDENT):
        return _STUDENT[freedom - 1]
    return 1.95996 + 2.3723 / freedom + 2.82 / freedom**2
