"""How late force may be: by where it begins on the way in, and ends on the way out.

An object that relaxes, or stays dented, lets go deeper than where it was met. Force that ends
farther out, at one level, is late: by at least the way between, over both speeds. And from the
surface on force begins at once: it is at most as late as it passes the level.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Samples, runs
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import sensor_noise_n


@dataclass(frozen=True)
class LatenessRule:
    """When force is late. Of 450 right files none was, 24 of 30 that are 20 to 60 ms late were.

    level_fraction: of the range of force, noise_sigmas: of its noise: the level; noise alone
    crosses lower ones. Half of it loses three of those 24, twice adds none.
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


_RULE = LatenessRule()
_SURFACE_KEY = "contact_position_m"  # a surface that was found by the force says nothing of it


def measure_lateness(recording: Recording) -> tuple[float, float | None]:
    """Return how late force is at least, s, 0 if it may be in time, and at most; None: unknown."""
    x, f, dt_s = recording.position_m, recording.force_n, recording.dt_s
    range_n = float(np.ptp(f))
    air_n = float(np.median(f[x <= x.min() + _RULE.air_fraction * np.ptp(x)]))
    level_n = air_n + max(_RULE.noise_sigmas * sensor_noise_n(f), _RULE.level_fraction * range_n)
    late_s, onsets_s = list[float](), list[float]()
    surface_rows = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    for begin, end in runs(f > level_n):
        if (
            begin < 2
            or end > len(f) - 3
            or f[begin:end].max() < air_n + _RULE.peak_fraction * range_n
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
    least_s = float(np.quantile(late_s, _RULE.quantile)) if len(late_s) >= _RULE.visits else 0.0
    known = len(onsets_s) >= _RULE.visits and min(onsets_s) > 0.0
    most_s = min(onsets_s) + _RULE.samples * dt_s if known else None
    return least_s if least_s > _RULE.samples * dt_s else 0.0, most_s


def _cross(
    x: Samples, f: Samples, row: int, level_n: float, dt_s: float
) -> tuple[float, float, float]:
    """Return the row, with its fraction, before which force passes a level, position and speed."""
    share = (level_n - f[row - 1]) / (f[row] - f[row - 1])
    position_m = float(x[row - 1] + share * (x[row] - x[row - 1]))
    return row - 1 + float(share), position_m, float(x[row + 1] - x[row - 2]) / (3.0 * dt_s)


def lateness_findings(recordings: Sequence[Recording]) -> Iterator[Finding]:
    """Yield a finding where force of most recordings ends outside of where it began."""
    least_s = [measure_lateness(recording)[0] for recording in recordings]
    late_s = [seconds for seconds in least_s if seconds > 0.0]
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
    """Words on how late force may be, where the surface shows it; else empty."""
    most_s = [most for each in recordings if (most := measure_lateness(each)[1]) is not None]
    return f"; force is at most {1e3 * min(most_s):.2g} ms late" if most_s else ""
