"""Sampled signals: noise and grid of a sensor, turns of a motion, smoothing.

A sensor adds white noise and the steps of its grid. The paper smooths recordings offline, by a
zero-phase moving average (section III-C).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from springpot.codegen.arrays import Samples, rms, runs
from springpot.trainer.recordings.recording import Recording

_VALUE_TOLERANCE = (
    1e-6  # of the range: the same value, printed with seven digits or converted twice
)
_MIN_IRREGULAR_FRACTION = (
    0.02  # of moves: those unlike the one before and the one after, of a ramp at its ends
)
_DIFFERENCE_ORDER = 4  # of differences: they keep white noise, and leave next to nothing of a press
_MAD_TO_SIGMA = 1.4826  # standard deviation of normal noise over the median of its size
_AIR_FRACTION, _MIN_VISIT_SAMPLES = 0.02, 5  # of the travel; samples
_DRIFT_SIGMAS, _MIN_DRIFT_FRACTION = (
    4.0,
    0.02,
)  # deviations; of the force's range: a drift that is no noise
MAX_SMOOTHED_FRACTION = 0.25  # of the shortest recording
_CONTACT_FORCE_FRACTION = 0.1  # of the largest force
_MAX_DISTORTION = 0.5  # of the noise
_HALVINGS = 3
_SAME_DEPTH_FRACTION, _REST_FRACTION = 0.02, 0.05  # of the range: at one depth; of that: no motion
_MAX_SLOWDOWN = 1.5  # times the samples until it leaves a depth: as fast
_MIN_PEAK_FRACTION = 0.5  # of the set's largest force: in weaker recordings noise makes the peaks


def sensor_noise_n(samples: Samples) -> float:
    """RMS of white noise in a channel (n,), and at least that of its steps' rounding."""
    differences = np.abs(np.diff(samples, _DIFFERENCE_ORDER))
    moved = differences[differences > 0.0]  # a sensor slower than the recording holds its values
    if not len(moved):
        return 0.0
    white_n = (
        _MAD_TO_SIGMA
        * float(np.median(moved))
        / math.sqrt(math.comb(2 * _DIFFERENCE_ORDER, _DIFFERENCE_ORDER))
    )
    return max(white_n, (quantisation_step(samples) or 0.0) / math.sqrt(12))


def quantisation_step(samples: Samples) -> float | None:
    """Smallest step between values on a grid, in the channel's unit; None without a grid.

    Values a constant speed apart, on ramps between holds, are on no sensor's grid: on one, a speed
    takes now more, now fewer of its steps.
    """
    values = np.unique(samples)
    steps = np.diff(values)
    steps = steps[steps > _VALUE_TOLERANCE * float(values[-1] - values[0])]
    if not len(steps):
        return None
    step = float(steps.min())
    off_grid = np.abs(steps / step - np.round(steps / step))
    if len(values) >= len(samples) / 2 or off_grid.max() >= 0.2:
        return None
    moves = np.round(np.diff(samples) / step)  # steps of the grid from sample to sample
    before, after = np.append(0.0, moves[:-1]), np.append(moves[1:], 0.0)
    irregular = (moves != 0.0) & (moves != before) & (moves != after)
    return (
        step
        if np.count_nonzero(irregular) > _MIN_IRREGULAR_FRACTION * np.count_nonzero(moves)
        else None
    )


@dataclass(frozen=True)
class Drift:
    """A straight line in force without contact, N and N/s; bound: of its slope, N/s."""

    start_n: float
    slope_nps: float
    bound_nps: float


def find_drift(recording: Recording, asked: bool = False) -> Drift | None:
    """Find a drift of force where the tool is farthest out; None if noise or relaxing explains it.

    An object that is pressed all along relaxes: its force falls, and not below 0. So what rises, or
    ends below where it began and below 0, is the sensor's. The slope is that of the visits' means,
    and its bound what they scatter around the line, or the noise. asked: whether a person wants it
    off: then any that is beyond its bound is returned.
    """
    position_m, force_n = recording.position_m, recording.force_n
    in_air = position_m <= position_m.min() + _AIR_FRACTION * float(np.ptp(position_m))
    visits = [(begin, end) for begin, end in runs(in_air) if end - begin >= _MIN_VISIT_SAMPLES]
    if len(visits) < 2:
        return None
    time_s = recording.dt_s * np.array([(begin + end - 1) / 2 for begin, end in visits])
    level_n = np.array([float(np.median(force_n[begin:end])) for begin, end in visits])
    middle_s = time_s - time_s.mean()
    spread_s2 = float(middle_s @ middle_s)
    slope_nps = float(middle_s @ level_n) / spread_s2
    line_n = level_n.mean() + slope_nps * middle_s
    noise_n = sensor_noise_n(force_n) / math.sqrt(min(end - begin for begin, end in visits))
    scatter_n = max(rms(level_n - line_n), noise_n)
    bound_nps = _DRIFT_SIGMAS * scatter_n / math.sqrt(spread_s2)
    change_n = slope_nps * (time_s[-1] - time_s[0])
    is_sensor_drift = slope_nps > 0.0 or line_n[-1] < min(
        -_MIN_DRIFT_FRACTION * float(np.ptp(force_n)), line_n[0]
    )
    is_large = is_sensor_drift and abs(change_n) >= _MIN_DRIFT_FRACTION * np.ptp(force_n)
    if abs(slope_nps) < bound_nps or not (asked or is_large):
        return None
    return Drift(float(line_n[0] - slope_nps * time_s[0]), slope_nps, bound_nps)


def turning_points(position_m: Samples, min_m: float) -> list[int]:
    """Indices at which the motion turns round by at least `min_m`, with both ends."""
    # Only where a rise becomes a fall, or the motion ends, can anything change.
    moved = np.flatnonzero(np.diff(position_m, prepend=np.nan))
    rises = np.diff(position_m[moved]) > 0.0
    ends = moved[np.append(rises[1:] != rises[:-1], [True] * (len(moved) > 1)).nonzero()[0] + 1]
    turns, best, rising = [0], 0, None
    for k, value in zip(ends.tolist(), position_m[ends].tolist(), strict=True):
        if rising is None:
            if abs(value - position_m[0]) >= min_m:
                rising, best = value > position_m[0], k
        elif (value > position_m[best]) == rising and value != position_m[best]:
            best = k
        elif abs(value - position_m[best]) >= min_m:
            turns.append(best)
            rising, best = not rising, k
    return [*turns, best] if rising is not None else []


def estimate_history_m(depth_m: Samples) -> Samples:
    """Guess the depths, (k,), m, that came before a motion; empty: the object was at rest.

    A recording that was cut out of a longer one begins in motion inside the object: the tool leaves
    its first depth at once, as fast as it does later. Before it the motion is taken to have been as
    it is up to the last such time, from its mean on; rest there errs three times more.
    """
    off_m, step_m = depth_m - depth_m[0], float(np.abs(np.diff(depth_m)).max(initial=0.0))
    near_m = max(_SAME_DEPTH_FRACTION * float(np.ptp(depth_m)), step_m)
    (_, leaves), *later = runs(np.abs(off_m) <= near_m)
    moves = off_m.min() < -near_m and np.ptp(off_m[: leaves // 2 + 1]) > _REST_FRACTION * near_m
    for begin, end in reversed(later if moves else []):
        left = end - begin - np.flatnonzero(np.abs(off_m[begin:end]) <= step_m)
        same_way = end < len(off_m) and off_m[leaves] * off_m[end] > 0.0 and len(left)
        if same_way and leaves <= _MAX_SLOWDOWN * (alike := left[np.argmin(np.abs(left - leaves))]):
            before_m = depth_m[: end - alike]
            return before_m[np.argmax(np.abs(before_m - before_m.mean()) <= step_m) :]
    return depth_m[:0]


def smoothing_samples(smooth_s: float, dt_s: float) -> int:
    """Return the odd number of samples nearest to `smooth_s`; 1 (no smoothing) if under three."""
    return max(1, 2 * round((smooth_s / dt_s - 1) / 2) + 1)


def smooth(recording: Recording, smooth_s: float) -> Recording:
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


def find_smoothing_s(recordings: Sequence[Recording], most_s: float) -> float:
    """Return the longest of most_s, its half, ... that takes noise and no motion; 0 if none does.

    What it takes off a force in contact is the noise, and a bend that it straightens: the latter
    may be half as large as the noise, RMS. (As long as it flattened no peak by 3 %, impacts of
    50 ms were fitted with ten times the error of none.)
    """
    longest_s = min(
        most_s, MAX_SMOOTHED_FRACTION * min(recording.duration_s for recording in recordings)
    )
    peak_n = max(float(np.abs(recording.force_n).max()) for recording in recordings)
    strong = [
        recording
        for recording in recordings
        if np.abs(recording.force_n).max() >= _MIN_PEAK_FRACTION * peak_n
    ]
    for halvings in range(_HALVINGS + 1):
        smooth_s = longest_s * 0.5**halvings
        if all(
            _estimate_distortion_n(recording, smooth_s)
            <= _MAX_DISTORTION * sensor_noise_n(recording.force_n)
            for recording in strong
        ):
            return smooth_s
    return 0.0


def _estimate_distortion_n(recording: Recording, smooth_s: float) -> float:
    """RMS that smoothing takes off a force in contact beyond its noise, N."""
    samples = smoothing_samples(smooth_s, recording.dt_s)
    contact = np.abs(recording.force_n) > _CONTACT_FORCE_FRACTION * np.abs(recording.force_n).max()
    removed_n = (recording.force_n - smooth(recording, smooth_s).force_n)[contact]
    noise_n = sensor_noise_n(recording.force_n)
    return math.sqrt(max(0.0, float(np.mean(removed_n**2)) - noise_n**2 * (1.0 - 1.0 / samples)))
