"""Depths of recordings as the object met them: from its surface on, one session one motion."""

from collections.abc import Hashable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.model.model import Contact
from springpot.trainer.recordings.contact_point import find_contact
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import (
    came_before,
    sensor_noise_n,
    smoothed,
    smoothing_samples,
)

_LOWEST = 0.02  # of the depth: where an object's force is 0 if position 0 is its surface
_REST_SHARE = 0.02  # of the peak force
_PULL, _OFTEN = 0.05, 0.01  # of the peak force, in a share of the samples: it holds the tool
_HUM_S, _DEVIATIONS = 0.02, 4.0  # a period of the mains, over which a force is averaged; of noise
_LONGEST_PAUSE_S = 600.0
_LATE = 5  # samples by which clocks of two recordings may overlap


def contact_of(recordings: Sequence[Recording]) -> tuple[Contact, str]:
    """Return "surface" where force is 0 at position 0, "always" where the tool never leaves.

    And why there is no surface, unless a person stated it. The tool never leaves if an importer
    moved the zero, or if force at the lowest depth is 2 % of the peak or more and no recording
    shows where contact begins. (One that does has a tare: the object does not push with it.)
    Nor does it leave what holds it: `pulls`.
    """
    moved = [recording.name for recording in recordings if recording.zero != "none"]
    if moved and len(moved) != len(recordings):
        without = next(recording.name for recording in recordings if recording.zero == "none")
        raise DataError(
            f"{moved[0]} was imported with --zero and {without} without: import all the same way"
        )
    if moved:
        return "always", ""
    peak_n = max(float(recording.force_n.max()) for recording in recordings)
    if peak_n > 0.0 and pulls(recordings):
        min_n = min(float(each.force_n.min()) for each in recordings)
        return "always", (
            f"force goes to {min_n:.3g} N inside the object: it holds the tool, and the model "
            "pulls as it does; if nothing held it, look for drift or delay of the force"
        )
    rest_n = rest_force_n(recordings)
    if abs(rest_n) < _REST_SHARE * peak_n or peak_n <= 0.0:
        return "surface", ""
    for recording in recordings:
        with suppress(DataError):
            find_contact(recording)
            return "surface", ""
    if all("tare_n" in recording.details for recording in recordings):
        return "always", ""
    return "always", (
        f"force is {rest_n:.3g} N at the lowest positions, and no recording leaves the object: the "
        "model pushes there too, and has no surface; import with --tare=LOAD_N, that of a load or "
        "an offset of the sensor, or with --tare 0 if the object pushes so there"
    )


def pulls(recordings: Sequence[Recording]) -> bool:
    """Whether the object holds the tool: its force inside goes below that at rest, often.

    By 5 % of the peak in 1 % of the samples or more, and by more than noise: a glued specimen, or
    one that sticks. Each recording may have a tare of its own.
    """
    peak_n = max(float(recording.force_n.max()) for recording in recordings)
    pulled = samples = 0
    for recording in recordings:
        averaged = smoothing_samples(_HUM_S, recording.dt_s)
        quiet = smoothed(recording, _HUM_S) if averaged < len(recording.force_n) else recording
        noise_n = _DEVIATIONS * sensor_noise_n(recording.force_n) / np.sqrt(averaged)
        low_m = float(quiet.position_m.min()) + _LOWEST * float(np.ptp(quiet.position_m))
        limit_n = min(rest_force_n([quiet]), 0.0) - _PULL * peak_n - noise_n
        below = (quiet.position_m > low_m) & (quiet.force_n < limit_n)
        pulled += int(np.count_nonzero(below))
        samples += len(below)
    return pulled > _OFTEN * samples


def rest_force_n(recordings: Sequence[Recording]) -> float:
    """Median force at the lowest 2 % of the positions of all recordings, N."""
    position_m = np.concatenate([recording.position_m for recording in recordings])
    force_n = np.concatenate([recording.force_n for recording in recordings])
    low = position_m <= position_m.min() + _LOWEST * np.ptp(position_m)
    return float(np.median(force_n[low]))


def depth_m(recording: Recording, contact: Contact) -> Samples:
    """Positions as the model sees them, (n,), m: those above the surface count as 0."""
    if contact == "always":
        return recording.position_m
    return np.maximum(recording.position_m, 0.0)


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
    at the ends of the pause. Before the first recording is what `came_before` finds in it.
    """
    sessions: dict[Hashable, list[int]] = {}
    for number, recording in enumerate(recordings):
        alone = recording.start_s is None or not recording.session
        key = number if alone else (recording.session, recording.place_m)
        sessions.setdefault(key, []).append(number)
    found = []
    for numbers in sessions.values():
        numbers.sort(key=lambda number: recordings[number].start_s or 0.0)
        # Each begins after the one before has ended, to within a few samples.
        pairs = pairwise(recordings[number] for number in numbers)
        late_s = (
            (b.start_s or 0.0) - (a.start_s or 0.0) - a.duration_s + _LATE * b.dt_s
            for a, b in pairs
        )
        parts = [numbers] if min(late_s, default=0.0) >= 0.0 else [[number] for number in numbers]
        found += [_joined(part, recordings, depths_m, surface) for part in parts]
    return tuple(found)


def _joined(
    numbers: Sequence[int],
    recordings: Sequence[Recording],
    depths_m: Sequence[Samples],
    surface: bool,
) -> DepthMotion:
    first_m, starts, pauses = depths_m[numbers[0]], list[int](), list[tuple[int, float]]()
    parts = [came_before(np.maximum(first_m, 0.0) if surface else first_m)]
    length, ends_s = len(parts[0]), 0.0
    for number in numbers:
        recording, depth_m = recordings[number], depths_m[number]
        start_s = recording.start_s or 0.0
        if starts:
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
