"""Cyclic recordings: frequency, stiffness, energy lost a cycle, and how these repeat."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.quality.motion import turning_points
from springpot.trainer.recordings.quality.tone import (
    TONE_SHARE,
    even_drift,
    find_frequency,
    fundamental,
    tone_residual,
)
from springpot.trainer.recordings.recording import Recording

_CUT_TOLERANCE = 0.15  # of a cycle: cutting rests takes a little of the first and the last one
_OFF_CENTRE = 0.1  # of the amplitude: a cycle about another mean is on the way in
_MIN_CYCLES = 3  # that are left without it
_EVEN_STROKES = (0.1, 0.02)  # of the whole travel: what counts as a stroke, large ones first
_SAME_WAY, _SAME_TIME = 0.1, 0.3
_CLOSED = 0.05  # of the travel
SAME_PRESS = 0.02  # of the range of position or of force: rms difference of repeats
_CURVE = 7  # degree: tissue stiffens tenfold within a tenth of its depth
_MAX_SAMPLES = 200_000


@dataclass(frozen=True, eq=False)
class Cycles:
    """A recording at one frequency.

    stiffness_npm: ratio of the amplitudes of force and position at that frequency.
    lead_rad: how far force leads position, as the energy lost a cycle says (asin of W / pi F X):
    a nonlinear spring loses none, whatever the shape of its force.
    energy_j: W, lost a cycle. skew_rad_per_s: what a second of delay of the force takes off the
    lead. noise_n: of each cycle against the one before, rms, at equal positions, means apart;
    drift_n: mean force of the last cycle less that of the first; both None for fewer than three
    cycles, and where neither position nor force repeats: a sum of tones is no cycle.
    """

    frequency_hz: float
    amplitude_m: float
    stiffness_npm: float
    lead_rad: float
    energy_j: float
    skew_rad_per_s: float
    noise_n: float | None
    drift_n: float | None
    count: int
    tone_share: float


def find_cycles(recording: Recording) -> Cycles | None:
    """Analyse a recording that moves at one frequency; None where it does not."""
    if not 16 <= len(recording.position_m) <= _MAX_SAMPLES or not np.ptp(recording.position_m):
        return None
    position_m, force_n = _moving(recording.position_m, recording.force_n)
    frequency = find_frequency(position_m)
    if frequency is None or frequency * len(position_m) < 1.5:
        among = _even_strokes(position_m)
        if among is not None and (tone := find_frequency(position_m[among])) is not None:
            position_m, force_n, frequency = position_m[among], force_n[among], tone
    # Fewer than 1.5 cycles: one closed press counts as a cycle of its own length.
    if frequency is None or frequency * len(position_m) < 1.5:
        if not _is_one_press(recording.position_m, recording.force_n):
            return None
        position_m, force_n = recording.position_m, recording.force_n
        frequency = 1.0 / len(position_m)
    elif (way_in := _way_in(position_m, 1.0 / frequency)) > 0:
        position_m, force_n = position_m[way_in:], force_n[way_in:]
        frequency = find_frequency(position_m) or frequency
    period = 1.0 / frequency  # samples
    count = int(len(position_m) / period + _CUT_TOLERANCE)
    if count < 1 or period < 8:
        return None
    used = min(len(position_m), round(count * period))
    # The first cycle settles (Mullins softening, preconditioning of tissue).
    first = used - round((count - 1) * period) if count > 3 else 0
    x, f = position_m[first:used], force_n[first:used]
    phase: Samples = 2.0 * np.pi * frequency * np.arange(len(x), dtype=np.float64)
    x1, f1 = fundamental(x, phase), fundamental(f, phase)
    # A sine of amplitude X has the variance X^2 / 2.
    if abs(x1) ** 2 / 2 < TONE_SHARE * np.var(x) or not abs(f1):
        return None  # a ramp, or several tones
    cycles = max(1, round(len(x) / period))
    energy_j = _loop(f - even_drift(f, phase), x) / cycles
    # Linear force F cos(wt + lead) on X cos(wt) loses pi F X sin(lead) a cycle.
    reference_j = np.pi * abs(x1) * abs(f1)
    # d/ds of the loop integral of f(t - s) dx: minus the integral of f' dx.
    slope = -_loop(np.gradient(f), x) / cycles / recording.dt_s / reference_j
    noise_n, drift_n = _repeat(x, f, period)
    return Cycles(
        frequency_hz=frequency / recording.dt_s,
        amplitude_m=float(abs(x1)),
        stiffness_npm=float(abs(f1) / abs(x1)),
        lead_rad=float(np.arcsin(np.clip(energy_j / reference_j, -1.0, 1.0))),
        energy_j=energy_j,
        skew_rad_per_s=slope,
        noise_n=noise_n,
        drift_n=drift_n,
        count=count,
        tone_share=1.0 - tone_residual(x, phase) / (len(x) * float(np.var(x))),
    )


def _moving(position_m: Samples, force_n: Samples) -> tuple[Samples, Samples]:
    """Cut rests at both ends: test rigs wait before and after their cycles.

    A rest ends 2 % of the travel away from its level, or at the first step of a five-hundredth of
    the travel if that is sooner, so that a fast press is not cut.
    """
    moved = np.flatnonzero(np.abs(np.diff(position_m)) > 2e-3 * np.ptp(position_m))
    slow = np.flatnonzero(np.abs(position_m - position_m[0]) > 0.02 * np.ptp(position_m))
    begin = int(slow[0]) if len(slow) else 0
    back = np.flatnonzero(np.abs(position_m - position_m[-1]) > 0.02 * np.ptp(position_m))
    end = int(back[-1]) + 1 if len(back) else len(position_m)
    if len(moved):
        begin, end = min(begin, int(moved[0])), max(end, int(moved[-1]) + 2)
    return position_m[begin:end], force_n[begin:end]


def _even_strokes(position_m: Samples) -> slice | None:
    """The longest run of three cycles or more alike, in way and time; None without one.

    Rigs approach the object, wait, and leave it again: beside small cycles that is most of the
    motion.
    """
    for share in _EVEN_STROKES:
        turns = np.array(turning_points(position_m, share * float(np.ptp(position_m))), dtype=int)
        if len(turns) < 2:
            continue
        ways_m, ticks = np.abs(np.diff(position_m[turns])), np.diff(turns)
        runs, first = [], 0
        for k in range(1, len(ways_m) + 1):
            alike = k < len(ways_m) and (
                abs(ways_m[k] / ways_m[first] - 1.0) < _SAME_WAY
                and abs(ticks[k] / ticks[first] - 1.0) < _SAME_TIME
            )
            if not alike:
                runs.append((k - first, first))
                first = k
        strokes, first = max(runs)
        if strokes >= 2 * _MIN_CYCLES:
            return slice(int(turns[first]), int(turns[first + strokes]) + 1)
    return None


def _way_in(position_m: Samples, period: float) -> int:
    """Samples of whole cycles before the mean position is that of the rest: a press in between."""
    count = int(len(position_m) / period)
    ends = np.round(period * np.arange(count + 1)).astype(int)
    pieces = np.split(position_m[: ends[-1]], ends[1:-1]) if count > _MIN_CYCLES else []
    means = np.array([piece.mean() for piece in pieces])
    if not len(means):
        return 0
    reach_m = float(np.ptp(pieces[-1])) / 2
    there = np.flatnonzero(np.abs(means - np.median(means)) < _OFF_CENTRE * reach_m)
    first = int(there[0]) if len(there) else 0
    return int(ends[first]) if count - first >= _MIN_CYCLES else 0


def _is_one_press(position_m: Samples, force_n: Samples) -> bool:
    """Return whether the path goes in and out once and is closed: a cycle of its own length.

    Where force is 0 at both ends, what is missing in position costs no energy.
    """
    open_m = abs(float(position_m[-1] - position_m[0]))
    end_n = max(abs(float(force_n[0])), abs(float(force_n[-1])))
    span_m, peak_n = float(np.ptp(position_m)), float(np.abs(force_n).max())
    if open_m > _CLOSED * span_m and end_n > _CLOSED * peak_n:
        return False
    phase = 2.0 * np.pi * np.arange(len(position_m)) / len(position_m)
    left = tone_residual(position_m, phase)
    return left < (1.0 - TONE_SHARE) * float(np.sum((position_m - position_m.mean()) ** 2))


def _loop(f: Samples, x: Samples) -> float:
    """Integral of f dx by trapezoids: 0 over the closed loop of a linear spring."""
    return float(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(x)))


def _repeat(
    position_m: Samples, force_n: Samples, period: float
) -> tuple[float | None, float | None]:
    """Noise floor and drift, N, of cycles that are the same; None for fewer than three."""
    count = int(len(force_n) / period + _CUT_TOLERANCE)
    if count < 3:
        return None, None
    points = max(8, int(period))
    at = (np.arange(count)[:, None] + np.arange(points) / points) * period
    time = np.arange(len(force_n))
    force, position = (
        np.interp(at.ravel(), time, samples).reshape(count, points)
        for samples in (force_n, position_m)
    )
    if not (_repeats(position) or _repeats(force)):
        return None, None
    share = at % 1.0
    # Interpolating between two samples averages them: so much of white noise is left over.
    smoothed = float(np.sqrt(np.mean(share**2 + (1.0 - share) ** 2)))
    means = force.mean(axis=1)
    # What still settles can be predicted: means are apart, and only neighbours are compared.
    steady_m, steady_n = position - position.mean(axis=1, keepdims=True), force - means[:, None]
    steps_n = np.diff(at_equal_positions(steady_m, steady_n), axis=0)
    # The difference of two cycles has twice the variance of one.
    noise_n = float(np.sqrt(np.mean(np.square(steps_n)) / 2)) / smoothed
    return noise_n, float(means[-1] - means[0])


def _repeats(cycles: NDArray[np.float64]) -> bool:
    """Whether samples (cycles, points) are the same in every cycle, apart from their means."""
    shapes = cycles - cycles.mean(axis=1, keepdims=True)
    off = shapes - shapes.mean(axis=0)
    return float(np.sqrt(np.mean(off**2))) < SAME_PRESS * float(np.ptp(shapes))


def at_equal_positions(
    position_m: NDArray[np.float64], force_n: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Forces of repeats, (repeats, samples), N, moved to the repeats' mean position.

    A press that is driven by force repeats its force, and differs in position where the object
    does: each force moves along the press's own stiffness there. (A line through the differences
    would not do: it takes a softer object for one that was pressed deeper.)
    """
    mean_m = position_m.mean(axis=0)
    if not np.ptp(mean_m):
        return force_n
    # `full`: few distinct positions are no reason to warn
    curve, _ = np.polynomial.Polynomial.fit(mean_m, force_n.mean(axis=0), _CURVE, full=True)
    moved: NDArray[np.float64] = force_n - curve.deriv()(mean_m) * (position_m - mean_m)
    return moved
