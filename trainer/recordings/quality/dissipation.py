"""Energy that a tool puts into an object over whole loops: none gives any."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.quality.finding import format_si
from springpot.trainer.recordings.signals import sensor_noise_n

MIN_SAMPLES = 8  # of a slope, and of a loop
END_FRACTION = 0.05  # of the travel: an end, where medians are taken
_NOISE_SIGMAS = 3.0  # standard deviations
_DELAY_SAMPLES = 0.5  # of a sample: channels that are read one after the other
_CUT_LEVELS = (0.3, 0.5, 0.7)  # of the travel: where loops may be cut


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

    @property
    def words(self) -> str:
        """How often the loop turns, which way, and how much that takes."""
        if not self.loops:
            return "no closed loop shows its loss"
        turn = "clockwise, dissipating" if self.energy_j >= 0 else "anticlockwise, giving"
        count = "the loop turns" if self.loops == 1 else f"{self.loops} loops turn"
        return f"{count} {turn} {format_si(abs(self.energy_j), 'J')}"


def measure_dissipation(x: Samples, f: Samples) -> Dissipation:
    """Over as many loops as some level of the travel closes, or over one press."""
    low_m, span, crossings = float(x.min()), float(np.ptp(x)), np.empty(0, dtype=np.intp)
    for level_m in (low_m + level * span for level in _CUT_LEVELS):
        rises = np.flatnonzero((x[:-1] < level_m) & (x[1:] >= level_m))
        rises = rises[np.diff(rises, prepend=-len(x)) > MIN_SAMPLES]
        crossings = rises if len(rises) > max(len(crossings), 1) else crossings
    if len(crossings):
        return _integrate_loops(x, f, int(crossings[0]), int(crossings[-1]) + 1, len(crossings) - 1)
    ends, middle_m = x[[0, -1]], low_m + 0.5 * span
    if float(ends.max()) + END_FRACTION * span < middle_m:  # in and out again
        outside_rows = np.flatnonzero(x > ends.max() + END_FRACTION * span)
    elif float(ends.min()) - END_FRACTION * span > middle_m:  # out and in again
        outside_rows = np.flatnonzero(x < ends.min() - END_FRACTION * span)
    else:
        return Dissipation()
    return _integrate_loops(x, f, int(outside_rows[0]) - 1, int(outside_rows[-1]) + 1, 1)


def _integrate_loops(x: Samples, f: Samples, begin: int, end: int, loops: int) -> Dissipation:
    """Work along the path, force counted from its first value.

    Drift g that grows evenly adds the integral of g t/T dx = g (x(T) - mean of x), where more than
    one loop shows it; a delay d adds d times the integral of x' f' dt; noise of deviation s in each
    sample adds s times the root of the summed squares of the way that a sample stands for.
    """
    size_j = loops * float(np.ptp(x)) * float(np.ptp(f))
    x, f = x[begin : end + 1], f[begin : end + 1]
    steps = np.diff(x)
    energy_j = float(steps @ (0.5 * (f[:-1] + f[1:]) - f[0]))
    weights_m = 0.5 * (np.append(steps, 0.0) + np.insert(steps, 0, 0.0))
    noise_j = _NOISE_SIGMAS * sensor_noise_n(f) * float(np.sqrt(weights_m @ weights_m))
    drift_j = abs(float((f[-1] - f[0]) * (x[-1] - x.mean()))) if loops > 1 else 0.0
    delay_j = _DELAY_SAMPLES * abs(float(steps @ np.diff(f)))
    per_loop = 1.0 / size_j if size_j else 0.0
    uncertainty = per_loop * (noise_j + drift_j + delay_j)
    return Dissipation(energy_j, loops, per_loop * energy_j, uncertainty)
