"""Cycles of a motion: frequency, stiffness, loss angle; and the delay of force behind position.

Energy lost a cycle mixes the material's loss and the channels' skew. They part by frequency: the
loss angle of soft solids changes slowly, about linearly with the logarithm of frequency; skew takes
off an angle proportional to frequency. With fewer than five cyclic recordings, or less than a
factor of four in frequency, the two look alike and nothing is estimated.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.types import JsonObject
from springpot.trainer.recordings.motion import turning_points
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.recording import Recording

_EVEN_STROKES = (0.1, 0.02)  # of the whole travel: what counts as a stroke, large ones first
_FEWEST, _SAME_WAY, _SAME_TIME = 3, 0.1, 0.3  # cycles; of a stroke's way and time
_CUT = 0.15  # of a cycle: turns are found a little inside the first and the last one
_ONE_TONE = 0.5  # of the position's variance that one tone must explain
_MAX_SAMPLES = 200_000
_MIN_POINTS, _MIN_SPAN = 5, 4.0  # frequencies, and the highest over the lowest
_AMPLITUDES = 0.2  # of their logarithm: beyond that the loss may change with amplitude
# 97.5 % quantile of Student's t, a series in 1 / freedom: `check` runs without scipy.
_STUDENT = (0.733, 1.59, 2.556, 2.8225, 2.3723, 1.95996)
_CURVATURE = 0.02  # rad, of the loss angle over the logarithm of frequency: as much is allowed for


@dataclass(frozen=True, eq=False)
class Cycles:
    """Cycles of one recording at one frequency, the first of more than three left out.

    starts: row, with its fraction, at which each cycle begins, and the last one ends.
    stiffness_npm: ratio of the amplitudes of force and position at that frequency.
    lead_rad: how far force leads position there: a nonlinear spring leads by nothing.
    """

    frequency_hz: float
    amplitude_m: float
    stiffness_npm: float
    lead_rad: float
    starts: Samples

    def metadata(self) -> JsonObject:
        """JSON values."""
        keys = ("frequency_hz", "amplitude_m", "stiffness_npm")
        return {key: getattr(self, key) for key in keys} | {"count": len(self.starts) - 1}


def find_cycles(recording: Recording) -> Cycles | None:
    """Analyse the longest run of three cycles or more alike; None without one."""
    starts = _starts(recording.position_m)
    if len(starts) <= _FEWEST:
        return None
    if len(starts) - 1 > _FEWEST:
        starts = starts[1:]  # the first cycle settles: Mullins softening, preconditioning of tissue
    rows = np.arange(int(np.ceil(starts[0])), min(int(starts[-1]) + 1, len(recording.force_n)))
    cycles = (rows - starts[0]) / (starts[1] - starts[0])
    turn = 2.0 * np.pi * cycles
    basis = np.stack([np.cos(turn), np.sin(turn), np.ones(len(rows)), cycles], axis=1)
    channels = np.stack([recording.position_m[rows], recording.force_n[rows]], axis=1)
    found = np.linalg.lstsq(basis, channels, rcond=None)[0]
    x1, f1 = (complex(tone[0], -tone[1]) for tone in found.T)
    # A sine of amplitude X has the variance X^2 / 2.
    if abs(x1) ** 2 / 2 < _ONE_TONE * np.var(channels[:, 0]) or not abs(f1):
        return None
    frequency_hz = recording.rate_hz / float(starts[1] - starts[0])
    return Cycles(frequency_hz, abs(x1), abs(f1) / abs(x1), float(np.angle(f1 / x1)), starts)


def _starts(position_m: Samples) -> Samples:
    """Rows at which each of the cycles alike, in way and time, begins, and the last one ends.

    Rigs approach the object, wait, and leave it again: beside small cycles that is most of the
    motion. The period is that between ways through the middle, which is sharper than a turn.
    """
    travel_m = float(np.ptp(position_m))
    for share in _EVEN_STROKES if travel_m > 0.0 and len(position_m) <= _MAX_SAMPLES else ():
        turns = np.array(turning_points(position_m, share * travel_m), dtype=np.intp)
        ways_m, rows = np.abs(np.diff(position_m[turns])), np.diff(turns)
        alike = np.abs(np.diff(ways_m)) < _SAME_WAY * ways_m[1:]
        alike &= np.abs(np.diff(rows)) < _SAME_TIME * rows[1:]
        ends = np.flatnonzero(np.concatenate([[True], ~alike, [True]]))
        longest = int(np.argmax(np.diff(ends)))
        strokes = turns[ends[longest] : ends[longest + 1] + 1]
        if len(strokes) <= 2 * _FEWEST:
            continue
        middle_m = float(np.mean(position_m[strokes[0] : strokes[-1] + 1]))
        inwards = [pair for pair in pairwise(strokes) if position_m[pair[0]] < middle_m]
        passes = [begin + int(np.argmax(position_m[begin : end + 1] >= middle_m))
                  for begin, end in inwards]  # fmt: skip
        low_m, high_m = position_m[np.array(passes) - 1], position_m[passes]
        at = passes - (high_m - middle_m) / (high_m - low_m)
        period = float(at[-1] - at[0]) / (len(at) - 1)
        start = max(float(at[0]) - period / 4.0, float(strokes[0]))
        count = int((float(strokes[-1]) - start) / period + _CUT)
        return start + period * np.arange(count + 1.0)
    return np.empty(0)


@dataclass(frozen=True)
class Skew:
    """Delay of force behind position, s: estimate, and half the width of its 95 % interval."""

    delay_s: float
    uncertainty_s: float

    def loss(self, recording: Recording, cycles: Cycles) -> dict[str, float]:
        """Loss angle without the delay that is stated, and what the estimated one leaves open."""
        rate = 2.0 * np.pi * cycles.frequency_hz
        stated_s = recording.force_delay_s - recording.position_delay_s
        doubt_s = abs(self.delay_s - stated_s) + self.uncertainty_s
        angle_rad = cycles.lead_rad + rate * stated_s
        return {"angle_rad": angle_rad, "angle_uncertainty_rad": rate * doubt_s}


def estimate_skew(cycles: Sequence[Cycles]) -> Skew | None:
    """Estimate by a loss angle linear in the logarithm of frequency; None where they look alike."""
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
