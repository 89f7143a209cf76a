"""Find what repeats: cycles of one recording, and presses; the delay and the noise that they show.

Energy lost a cycle mixes the material's loss and the channels' skew. They part by frequency: the
loss angle of soft solids changes slowly, about linearly with the logarithm of frequency; skew takes
off an angle proportional to frequency. With fewer than five cyclic recordings, or less than a
factor of four in frequency, the two look alike and nothing is estimated.

The noise floor is the error left to a model that knows all: what repeats of a press differ by.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from springpot.codegen.arrays import Samples, rms
from springpot.codegen.types import JsonObject
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import sensor_noise_n, turning_points

_MIN_STROKE_FRACTIONS = (
    0.1,
    0.02,
)  # of the whole travel: what counts as a stroke, large ones first
_MIN_CYCLES, _STROKE_TOLERANCE, _PERIOD_TOLERANCE = (
    3,
    0.1,
    0.3,
)  # cycles; of a stroke's way and time
_END_CYCLE_FRACTION = 0.15  # of a cycle: turns are found a little inside the first and the last one
_MIN_TONE_VARIANCE = 0.5  # of the position's variance that one tone must explain
_MAX_SAMPLES = 200_000
_MIN_FREQUENCIES, _MIN_FREQUENCY_RATIO = 5, 4.0  # frequencies, and the highest over the lowest
_MAX_LOG_AMPLITUDE_SPAN = 0.2  # of their logarithm: beyond that the loss may change with amplitude
# 97.5 % quantile of Student's t, a series in 1 / freedom: `check` runs without scipy.
_STUDENT_T_SERIES = (0.733, 1.59, 2.556, 2.8225, 2.3723, 1.95996)
_MAX_LOSS_CURVATURE = (
    0.02  # rad, of the loss angle over the logarithm of frequency: as much is allowed for
)
_REPEAT_TOLERANCE, _RATE_TOLERANCE = (
    0.02,
    1e-3,
)  # rms difference, of the range of a channel; of rates
# rms difference of the other channel: twice the force is 0.15 or more, ten times the position 0.25
_RESPONSE_TOLERANCE = 0.1
_MAX_COMPARED = 200  # recordings
_CURVE_DEGREE = 7  # degree: tissue stiffens tenfold within a tenth of its depth
_ZERO_NOISE_FRACTION = 1e-5  # of the peak force: what rounding and a press's own curvature leave
_MIN_NOISE_SAMPLES = 16  # of a force, to show its noise

Stack = Samples  # (repeats, samples)


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
    starts = _find_cycle_starts(recording.position_m)
    if len(starts) <= _MIN_CYCLES:
        return None
    if len(starts) - 1 > _MIN_CYCLES:
        starts = starts[1:]  # the first cycle settles: Mullins softening, preconditioning of tissue
    rows = np.arange(int(np.ceil(starts[0])), min(int(starts[-1]) + 1, len(recording.force_n)))
    cycles = (rows - starts[0]) / (starts[1] - starts[0])
    turn = 2.0 * np.pi * cycles
    basis = np.stack([np.cos(turn), np.sin(turn), np.ones(len(rows)), cycles], axis=1)
    channels = np.stack([recording.position_m[rows], recording.force_n[rows]], axis=1)
    coefficients = np.linalg.lstsq(basis, channels, rcond=None)[0]
    x1, f1 = (complex(tone[0], -tone[1]) for tone in coefficients.T)
    # A sine of amplitude X has the variance X^2 / 2.
    if abs(x1) ** 2 / 2 < _MIN_TONE_VARIANCE * np.var(channels[:, 0]) or not abs(f1):
        return None
    frequency_hz = recording.rate_hz / float(starts[1] - starts[0])
    return Cycles(frequency_hz, abs(x1), abs(f1) / abs(x1), float(np.angle(f1 / x1)), starts)


def _find_cycle_starts(position_m: Samples) -> Samples:
    """Rows at which each of the cycles alike, in way and time, begins, and the last one ends.

    Rigs approach the object, wait, and leave it again: beside small cycles that is most of the
    motion. The period is that between ways through the middle, which is sharper than a turn.
    """
    travel_m = float(np.ptp(position_m))
    for share in (
        _MIN_STROKE_FRACTIONS if travel_m > 0.0 and len(position_m) <= _MAX_SAMPLES else ()
    ):
        turns = np.array(turning_points(position_m, share * travel_m), dtype=np.intp)
        strokes_m, rows = np.abs(np.diff(position_m[turns])), np.diff(turns)
        alike = np.abs(np.diff(strokes_m)) < _STROKE_TOLERANCE * strokes_m[1:]
        alike &= np.abs(np.diff(rows)) < _PERIOD_TOLERANCE * rows[1:]
        ends = np.flatnonzero(np.concatenate([[True], ~alike, [True]]))
        longest = int(np.argmax(np.diff(ends)))
        strokes = turns[ends[longest] : ends[longest + 1] + 1]
        if len(strokes) <= 2 * _MIN_CYCLES:
            continue
        middle_m = float(np.mean(position_m[strokes[0] : strokes[-1] + 1]))
        inwards = [pair for pair in pairwise(strokes) if position_m[pair[0]] < middle_m]
        crossing_rows = [begin + int(np.argmax(position_m[begin : end + 1] >= middle_m))
                  for begin, end in inwards]  # fmt: skip
        low_m, high_m = position_m[np.array(crossing_rows) - 1], position_m[crossing_rows]
        crossings = crossing_rows - (high_m - middle_m) / (high_m - low_m)
        period = float(crossings[-1] - crossings[0]) / (len(crossings) - 1)
        start = max(float(crossings[0]) - period / 4.0, float(strokes[0]))
        count = int((float(strokes[-1]) - start) / period + _END_CYCLE_FRACTION)
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
    if (
        len(cycles) < _MIN_FREQUENCIES
        or frequencies.max() < _MIN_FREQUENCY_RATIO * frequencies.min()
    ):
        return None
    logs = np.log(frequencies / np.median(frequencies))
    columns = [np.ones(len(cycles)), logs, -2.0 * np.pi * frequencies]
    amplitudes = np.log([c.amplitude_m for c in cycles])
    if np.ptp(amplitudes) > _MAX_LOG_AMPLITUDE_SPAN:
        columns.append(amplitudes)
    design = np.stack(columns, axis=1)
    lead = np.array([c.lead_rad for c in cycles])
    freedom = len(cycles) - design.shape[1]
    if np.linalg.matrix_rank(design) < design.shape[1]:
        return None
    coefficients = np.linalg.lstsq(design, lead, rcond=None)[0]
    variance = float(np.sum((lead - design @ coefficients) ** 2)) / freedom
    covariance = variance * np.linalg.inv(design.T @ design)
    statistical_s = float(np.polyval(_STUDENT_T_SERIES, 1.0 / freedom) * np.sqrt(covariance[2, 2]))
    # The delay that a loss angle with that much curvature looks like.
    model_s = _MAX_LOSS_CURVATURE * abs(float(np.linalg.lstsq(design, logs**2, rcond=None)[0][2]))
    return Skew(float(coefficients[2]), float(np.hypot(statistical_s, model_s)))


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


@dataclass(frozen=True)
class NoiseFloor:
    """RMS of the force that no model of the recordings can predict, N; None where it is unknown.

    words: what it is from, or why it is unknown, to stand behind the figure.
    """

    rms_n: float | None
    source: Literal["repeats", "cycles", "sensor"] | None
    words: str


def find_noise_floor(
    recordings: Sequence[Recording], cycles: Sequence[Cycles | None] | None = None
) -> NoiseFloor:
    """The noise floor of recordings in the order in which they were made.

    From repeated presses; else from cycles, which are found if they are not given; else from the
    force's noise. By what repeats of one session differ is no noise: the object remembers.
    """
    groups = ((group, {recording.start_s is not None and recording.session for recording in group})
             for group in find_repeats(recordings))  # fmt: skip
    if repeats := [group for group, sessions in groups if len(sessions) > 1 or not all(sessions)]:
        number = " or ".join(map(str, sorted({len(group) for group in repeats})))
        presses = "one press" if len(repeats) == 1 else f"each of {len(repeats)} presses"
        words = f"from {number} repeats of {presses}"
        return NoiseFloor(rms(np.array([*map(_repeat_noise_n, repeats)])), "repeats", words)
    pairs = zip(recordings, cycles or map(find_cycles, recordings), strict=True)
    if cyclic := [
        rms_n
        for recording, recording_cycles in pairs
        if recording_cycles and (rms_n := _cycle_noise_n(recording, recording_cycles))
    ]:
        number = f"{len(cyclic)} recordings" if len(cyclic) > 1 else "one recording"
        words = f"from the repeated cycles within {number}"
        return NoiseFloor(rms(np.array(cyclic)), "cycles", words)
    forces = [each.force_n for each in recordings if len(each.force_n) >= _MIN_NOISE_SAMPLES]
    rms_n = rms(np.array([sensor_noise_n(force_n) for force_n in forces] or [0.0]))
    if rms_n <= _ZERO_NOISE_FRACTION * max(
        (float(np.abs(force_n).max()) for force_n in forces), default=0.0
    ):
        return NoiseFloor(None, None, "no press is repeated, and the force shows no noise")
    return NoiseFloor(rms_n, "sensor", "from the sensor's noise; repeats would show more")


def find_repeats(recordings: Sequence[Recording]) -> list[list[Recording]]:
    """Group recordings of one press, of equal length and rate; a copy is no repeat."""
    groups: list[list[Recording]] = []
    for recording in recordings[:_MAX_COMPARED]:
        group = next((g for g in groups if _is_same_press(g[0], recording)), None)
        if group is None:
            groups.append([recording])
        elif all(recording.content_hash != other.content_hash for other in group):
            group.append(recording)
    return [group for group in groups if len(group) > 1]


def _is_same_press(one: Recording, other: Recording) -> bool:
    """Return whether one path was driven twice, or one force, at one place, with like response."""
    same = one.place_m == other.place_m and abs(one.dt_s / other.dt_s - 1) < _RATE_TOLERANCE
    if not same or len(one.force_n) != len(other.force_n):
        return False
    pairs = ((one.position_m, other.position_m), (one.force_n, other.force_n))
    stacks = [np.stack(pair) for pair in pairs]
    alike = all(_is_repeated(stack, _RESPONSE_TOLERANCE) for stack in stacks)
    return alike and any(map(_is_repeated, stacks))


def _repeat_noise_n(group: Sequence[Recording]) -> float:
    """RMS by which each differs from the mean of the k before, which adds a k-th to its noise."""
    positions, forces = (np.stack([getattr(recording, channel) for recording in group])
                         for channel in ("position_m", "force_n"))  # fmt: skip
    steady = _correct_positions(positions, forces)
    before = np.arange(1, len(group))[:, None]
    deviation_n = steady[1:] - np.cumsum(steady, axis=0)[:-1] / before
    return float(np.sqrt(np.mean(before / (before + 1.0) * deviation_n**2)))


def _cycle_noise_n(recording: Recording, cycles: Cycles) -> float | None:
    """RMS by which each cycle differs from the one before, N; None where neither channel repeats.

    Means are apart, for what settles can be predicted.
    """
    period, rows = cycles.starts[1] - cycles.starts[0], np.arange(len(recording.force_n))
    points = max(8, int(period))
    sample_rows = cycles.starts[:-1, None] + period * np.arange(points) / points
    stacks = [
        np.interp(sample_rows, rows, samples)
        for samples in (recording.position_m, recording.force_n)
    ]
    position, force = (stack - stack.mean(axis=1, keepdims=True) for stack in stacks)
    if not (_is_repeated(position) or _is_repeated(force)):
        return None
    # Interpolating between two samples averages them: so much of white noise is left over.
    noise_gain = float(np.mean((sample_rows % 1.0) ** 2 + (1.0 - sample_rows % 1.0) ** 2))
    steps_n = np.diff(_correct_positions(position, force), axis=0)
    return float(np.sqrt(np.mean(steps_n**2) / (2.0 * noise_gain)))


def _is_repeated(stack: Stack, tolerance: float = _REPEAT_TOLERANCE) -> bool:
    """Return whether samples (repeats, samples) are the same in every repeat."""
    deviation = stack - stack.mean(axis=0)
    return rms(deviation) < tolerance * float(np.ptp(stack))


def _correct_positions(position_m: Stack, force_n: Stack) -> Stack:
    """Forces of repeats, (repeats, samples), N, moved to the repeats' mean position.

    A press that is driven by force repeats its force, and differs in position where the object
    does: each force moves along the press's own stiffness there. (A line through the differences
    would not do: it takes a softer object for one that was pressed deeper.)
    """
    mean_m = position_m.mean(axis=0)
    if not np.ptp(mean_m):
        return force_n
    # `full`: few distinct positions are no reason to warn
    curve, _ = np.polynomial.Polynomial.fit(mean_m, force_n.mean(axis=0), _CURVE_DEGREE, full=True)
    moved: Stack = force_n - curve.deriv()(mean_m) * (position_m - mean_m)
    return moved
