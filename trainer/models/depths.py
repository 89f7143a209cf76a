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
    estimate_history_m,
    sensor_noise_n,
    smooth,
    smoothing_samples,
)

_REST_DEPTH_FRACTION = (
    0.02  # of the depth: where an object's force is 0 if position 0 is its surface
)
_PRELOAD_FRACTION = 0.02  # of the peak force
_PULL_FORCE_FRACTION, _PULL_SAMPLE_FRACTION = (
    0.05,
    0.01,
)  # of the peak force, in a share of the samples: it holds the tool
_MAINS_PERIOD_S, _NOISE_SIGMAS = (
    0.02,
    4.0,
)  # a period of the mains, over which a force is averaged; of noise
_MAX_PAUSE_S = 600.0
_FOREVER_S = 1e6
_CLOCK_SLACK_SAMPLES = 5  # samples by which clocks of two recordings may overlap


def classify_contact(recordings: Sequence[Recording]) -> tuple[Contact, str]:
    """Return "surface" if the tool leaves the object where force is 0, else "always"; and why.

    "always" and why there is no surface, unless a person stated it: if an importer moved the zero,
    or if force at the lowest depth is 2 % of the peak or more and no recording shows where contact
    begins. (One that does has a tare: the object does not push with it.) Nor does the tool leave
    what holds it: `pulls`.
    """
    zeroed = [recording.name for recording in recordings if recording.zero != "none"]
    if zeroed and len(zeroed) != len(recordings):
        not_zeroed = next(recording.name for recording in recordings if recording.zero == "none")
        raise DataError(
            f"{zeroed[0]} was imported with --zero and {not_zeroed} without: "
            "import all the same way"
        )
    if zeroed:
        return "always", ""
    peak_n = max(float(recording.force_n.max()) for recording in recordings)
    if peak_n > 0.0 and is_adhesive(recordings):
        min_n = min(float(recording.force_n.min()) for recording in recordings)
        return "always", (
            f"force goes to {min_n:.3g} N inside the object: it holds the tool, and the model "
            "pulls as it does; if nothing held it, look for drift or delay of the force"
        )
    rest_n = estimate_rest_force_n(recordings)
    if abs(rest_n) < _PRELOAD_FRACTION * peak_n or peak_n <= 0.0:
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


def is_adhesive(recordings: Sequence[Recording]) -> bool:
    """Tell if the object holds the tool: the force inside goes below that at rest, often.

    By 5 % of the peak in 1 % of the samples or more, and by more than noise: a glued specimen, or
    one that sticks. Each recording may have a tare of its own.
    """
    peak_n = max(float(recording.force_n.max()) for recording in recordings)
    pulling_samples = samples = 0
    for recording in recordings:
        window_samples = smoothing_samples(_MAINS_PERIOD_S, recording.dt_s)
        averaged = (
            smooth(recording, _MAINS_PERIOD_S)
            if window_samples < len(recording.force_n)
            else recording
        )
        noise_n = _NOISE_SIGMAS * sensor_noise_n(recording.force_n) / np.sqrt(window_samples)
        low_m = float(averaged.position_m.min()) + _REST_DEPTH_FRACTION * float(
            np.ptp(averaged.position_m)
        )
        limit_n = (
            min(estimate_rest_force_n([averaged]), 0.0) - _PULL_FORCE_FRACTION * peak_n - noise_n
        )
        is_pulling = (averaged.position_m > low_m) & (averaged.force_n < limit_n)
        pulling_samples += int(np.count_nonzero(is_pulling))
        samples += len(is_pulling)
    return pulling_samples > _PULL_SAMPLE_FRACTION * samples


def estimate_rest_force_n(recordings: Sequence[Recording]) -> float:
    """Median force at the lowest 2 % of the positions of all recordings, N."""
    position_m = np.concatenate([recording.position_m for recording in recordings])
    force_n = np.concatenate([recording.force_n for recording in recordings])
    low = position_m <= position_m.min() + _REST_DEPTH_FRACTION * np.ptp(position_m)
    return float(np.median(force_n[low]))


def compute_depth_m(recording: Recording, contact: Contact) -> Samples:
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


def join_motions(
    recordings: Sequence[Recording], depths_m: Sequence[Samples], surface: bool
) -> tuple[DepthMotion, ...]:
    """Join recordings of one session and place by their times; others are one each.

    In a pause the tool stands above the surface; if the object has none, at the lower of the depths
    at the ends of the pause. Before the first recording is what `estimate_history_m` finds in it.
    """
    sessions: dict[Hashable, list[int]] = {}
    for number, recording in enumerate(recordings):
        untimed = recording.start_s is None or not recording.session
        key = number if untimed else (recording.session, recording.place_m)
        sessions.setdefault(key, []).append(number)
    joined = []
    for numbers in sessions.values():
        numbers.sort(key=lambda number: recordings[number].start_s or 0.0)
        # Each begins after the one before has ended, to within a few samples.
        pairs = pairwise(recordings[number] for number in numbers)
        gaps_s = (
            (b.start_s or 0.0) - (a.start_s or 0.0) - a.duration_s + _CLOCK_SLACK_SAMPLES * b.dt_s
            for a, b in pairs
        )
        groups = [numbers] if min(gaps_s, default=0.0) >= 0.0 else [[number] for number in numbers]
        joined += [_join_session(part, recordings, depths_m, surface) for part in groups]
    return tuple(joined)


def _join_session(
    numbers: Sequence[int],
    recordings: Sequence[Recording],
    depths_m: Sequence[Samples],
    surface: bool,
) -> DepthMotion:
    """Join the recordings of a session into one motion, with a pause before each, s.

    What came before the first one is guessed from it (`estimate_history_m`).
    """
    first_m, starts = depths_m[numbers[0]], list[int]()
    before_m = estimate_history_m(np.maximum(first_m, 0.0) if surface else first_m)
    # What moves in the object came in from 0: stops are held by it, and all else forgot it.
    parts = [np.zeros(len(before_m[:1])), before_m[:1], before_m]
    pauses = [(2, _FOREVER_S)] * len(before_m[:1])
    length, ends_s = sum(map(len, parts)), 0.0
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


def pauses_to_ticks(motion: DepthMotion, dt_s: float) -> DepthMotion:
    """Replace each pause by ticks at rest, ten minutes of them at most: for C."""
    parts, starts, begin = [], np.array(motion.starts), 0
    for sample, seconds in motion.pauses:
        count = round(min(seconds, _MAX_PAUSE_S) / dt_s)
        parts += [motion.depth_m[begin:sample], np.full(count, motion.depth_m[sample])]
        starts += count * (np.array(motion.starts) > sample)
        begin = sample
    parts.append(motion.depth_m[begin:])
    return replace(motion, depth_m=np.concatenate(parts), starts=tuple(starts.tolist()), pauses=())
