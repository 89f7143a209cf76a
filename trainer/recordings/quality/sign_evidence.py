"""Evidence of a recording's signs: where force is large, where it is stiff, what loops cost."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.sensor import noise_n

_END = 0.05  # of the travel: an end, where the median is taken
MIN_SAMPLES = 8  # of a slope
_NOTHING = 0.05  # of the greatest force
_FIRST, _SET_OFF = 5, 0.01  # samples, while the tool has not gone farther, of the travel
_CLEAR, _STRONG = 1.25, 2.0  # ratio of the ends: some evidence, and twice as much
_NOISES, _SURE = 3.0, 10.0  # standard deviations
_DELAY = 0.5  # of a sample: channels that are read one after the other
_LEVELS = (0.3, 0.5, 0.7)  # of the travel: where loops may be cut
_FALLEN, _SLOWER = 0.4, 3.0  # of the greatest force; times as long for the same way


def failure_row(x: Samples, f: Samples) -> int | None:
    """Row of the greatest force, if the object tears or yields beyond it; None if it does not.

    There force is less than 0.4 of it, in a twentieth of the way that the tool goes through as
    fast as before: an object that flows loses its force where the tool slows down.
    """
    rise, peak = np.abs(f - first_n(x, f)), peak_row(x, f)
    if x[peak] == x[0] or rise[peak] < _SURE * noise_n(f):
        return None
    way = np.sign(x[peak] - x[0]) * x
    farthest = np.maximum.accumulate(way)
    rows = np.searchsorted(farthest, np.arange(way[0], farthest[-1], _END * float(np.ptp(x))))
    before = np.diff(rows[rows <= peak])
    usual = float(np.median(before)) if len(before) else 0.0
    for begin, end in pairwise(rows[rows > peak].tolist()):
        fallen = float(np.median(rise[begin : end + 1])) < _FALLEN * float(rise[peak])
        if fallen and end - begin <= _SLOWER * usual:
            return peak
    return None


def correlation(x: Samples, f: Samples) -> float:
    """Correlation of position and force, (n,) both; 0 if one is constant."""
    return float(np.corrcoef(x, f)[0, 1]) if min(np.ptp(x), np.ptp(f)) else 0.0


def peak_row(x: Samples, f: Samples) -> int:
    """Row at which force is farthest from that with which the recording begins."""
    return int(np.argmax(np.abs(f - first_n(x, f))))


def deeper_by_force(x: Samples, f: Samples) -> int:
    """Vote for the end of larger force: 2 or 1 the upper one, 0 unknown, negative the lower one."""
    width = _END * float(np.ptp(x))
    low = abs(float(np.median(f[x <= x.min() + width])))
    high = abs(float(np.median(f[x >= x.max() - width])))
    less, more = sorted((abs(float(f.min())), abs(float(f.max()))))
    two_sided = f.min() < 0.0 < f.max() and less > _NOTHING * more
    return 0 if two_sided else _vote(high, low)


def deeper_from_zero(x: Samples, f: Samples) -> int:
    """Vote, as in `deeper_by_force`, of what begins at position 0 and force 0 and has no free end.

    An object that is bonded to the tool pulls on the way back: position and force go to one side,
    and the greatest force is that of the farthest position.
    """
    span = float(np.ptp(x))
    side = 1 if x.max() > -x.min() else -1
    away, force = side * x, side * f
    far_n = float(np.median(force[away >= away.max() - _END * span]))
    begins = abs(float(x[0])) <= _END * span and abs(first_n(x, force)) < _NOTHING * far_n
    alone = away.min() >= -_END * span and far_n > -float(force.min())
    return 2 * side if begins and alone else 0


def first_n(x: Samples, f: Samples) -> float:
    """Force where a recording begins: the median of the samples before the tool sets off."""
    gone = np.abs(x[:_FIRST] - x[0]) > _SET_OFF * float(np.ptp(x))
    return float(np.median(f[: int(np.argmax(gone)) if gone.any() else _FIRST]))


def deeper_by_slope(x: Samples, f: Samples) -> int:
    """Vote for the stiffer third of the travel, as in `deeper_by_force`.

    A level that a sensor's limit or free air makes is no slope of the object.
    """
    level = f == f.max()
    if np.ptp(x[level]) > _END * np.ptp(x):
        x, f = x[~level], f[~level]
    if not len(x):
        return 0
    low_m, third_m = float(x.min()), float(np.ptp(x)) / 3
    low = _slope(x, f, x <= low_m + third_m)
    high = _slope(x, f, x >= low_m + 2 * third_m)
    if low is None or high is None or max(abs(low), abs(high)) == 0.0:
        return 0
    return _vote(abs(high), abs(low))


def _vote(high: float, low: float) -> int:
    larger, smaller = max(high, low), min(high, low)
    size = 2 if larger > _STRONG * smaller else 1 if larger > _CLEAR * smaller else 0
    return size if high > low else -size


def _slope(x: Samples, f: Samples, part: NDArray[np.bool_]) -> float | None:
    off = x[part] - x[part].mean()
    spread = float(off @ off)
    if len(off) < MIN_SAMPLES or spread == 0.0:
        return None
    return float(off @ f[part]) / spread


@dataclass(frozen=True)
class Dissipation:
    """Energy that a tool put in over whole loops, and how many; 0 where none closes.

    energy: that of a loop, over travel and range of force. doubt: what the force's noise, its drift
    and half a sample of delay may add to that or take.
    """

    energy_j: float = 0.0
    loops: int = 0
    energy: float = 0.0
    doubt: float = 0.0


def dissipation(x: Samples, f: Samples) -> Dissipation:
    """Over as many loops as some level of the travel closes, or over one press."""
    low_m, span, best = float(x.min()), float(np.ptp(x)), np.empty(0, dtype=np.intp)
    for level_m in (low_m + level * span for level in _LEVELS):
        rises = np.flatnonzero((x[:-1] < level_m) & (x[1:] >= level_m))
        rises = rises[np.diff(rises, prepend=-len(x)) > MIN_SAMPLES]
        best = rises if len(rises) > max(len(best), 1) else best
    if len(best):
        return _work(x, f, int(best[0]), int(best[-1]) + 1, len(best) - 1)
    ends, middle_m = x[[0, -1]], low_m + 0.5 * span
    if float(ends.max()) + _END * span < middle_m:  # in and out again
        beyond = np.flatnonzero(x > ends.max() + _END * span)
    elif float(ends.min()) - _END * span > middle_m:  # out and in again
        beyond = np.flatnonzero(x < ends.min() - _END * span)
    else:
        return Dissipation()
    return _work(x, f, int(beyond[0]) - 1, int(beyond[-1]) + 1, 1)


def _work(x: Samples, f: Samples, begin: int, end: int, loops: int) -> Dissipation:
    """Work along the path, force counted from its first value.

    Drift g that grows evenly adds the integral of g t/T dx = g (x(T) - mean of x), where more than
    one loop shows it; a delay d adds d times the integral of x' f' dt; noise of deviation s in each
    sample adds s times the root of the summed squares of the way that a sample stands for.
    """
    size_j = loops * float(np.ptp(x)) * float(np.ptp(f))
    x, f = x[begin : end + 1], f[begin : end + 1]
    steps = np.diff(x)
    energy_j = float(steps @ (0.5 * (f[:-1] + f[1:]) - f[0]))
    ways = 0.5 * (np.append(steps, 0.0) + np.insert(steps, 0, 0.0))
    noise_j = _NOISES * noise_n(f) * float(np.sqrt(ways @ ways))
    drift_j = abs(float((f[-1] - f[0]) * (x[-1] - x.mean()))) if loops > 1 else 0.0
    delay_j = _DELAY * abs(float(steps @ np.diff(f)))
    share = 1.0 / size_j if size_j else 0.0
    doubt = share * (noise_j + drift_j + delay_j)
    return Dissipation(energy_j, loops, share * energy_j, doubt)
