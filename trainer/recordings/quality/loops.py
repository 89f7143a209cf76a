"""Loops of force over position: the energy that goes in, and how late force may be.

No object gives energy over whole loops. One that relaxes, or stays dented, lets go deeper than
where it was met: force that ends farther out, at one level, is late, by at least the way between
over both speeds. And it is at most as late as it passes the level behind the surface.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Samples, runs
from springpot.trainer.recordings.quality.finding import Finding, format_si, warning
from springpot.trainer.recordings.recording import Recording
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
        """Say how often the loop turns, which way, and how much energy that takes."""
        if not self.loops:
            return "no closed loop shows its loss"
        turn = "clockwise, dissipating" if self.energy_j >= 0 else "anticlockwise, giving"
        count = "the loop turns" if self.loops == 1 else f"{self.loops} loops turn"
        return f"{count} {turn} {format_si(abs(self.energy_j), 'J')}"


def measure_dissipation(x: Samples, f: Samples) -> Dissipation:
    """Return the energy that the object takes in whole loops: a negative one shows a wrong sign.

    Loops are cut at the level of the travel that gives most of them; without any, a single press is
    integrated.
    """
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
    """Integrate the work along the path, with force counted from its first value.

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


@dataclass(frozen=True)
class LatenessRule:
    """When force is late. Of 450 right files none was; of 17 that are 34 to 55 ms late 12 were.

    level_fraction: of the range of force, noise_sigmas: of its noise: the level; noise alone
    crosses lower ones.
    air_fraction: of the travel: lowest positions, where force is that without contact.
    peak_fraction: of the range: visits that push less are noise. visits: fewer show chance.
    quantile: of the visits, that is beyond half a sample: channels are read one after the other.
    """

    level_fraction: float = 0.01
    noise_sigmas: float = 6.0
    air_fraction: float = 0.05
    peak_fraction: float = 0.3
    visits: int = 2
    quantile: float = 0.25
    samples: float = 0.5


_LATENESS = LatenessRule()
_SURFACE_KEY = "contact_position_m"  # a surface that was found by the force says nothing of it


def measure_lateness(recording: Recording) -> tuple[float, float | None]:
    """Return how late force is at least, s, 0 if it may be in time, and at most; None: unknown."""
    rule, x, f, dt_s = _LATENESS, recording.position_m, recording.force_n, recording.dt_s
    range_n = float(np.ptp(f))
    air_n = float(np.median(f[x <= x.min() + rule.air_fraction * np.ptp(x)]))
    level_n = air_n + max(rule.noise_sigmas * sensor_noise_n(f), rule.level_fraction * range_n)
    late_s, onsets_s = list[float](), list[float]()
    surface_rows = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    for begin, end in runs(f > level_n):
        if (
            begin < 2
            or end > len(f) - 3
            or f[begin:end].max() < air_n + rule.peak_fraction * range_n
        ):
            continue
        (in_row, in_m, in_mps), (_, out_m, out_mps) = (
            _cross(x, f, row, level_n, dt_s) for row in (begin, end)
        )
        if in_mps > 0.0 > out_mps:
            late_s.append((in_m - out_m) / (in_mps - out_mps))
        before = surface_rows[surface_rows < begin]
        if len(before) and recording.zero == "none" and _SURFACE_KEY not in recording.details:
            row = before[-1]
            onsets_s.append(dt_s * (in_row - row + x[row] / (x[row + 1] - x[row])))
    min_delay_s = float(np.quantile(late_s, rule.quantile)) if len(late_s) >= rule.visits else 0.0
    known = len(onsets_s) >= rule.visits and min(onsets_s) > 0.0
    max_delay_s = min(onsets_s) + rule.samples * dt_s if known else None
    return min_delay_s if min_delay_s > rule.samples * dt_s else 0.0, max_delay_s


def _cross(
    x: Samples, f: Samples, row: int, level_n: float, dt_s: float
) -> tuple[float, float, float]:
    """Return the row, with its fraction, before which force passes a level, position and speed."""
    share = (level_n - f[row - 1]) / (f[row] - f[row - 1])
    position_m = float(x[row - 1] + share * (x[row] - x[row - 1]))
    return row - 1 + float(share), position_m, float(x[row + 1] - x[row - 2]) / (3.0 * dt_s)


def lateness_findings(recordings: Sequence[Recording]) -> Iterator[Finding]:
    """Yield a finding where force of most recordings ends outside of where it began."""
    min_delays_s = [measure_lateness(recording)[0] for recording in recordings]
    late_s = [delay_s for delay_s in min_delays_s if delay_s > 0.0]
    if 2 * len(late_s) > len(recordings):
        where = recordings[0].name if len(recordings) == 1 else f"{len(late_s)} recordings"
        yield warning(
            "alignment", where,
            "force ends farther out than it begins, as no object lets it: it comes at least "
            f"{1e3 * float(np.median(late_s)):.2g} ms after position",
            "loss, and with it stability, would be learned wrong",
            "find how late the sensor is, and import with --force-delay-s SECONDS --align",
        )  # fmt: skip


def format_lateness(recordings: Sequence[Recording]) -> str:
    """Say how late force may be, where the surface shows it; else nothing."""
    bounds_s = [measure_lateness(recording)[1] for recording in recordings]
    max_delays_s = [bound_s for bound_s in bounds_s if bound_s is not None]
    return f"; force is at most {1e3 * min(max_delays_s):.2g} ms late" if max_delays_s else ""
