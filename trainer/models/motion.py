"""Recordings of one session as one motion: what the object remembers goes on through the pauses."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.recording import Recording

_LONGEST_PAUSE_S = 600.0
_LATE = 5  # samples by which clocks of two recordings may overlap


@dataclass(frozen=True, eq=False)
class DepthMotion:
    """Depths of recordings one after another, (n,), m; between two of them the object rests.

    recordings: their numbers in the set; starts: the first sample of each. pauses: sample and
    seconds: so long before this sample the tool stood where it stands in it and in the one before.
    """

    depth_m: Samples
    recordings: tuple[int, ...]
    starts: tuple[int, ...]
    pauses: tuple[tuple[int, float], ...] = ()


def motions(
    recordings: Sequence[Recording], depths_m: Sequence[Samples], surface: bool
) -> tuple[DepthMotion, ...]:
    """Join recordings of one session and place by their times; others are one each.

    In a pause the tool stands above the surface; if the object has none, at the lower of the depths
    at the ends of the pause.
    """
    sessions: dict[Hashable, list[int]] = {}
    for number, recording in enumerate(recordings):
        alone = recording.start_s is None or not recording.session
        key = number if alone else (recording.session, recording.place_m)
        sessions.setdefault(key, []).append(number)
    found = []
    for numbers in sessions.values():
        numbers.sort(key=lambda number: recordings[number].start_s or 0.0)
        whole = [numbers] if _follow(numbers, recordings) else [[number] for number in numbers]
        found += [_joined(part, recordings, depths_m, surface) for part in whole]
    return tuple(found)


def _follow(numbers: Sequence[int], recordings: Sequence[Recording]) -> bool:
    """Whether each begins after the one before has ended, to within a few samples."""
    ends_s = -inf
    for number in numbers:
        recording = recordings[number]
        if (recording.start_s or 0.0) < ends_s - _LATE * recording.dt_s:
            return False
        ends_s = (recording.start_s or 0.0) + recording.duration_s
    return True


def _joined(
    numbers: Sequence[int],
    recordings: Sequence[Recording],
    depths_m: Sequence[Samples],
    surface: bool,
) -> DepthMotion:
    parts: list[Samples] = []
    starts, pauses, length, ends_s = [], [], 0, 0.0
    for number in numbers:
        recording, depth_m = recordings[number], depths_m[number]
        start_s = recording.start_s or 0.0
        if parts:
            low_m = 0.0 if surface else min(parts[-1][-1], depth_m[0])
            parts.append(np.full(2, low_m))
            pauses.append((length + 1, max(start_s - ends_s, 0.0)))
            length += 2
        starts.append(length)
        parts.append(depth_m)
        length += len(depth_m)
        ends_s = start_s + recording.duration_s
    return DepthMotion(np.concatenate(parts), tuple(numbers), tuple(starts), tuple(pauses))


def in_ticks(motion: DepthMotion, dt_s: float) -> DepthMotion:
    """The same with each pause as ticks at rest, ten minutes of them at most: for C."""
    parts, starts, begin = [], np.array(motion.starts), 0
    for sample, seconds in motion.pauses:
        count = round(min(seconds, _LONGEST_PAUSE_S) / dt_s)
        parts += [motion.depth_m[begin:sample], np.full(count, motion.depth_m[sample])]
        starts += count * (np.array(motion.starts) > sample)
        begin = sample
    parts.append(motion.depth_m[begin:])
    return replace(motion, depth_m=np.concatenate(parts), starts=tuple(starts.tolist()), pauses=())
