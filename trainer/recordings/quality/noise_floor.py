"""The noise floor of recordings: the error that is left to a model that knows all but the noise."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.quality.cycles import Cycles, find_cycles
from springpot.trainer.recordings.quality.repeats import Repeats, find_repeats
from springpot.trainer.recordings.quality.sensors.channels import quantisation_step
from springpot.trainer.recordings.recording import Recording

_ORDER = 4  # of differences: they keep white noise, and leave next to nothing of a press
_NORMAL = 1.4826  # standard deviation of normal noise over the median of its size
_NO_NOISE = 1e-5  # of the peak force: what rounding and a press's own curvature leave
_FEWEST = 16  # samples


@dataclass(frozen=True)
class NoiseFloor:
    """RMS of the force that no model of the recordings can predict, N; None where it is unknown.

    words: what it is from, or why it is unknown, to stand behind the figure.
    """

    rms_n: float | None
    source: Literal["repeats", "cycles", "sensor"] | None
    words: str


def find_noise_floor(recordings: Sequence[Recording]) -> NoiseFloor:
    """The noise floor of recordings in the order in which they were made."""
    repeats = find_repeats(recordings)
    cycles = [] if repeats else [find_cycles(recording) for recording in recordings]
    return noise_floor(repeats, cycles, recordings)


def noise_floor(
    repeats: Sequence[Repeats], cycles: Sequence[Cycles | None], recordings: Sequence[Recording]
) -> NoiseFloor:
    """From repeated presses; else from cycles within recordings; else from the force's noise.

    By what repeats of one session differ is no noise: the object remembers what came before.
    """
    repeats = [group for group in repeats if not _remembered(group, recordings)]
    if repeats:
        counts = [len(group.names) for group in repeats]
        least, most = min(counts), max(counts)
        number = str(least) if least == most else f"{least} to {most}"
        presses = "one press" if len(repeats) == 1 else f"each of {len(repeats)} presses"
        rms_n = _rms([group.noise_n for group in repeats], [group.samples for group in repeats])
        return NoiseFloor(rms_n, "repeats", f"from {number} repeats of {presses}")
    cyclic = [found for found in cycles if found is not None and found.noise_n is not None]
    if cyclic:
        rms_n = _rms([found.noise_n or 0.0 for found in cyclic], [1] * len(cyclic))
        within = f"{len(cyclic)} recordings" if len(cyclic) > 1 else "one recording"
        return NoiseFloor(rms_n, "cycles", f"from the repeated cycles within {within}")
    peak_n = max((float(np.abs(r.force_n).max()) for r in recordings), default=0.0)
    long = [recording.force_n for recording in recordings if len(recording.force_n) >= _FEWEST]
    rms_n = _rms([sensor_noise_n(force_n) for force_n in long], [len(f) for f in long])
    if rms_n <= _NO_NOISE * peak_n:
        return NoiseFloor(None, None, "no press is repeated, and the force shows no noise")
    return NoiseFloor(rms_n, "sensor", "from the sensor's noise; repeats would show more")


def _remembered(group: Repeats, recordings: Sequence[Recording]) -> bool:
    """Whether its presses follow each other at known times, on one object."""
    sessions = {
        each.session if each.start_s is not None else ""
        for each in recordings
        if each.name in group.names
    }
    return len(sessions) == 1 and "" not in sessions


def sensor_noise_n(force_n: Samples) -> float:
    """RMS of white noise in a force (n,), N, and at least that of its steps' rounding."""
    differences = np.abs(np.diff(force_n, _ORDER))
    moved = differences[differences > 0.0]  # a sensor slower than the recording holds its values
    if not len(moved):
        return 0.0
    white_n = _NORMAL * float(np.median(moved)) / math.sqrt(math.comb(2 * _ORDER, _ORDER))
    rounding_n = (quantisation_step(force_n) or 0.0) / math.sqrt(12)
    return max(white_n, rounding_n)


def _rms(each: Sequence[float], samples: Sequence[int]) -> float:
    """RMS of all samples, from that of each part and its number of them; 0 of none."""
    return float(np.sqrt(np.average(np.square(each), weights=samples))) if each else 0.0
