"""Checks of the motion: strokes and their speeds."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.recording import Recording

_STROKE = 0.1  # of the travel: smaller strokes are noise, or nothing to learn from
_MAX_SAMPLES = 20_000
_SAME_SPEED = 1.3
_PARTS, _HOLDS = 40, 5.0  # of a way; times as long as usual


def find_strokes(recording: Recording) -> list[tuple[int, int, float]]:
    """First and last sample of each stroke between turning points, and its mean speed, m/s.

    Rests are no strokes; the ends of a stroke, where it may hold, are not in its speed, nor are
    holds on its way.
    """
    step = max(1, len(recording.position_m) // _MAX_SAMPLES)
    position_m = recording.position_m[::step]
    min_m = _STROKE * float(np.ptp(position_m))
    if min_m == 0.0:
        return []
    found = []
    for begin, end in pairwise(turning_points(position_m, min_m)):
        part = position_m[begin : end + 1]
        begin_m, way_m = float(part[0]), float(part[-1] - part[0])
        low_m, high_m = sorted((begin_m + 0.1 * way_m, begin_m + 0.9 * way_m))
        speed_mps = (high_m - low_m) / (_moving(part, low_m, high_m) * step * recording.dt_s)
        found.append((begin * step, end * step, speed_mps))
    return found


def _moving(position_m: Samples, low_m: float, high_m: float) -> float:
    """Samples that a way takes, but for those by which it stays longer in a part than usual."""
    samples, _ = np.histogram(position_m, _PARTS, (low_m, high_m))
    usual = float(np.median(samples))
    if usual > 0.0:
        samples = np.where(samples > _HOLDS * usual, usual, samples)
    return max(float(samples.sum()), 1.0)


def turning_points(position_m: Samples, min_m: float) -> list[int]:
    """Indices at which the motion turns round by at least `min_m`, with both ends."""
    turns, best, rising = [0], 0, None
    for k, value in enumerate(position_m.tolist()):
        if rising is None:
            if abs(value - position_m[0]) >= min_m:
                rising, best = value > position_m[0], k
        elif (value > position_m[best]) == rising and value != position_m[best]:
            best = k
        elif abs(value - position_m[best]) >= min_m:
            turns.append(best)
            rising, best = not rising, k
    return [*turns, best] if rising is not None else []


def distinct_speeds(recordings: Sequence[Recording]) -> list[float]:
    """Speeds of all strokes, m/s, those within 30 % of each other counted once."""
    speeds: list[float] = []
    for speed in sorted(speed for r in recordings for _, _, speed in find_strokes(r) if speed > 0):
        if not speeds or speed > _SAME_SPEED * speeds[-1]:
            speeds.append(speed)
    return speeds


def speed_findings(recordings: Sequence[Recording]) -> Iterator[Finding]:
    """Yield a finding where all strokes have one speed."""
    speeds = distinct_speeds(recordings)
    if len(speeds) == 1:
        yield warning(
            "speeds", where_of(recordings),
            f"one speed of pressing only, {speeds[0] * 1e3:.3g} mm/s",
            "rate dependence cannot be learned from one",
            "record at three speeds or more, a factor of 10 apart",
        )  # fmt: skip


def where_of(recordings: Sequence[Recording]) -> str:
    """Name the one recording, or say how many there are, in a finding."""
    return recordings[0].name if len(recordings) == 1 else f"{len(recordings)} recordings"
