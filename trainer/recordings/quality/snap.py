"""Snap-through: an object that gives way under the tool, as a dome or a tactile switch does."""

from collections.abc import Iterator, Sequence

import numpy as np

from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.quality.motion import find_strokes
from springpot.trainer.recordings.quality.sign_evidence import noise_n
from springpot.trainer.recordings.recording import Recording

_FALL = 0.08  # of the peak force: less is friction, or the sensor's
_NOISES = 8.0
# Of the way in: force also falls where a relaxing object is pressed ever more slowly, and leads
# position by delta: at the end of a sine, beyond (1 + cos delta) / 2 = 0.8 for delta = 53 degrees.
_WAY = (0.05, 0.8)
_STEADY = 0.3  # of the stroke's usual speed: an object that is held relaxes
_SHARE = 0.5  # of the strokes that go as deep
_MEAN = 0.02  # of the way in: a snap is wider, and a sensor's noise is not white
_SAME_PLACE = 0.15  # of the travel: friction and slips are anywhere


def snap_findings(recordings: Sequence[Recording]) -> Iterator[Finding]:
    """Yield a warning for the set, where force falls on the way in at every speed."""
    falls, deep_enough, where = [], 0, ""
    for recording in recordings:
        peak_n = float(recording.force_n.max())
        if peak_n <= 0.0:
            continue  # never pushed: signs are another check's
        least_n = max(_FALL * peak_n, _NOISES * noise_n(recording.force_n))
        for begin, end, _ in find_strokes(recording):
            if recording.position_m[end] <= recording.position_m[begin]:
                continue
            fall_n, at_m = _greatest_fall(recording, begin, end)
            deep_enough += 1
            if fall_n > least_n:
                falls.append((at_m, fall_n / peak_n))
                where = where or recording.name
    if not falls or len(falls) < _SHARE * deep_enough:
        return
    places_m = np.array([at_m for at_m, _ in falls])
    travel_m = max(float(np.ptp(recording.position_m)) for recording in recordings)
    if np.ptp(np.quantile(places_m, (0.1, 0.9))) > _SAME_PLACE * travel_m:
        return
    share = float(np.median([share for _, share in falls]))
    yield warning(
        "snap", where,
        f"force falls by {100 * share:.2g} % of its peak on the way in, near "
        f"{1e3 * float(np.median(places_m)):.3g} mm, in {len(falls)} of {deep_enough} presses",
        "the object snaps through, and no monotone model has that: what is felt lacks the click",
        "take a kind with trees (rf-fd), and compare it by `springpot validate`",
    )  # fmt: skip


def _greatest_fall(recording: Recording, begin: int, end: int) -> tuple[float, float]:
    """Greatest fall of force, N, while position moves in steadily, and where it begins, m."""
    position_m = recording.position_m[begin : end + 1]
    force_n = recording.force_n[begin : end + 1]
    way_m = float(position_m[-1] - position_m[0])
    low_m, high_m = (float(position_m[0]) + share * way_m for share in _WAY)
    part = np.flatnonzero((position_m >= low_m) & (position_m <= high_m))
    if len(part) < 5:  # samples
        return 0.0, 0.0
    first, last = int(part[0]), int(part[-1]) + 1
    position_m, force_n = position_m[first:last], force_n[first:last]
    usual_m = (high_m - low_m) / len(position_m)
    speed = np.gradient(position_m) / usual_m
    if float(np.min(_mean(speed))) < _STEADY:
        return 0.0, 0.0
    force_n = _mean(force_n)
    highest_n = np.maximum.accumulate(force_n)
    deepest = int(np.argmax(highest_n - force_n))
    top = int(np.argmax(force_n[: deepest + 1]))
    return float(highest_n[deepest] - force_n[deepest]), float(position_m[top])


def _mean(samples: np.ndarray) -> np.ndarray:
    """Over 2 % of the way and five samples at least, the ends with what there is."""
    window = np.ones(max(5, round(_MEAN * len(samples))))
    weight = np.convolve(np.ones_like(samples), window, "same")
    mean: np.ndarray = np.convolve(samples, window, "same") / weight
    return mean
