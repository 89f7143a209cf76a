"""Find force that was zeroed while the tool pressed: in the air it is level below 0.

Most rigs tare where a test begins, on a preload. Where the tool leaves the object later, force is
what was taken off, with its sign turned round.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.quality.motion import where_of
from springpot.trainer.recordings.quality.sign_evidence import noise_n
from springpot.trainer.recordings.recording import Recording

_BELOW, _NOISES = 0.03, 8.0  # of the peak force and of the noise: below 0 by as much
_BAND, _BAND_NOISES = 0.01, 4.0  # of the range of force, and of its noise: one level
_TRAVEL, _SAMPLES = 0.02, 0.01  # that level runs have, of all
_WAY_IN = 0.005  # of the travel, at that level
_ALIKE = 1.0  # of the noise: means at the ends and in the middle
_ENDS = 3.0  # of the noise in the middle: farther off, an end is not level
_FEWEST = 9  # samples of a run


@dataclass(frozen=True)
class AirLevel:
    """Force without contact, N, and the positions between which it is level, m."""

    force_n: float
    low_m: float
    high_m: float


def find_air_level(recording: Recording) -> AirLevel | None:
    """Return the level below 0 at which force stays on the way out and in again; None without one.

    Where an object holds the tool, force changes with the way; a damper and friction pull on the
    way out and push on the way in; one value without noise is the limit of a sensor.
    """
    position_m, force_n = recording.position_m, recording.force_n
    noise, travel_m = noise_n(force_n), float(np.ptp(position_m))
    below_n = np.sort(force_n[force_n < -max(_BELOW * float(force_n.max()), _NOISES * noise)])
    if len(below_n) < max(_FEWEST, _SAMPLES * len(force_n)) or force_n.max() <= 0.0:
        return None
    band_n = max(_BAND * float(np.ptp(force_n)), _BAND_NOISES * noise)
    within = np.searchsorted(below_n, below_n + band_n, "right") - np.arange(len(below_n))
    densest = int(np.argmax(within))  # what is level has most samples
    level_n = float(np.median(below_n[densest : densest + int(within[densest])]))
    edges = np.diff(np.concatenate(([0], np.abs(force_n - level_n) <= band_n, [0])).astype(int))
    runs = [
        run
        for begin, end in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True)
        if (run := _level_run(position_m, force_n, int(begin), int(end))) is not None
    ]
    if not runs or sum(end - begin for begin, end in runs) < _SAMPLES * len(force_n):
        return None
    rows = np.concatenate([np.arange(begin, end) for begin, end in runs])
    places_m, forces_n = position_m[rows], force_n[rows]
    if np.ptp(places_m) < _TRAVEL * travel_m:
        return None
    level_n = float(np.median(forces_n))
    return AirLevel(level_n, float(places_m.min()), float(places_m.max()))


def zeroed_findings(found: Sequence[tuple[Recording, AirLevel]], count: int) -> Iterator[Finding]:
    """Yield a finding for each level: one for all recordings, of `count`, that have the same."""
    left, others = list(found), ", and the others too if they were zeroed there"
    while left:
        recording, air = left[0]
        near_n = _BAND * float(recording.force_n.max())
        same = [item for item in left if abs(item[1].force_n - air.force_n) <= near_n]
        left = [item for item in left if item not in same]
        level = f"{np.median([each.force_n for _, each in same]):.3g}"
        low_mm, high_mm = (
            f"{1e3 * outermost:.3g}"
            for outermost in (min(a.low_m for _, a in same), max(a.high_m for _, a in same))
        )
        yield warning(
            "tare", where_of([each for each, _ in same]),
            f"force is level at {level} N, out and in again, from {low_mm} to {high_mm} mm",
            "the tool is off the object there, and force was zeroed under load, or not at all: the "
            "model would pull",
            f"import with --tare={level}" + ("" if len(same) == count else others),
        )  # fmt: skip


def _level_run(
    position_m: Samples, force_n: Samples, begin: int, end: int
) -> tuple[int, int] | None:
    """Trim a run to where force is level within its noise; None where it is not, or goes out only.

    Trimmed are the ends, which rise or fall from the level already. On the way in, what brakes the
    tool or gives way pushes beyond the noise soon.
    """
    if end - begin < _FEWEST:
        return None
    third = (end - begin) // 3
    middle = force_n[begin + third : end - third]
    level_n, noise = float(np.median(middle)), max(noise_n(middle), float(np.std(middle)))
    off = np.abs(force_n[begin:end] - level_n) > _ENDS * noise
    near = np.flatnonzero(~off)
    if np.ptp(middle) == 0.0 or not len(near):
        return None
    begin, end = begin + int(near[0]), begin + int(near[-1]) + 1
    third = (end - begin) // 3
    lowest = begin + int(np.argmin(position_m[begin:end]))
    way_in = float(position_m[lowest:end].max() - position_m[lowest]) / float(np.ptp(position_m))
    if third < _FEWEST // 3 or way_in < max(_WAY_IN, 2.0 * _ENDS * noise / float(np.ptp(force_n))):
        return None
    bounds = [begin, begin + third, end - third, end]
    means_n = [float(np.mean(force_n[a:b])) for a, b in pairwise(bounds)]
    return (begin, end) if float(np.ptp(means_n)) <= _ALIKE * noise else None
