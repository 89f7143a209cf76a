"""The noise floor, the error left to a model that knows all: what repeats of a press differ by."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from springpot.trainer.recordings.quality.cycles import Cycles, find_cycles
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.sensor import sensor_noise_n

_SAME_PRESS, _SAME_RATE = 0.02, 1e-3  # rms difference, of the range of a channel; of rates
_MAX_PAIRED = 200  # recordings
_CURVE = 7  # degree: tissue stiffens tenfold within a tenth of its depth
_NO_NOISE = 1e-5  # of the peak force: what rounding and a press's own curvature leave
_FEWEST = 16  # samples

Stack = NDArray[np.float64]  # (repeats, samples)


@dataclass(frozen=True)
class NoiseFloor:
    """RMS of the force that no model of the recordings can predict, N; None where it is unknown.

    words: what it is from, or why it is unknown, to stand behind the figure.
    """

    rms_n: float | None
    source: Literal["repeats", "cycles", "sensor"] | None
    words: str


def find_noise_floor(
    recordings: Sequence[Recording], cycles: Sequence[Cycles | None] | None = None
) -> NoiseFloor:
    """The noise floor of recordings in the order in which they were made.

    From repeated presses; else from cycles, which are found if they are not given; else from the
    force's noise. By what repeats of one session differ is no noise: the object remembers.
    """
    if repeats := [group for group in find_repeats(recordings) if not _one_session(group)]:
        number = " or ".join(map(str, sorted({len(group) for group in repeats})))
        presses = "one press" if len(repeats) == 1 else f"each of {len(repeats)} presses"
        words = f"from {number} repeats of {presses}"
        return NoiseFloor(_rms([_repeat_noise_n(group) for group in repeats]), "repeats", words)
    pairs = zip(recordings, cycles or map(find_cycles, recordings), strict=True)
    if cyclic := [rms_n for each, own in pairs if own and (rms_n := _cycle_noise_n(each, own))]:
        within = f"{len(cyclic)} recordings" if len(cyclic) > 1 else "one recording"
        return NoiseFloor(_rms(cyclic), "cycles", f"from the repeated cycles within {within}")
    forces = [each.force_n for each in recordings if len(each.force_n) >= _FEWEST]
    rms_n = _rms([sensor_noise_n(force_n) for force_n in forces])
    if rms_n <= _NO_NOISE * max((float(np.abs(force_n).max()) for force_n in forces), default=0.0):
        return NoiseFloor(None, None, "no press is repeated, and the force shows no noise")
    return NoiseFloor(rms_n, "sensor", "from the sensor's noise; repeats would show more")


def find_repeats(recordings: Sequence[Recording]) -> list[list[Recording]]:
    """Group recordings of one press, of equal length and rate; a copy is no repeat."""
    groups: list[list[Recording]] = []
    for recording in recordings[:_MAX_PAIRED]:
        group = next((g for g in groups if _same_press(g[0], recording)), None)
        if group is None:
            groups.append([recording])
        elif all(recording.content_hash != other.content_hash for other in group):
            group.append(recording)
    return [group for group in groups if len(group) > 1]


def _same_press(one: Recording, other: Recording) -> bool:
    """Whether one path was driven twice, or one force, at one place."""
    same = one.place_m == other.place_m and abs(one.dt_s / other.dt_s - 1) < _SAME_RATE
    if not same or len(one.force_n) != len(other.force_n):
        return False
    pairs = ((one.position_m, other.position_m), (one.force_n, other.force_n))
    return any(_alike(np.stack(pair)) for pair in pairs)


def _one_session(group: Sequence[Recording]) -> bool:
    timed = all(each.session and each.start_s is not None for each in group)
    return timed and len({each.session for each in group}) == 1


def _repeat_noise_n(group: Sequence[Recording]) -> float:
    """RMS by which each differs from the mean of the k before, which adds a k-th to its noise."""
    positions, forces = (np.stack([getattr(each, channel) for each in group])
                         for channel in ("position_m", "force_n"))  # fmt: skip
    steady = _at_equal_positions(positions, forces)
    before = np.arange(1, len(group))[:, None]
    off = steady[1:] - np.cumsum(steady, axis=0)[:-1] / before
    return float(np.sqrt(np.mean(before / (before + 1.0) * off**2)))


def _cycle_noise_n(recording: Recording, cycles: Cycles) -> float | None:
    """RMS by which each cycle differs from the one before, N; None where neither channel repeats.

    Means are apart, for what settles can be predicted.
    """
    period, rows = cycles.starts[1] - cycles.starts[0], np.arange(len(recording.force_n))
    points = max(8, int(period))
    at = cycles.starts[:-1, None] + period * np.arange(points) / points
    stacks = [np.interp(at, rows, samples) for samples in (recording.position_m, recording.force_n)]
    position, force = (stack - stack.mean(axis=1, keepdims=True) for stack in stacks)
    if not (_alike(position) or _alike(force)):
        return None
    # Interpolating between two samples averages them: so much of white noise is left over.
    left = float(np.mean((at % 1.0) ** 2 + (1.0 - at % 1.0) ** 2))
    steps_n = np.diff(_at_equal_positions(position, force), axis=0)
    return float(np.sqrt(np.mean(steps_n**2) / (2.0 * left)))


def _alike(stack: Stack) -> bool:
    """Whether samples (repeats, samples) are the same in every repeat."""
    off = stack - stack.mean(axis=0)
    return float(np.sqrt(np.mean(off**2))) < _SAME_PRESS * float(np.ptp(stack))


def _at_equal_positions(position_m: Stack, force_n: Stack) -> Stack:
    """Forces of repeats, (repeats, samples), N, moved to the repeats' mean position.

    A press that is driven by force repeats its force, and differs in position where the object
    does: each force moves along the press's own stiffness there. (A line through the differences
    would not do: it takes a softer object for one that was pressed deeper.)
    """
    mean_m = position_m.mean(axis=0)
    if not np.ptp(mean_m):
        return force_n
    # `full`: few distinct positions are no reason to warn
    curve, _ = np.polynomial.Polynomial.fit(mean_m, force_n.mean(axis=0), _CURVE, full=True)
    moved: Stack = force_n - curve.deriv()(mean_m) * (position_m - mean_m)
    return moved


def _rms(each: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(each)))) if each else 0.0
