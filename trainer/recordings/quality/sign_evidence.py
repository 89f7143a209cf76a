"""Evidence of a recording's signs: where force is large, where it is stiff, what loops cost."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples

_END = 0.05  # of the travel: the force at an end is the median there
_LEVEL = 0.05  # of the travel: at the greatest force all along
_MIN_SAMPLES = 8  # of a slope
_ONE_SIDED = 0.05  # of the larger end's force: a smaller one of the other sign is noise
_NOTHING = 0.05  # of the greatest force
_FIRST = 5  # samples, while the tool has not gone farther than
_SET_OFF = 0.01  # of the travel
_CLEAR, _STRONG = 1.25, 2.0  # ratio of the ends: some evidence, and twice as much
_NOISES = 3.0  # standard deviations
_RESTS, _GOES_ON = 0.01, 0.1  # of the ranges of position and of force
_DELAY = 0.5  # of a sample: channels that are read one after the other
_LEVELS = (0.3, 0.5, 0.7)  # of the travel: where loops may be cut


def correlation(x: Samples, f: Samples) -> float:
    """Correlation of position and force, (n,) both; 0 if one is constant."""
    if min(np.ptp(x), np.ptp(f)) == 0.0:
        return 0.0
    return float(np.corrcoef(x, f)[0, 1])


def deeper_by_force(x: Samples, f: Samples) -> int:
    """Vote for the end of larger force: 2 or 1 the upper one, 0 unknown, negative the lower one."""
    width = _END * float(np.ptp(x))
    low = abs(float(np.median(f[x <= x.min() + width])))
    high = abs(float(np.median(f[x >= x.max() - width])))
    least, most = float(f.min()), float(f.max())
    if min(abs(least), abs(most)) > _ONE_SIDED * max(abs(least), abs(most)) and least * most < 0:
        return 0
    return _vote(high, low)


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
    """Force where a recording begins: the median of the first samples, before the tool sets off.

    A slow logger has one of them.

    >>> first_n(np.linspace(0.0, 8e-3, 21), np.linspace(0.1, 20.0, 21))
    0.1
    """
    gone = np.abs(x[:_FIRST] - x[0]) > _SET_OFF * float(np.ptp(x))
    return float(np.median(f[: int(np.argmax(gone)) if gone.any() else _FIRST]))


def begins_at_no_force(x: Samples, f: Samples) -> bool:
    """Whether force is next to nothing at the lower end, as it is where a tool touches nothing."""
    low = x <= float(x.min()) + _END * float(np.ptp(x))
    return abs(float(np.median(f[low]))) < _NOTHING * float(f.max())


def deeper_by_slope(x: Samples, f: Samples) -> int:
    """Vote for the stiffer third of the travel, as in `deeper_by_force`.

    A level that a sensor's limit or free air makes is no slope of the object.
    """
    level = f == f.max()
    if np.ptp(x[level]) > _LEVEL * np.ptp(x):
        x, f = x[~level], f[~level]
    if not len(x):
        return 0
    low_m, third_m = float(x.min()), float(np.ptp(x)) / 3
    low = _slope(x, f, x <= low_m + third_m)
    high = _slope(x, f, x >= low_m + 2 * third_m)
    if low is None or high is None or max(abs(low), abs(high)) == 0.0:
        return 0
    return _vote(abs(high), abs(low))


def looks_exchanged(x: Samples, f: Samples) -> bool:
    """Whether position rests at its lowest while force falls and rises again, or the other way.

    In the air it is force that rests, and position that goes out and in again. An object that is
    held relaxes one way.
    """
    near = x <= float(x.min()) + max(_RESTS * float(np.ptp(x)), 2.0 * _NOISES * noise_n(x))
    edges = np.diff(np.concatenate(([0], near, [0])).astype(int))
    for begin, end in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
        ends_n = f[begin], f[end - 1]
        beyond_n = max(
            float(f[begin:end].max() - max(ends_n)), float(min(ends_n) - f[begin:end].min())
        )
        if beyond_n > _GOES_ON * float(np.ptp(f)):
            return True
    return False


def _vote(high: float, low: float) -> int:
    larger, smaller = max(high, low), min(high, low)
    size = 2 if larger > _STRONG * smaller else 1 if larger > _CLEAR * smaller else 0
    return size if high > low else -size


def _slope(x: Samples, f: Samples, part: NDArray[np.bool_]) -> float | None:
    off = x[part] - x[part].mean()
    spread = float(off @ off)
    if len(off) < _MIN_SAMPLES or spread == 0.0:
        return None
    return float(off @ f[part]) / spread


@dataclass(frozen=True)
class Dissipation:
    """Energy that a tool put in over whole loops, and how many; 0 where none closes.

    doubt_j: what the force's noise, its drift and half a sample of delay may add or take.
    """

    energy_j: float = 0.0
    loops: int = 0
    doubt_j: float = 0.0


def dissipation(x: Samples, f: Samples) -> Dissipation:
    """Over as many loops as some level of the travel closes."""
    best = Dissipation()
    for level in _LEVELS:
        level_m = float(x.min()) + level * float(np.ptp(x))
        rises = np.flatnonzero((x[:-1] < level_m) & (x[1:] >= level_m))
        rises = (
            rises[np.concatenate(([True], np.diff(rises) > _MIN_SAMPLES))] if len(rises) else rises
        )
        if len(rises) - 1 > best.loops:
            best = _over(x, f, int(rises[0]), int(rises[-1]) + 1, len(rises) - 1)
    return best if best.loops else _one_press(x, f)


def _one_press(x: Samples, f: Samples) -> Dissipation:
    """Energy of the way in and out again, or out and in, beyond a level above both ends."""
    span, ends = float(np.ptp(x)), x[[0, -1]]
    inwards = float(ends.max()) + _END * span < float(x.min()) + 0.5 * span
    outwards = float(ends.min()) - _END * span > float(x.min()) + 0.5 * span
    if not (inwards or outwards):
        return Dissipation()
    level_m = ends.max() + _END * span if inwards else ends.min() - _END * span
    beyond = np.flatnonzero(x > level_m if inwards else x < level_m)
    return _over(x, f, int(beyond[0]) - 1, int(beyond[-1]) + 1, 1)


def _over(x: Samples, f: Samples, begin: int, end: int, loops: int) -> Dissipation:
    """Work along the path, force counted from its first value.

    So the small gap that is left at the end of a loop hardly matters. Drift g that grows evenly
    adds the integral of g t/T dx = g (x(T) - mean of x), where more than one loop shows it; a delay
    d adds d times the integral of x' f' dt; noise of deviation s in each sample adds s times the
    root of the summed squares of the way that a sample stands for.
    """
    x, f = x[begin : end + 1], f[begin : end + 1]
    steps, rises = np.diff(x), np.diff(f)
    means = 0.5 * (f[:-1] + f[1:])
    ways = 0.5 * np.append(steps, 0.0) + 0.5 * np.insert(steps, 0, 0.0)
    noise_j = _NOISES * noise_n(f) * float(np.sqrt(ways @ ways))
    drift_j = abs(float((f[-1] - f[0]) * (x[-1] - x.mean()))) if loops > 1 else 0.0
    delay_j = _DELAY * abs(float(steps @ rises))
    return Dissipation(float(steps @ (means - f[0])), loops, noise_j + drift_j + delay_j)


def noise_n(f: Samples) -> float:
    """Standard deviation of what differs from sample to sample, by the median of second steps."""
    second = np.diff(f, 2)
    return 1.4826 * float(np.median(np.abs(second))) / np.sqrt(6.0) if len(second) else 0.0
