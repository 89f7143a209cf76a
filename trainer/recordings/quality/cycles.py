"""Cycles of a motion: frequency, stiffness, loss angle."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.motion import turning_points
from springpot.trainer.recordings.recording import Recording

_EVEN_STROKES = (0.1, 0.02)  # of the whole travel: what counts as a stroke, large ones first
_SAME_WAY, _SAME_TIME = 0.1, 0.3
_FEWEST = 3
_CUT = 0.15  # of a cycle: turns are found a little inside the first and the last one
_ONE_TONE = 0.5  # of the position's variance that one tone must explain
_MAX_SAMPLES = 200_000


@dataclass(frozen=True, eq=False)
class Cycles:
    """Cycles of one recording at one frequency, the first of more than three left out.

    starts: row, with its fraction, at which each cycle begins, and the last one ends.
    stiffness_npm: ratio of the amplitudes of force and position at that frequency.
    lead_rad: how far force leads position there: a nonlinear spring leads by nothing.
    """

    frequency_hz: float
    amplitude_m: float
    stiffness_npm: float
    lead_rad: float
    starts: Samples

    @property
    def count(self) -> int:
        return len(self.starts) - 1

    def metadata(self) -> dict[str, float]:
        """JSON values."""
        keys = ("frequency_hz", "count", "amplitude_m", "stiffness_npm")
        return {key: getattr(self, key) for key in keys}


def find_cycles(recording: Recording) -> Cycles | None:
    """Analyse the longest run of three cycles or more alike; None without one."""
    starts = _starts(recording.position_m)
    if len(starts) <= _FEWEST:
        return None
    if len(starts) - 1 > _FEWEST:
        starts = starts[1:]  # the first cycle settles: Mullins softening, preconditioning of tissue
    rows = np.arange(int(np.ceil(starts[0])), min(int(starts[-1]) + 1, len(recording.force_n)))
    cycles = (rows - starts[0]) / (starts[1] - starts[0])
    turn = 2.0 * np.pi * cycles
    basis = np.stack([np.cos(turn), np.sin(turn), np.ones(len(rows)), cycles], axis=1)
    channels = np.stack([recording.position_m[rows], recording.force_n[rows]], axis=1)
    found = np.linalg.lstsq(basis, channels, rcond=None)[0]
    x1, f1 = (complex(tone[0], -tone[1]) for tone in found.T)
    # A sine of amplitude X has the variance X^2 / 2.
    if abs(x1) ** 2 / 2 < _ONE_TONE * np.var(channels[:, 0]) or not abs(f1):
        return None
    frequency_hz = recording.rate_hz / float(starts[1] - starts[0])
    return Cycles(frequency_hz, abs(x1), abs(f1) / abs(x1), float(np.angle(f1 / x1)), starts)


def _starts(position_m: Samples) -> Samples:
    """Rows at which each of the cycles alike, in way and time, begins, and the last one ends.

    Rigs approach the object, wait, and leave it again: beside small cycles that is most of the
    motion. The period is that between ways through the middle, which is sharper than a turn.
    """
    travel_m = float(np.ptp(position_m))
    for share in _EVEN_STROKES if travel_m > 0.0 and len(position_m) <= _MAX_SAMPLES else ():
        turns = np.array(turning_points(position_m, share * travel_m), dtype=np.intp)
        ways_m, rows = np.abs(np.diff(position_m[turns])), np.diff(turns)
        alike = np.abs(np.diff(ways_m)) < _SAME_WAY * ways_m[1:]
        alike &= np.abs(np.diff(rows)) < _SAME_TIME * rows[1:]
        ends = np.flatnonzero(np.concatenate([[True], ~alike, [True]]))
        longest = int(np.argmax(np.diff(ends)))
        strokes = turns[ends[longest] : ends[longest + 1] + 1]
        if len(strokes) <= 2 * _FEWEST:
            continue
        middle_m = float(np.mean(position_m[strokes[0] : strokes[-1] + 1]))
        inwards = [pair for pair in pairwise(strokes) if position_m[pair[0]] < middle_m]
        passes = [begin + int(np.argmax(position_m[begin : end + 1] >= middle_m))
                  for begin, end in inwards]  # fmt: skip
        low_m, high_m = position_m[np.array(passes) - 1], position_m[passes]
        at = passes - (high_m - middle_m) / (high_m - low_m)
        period = float(at[-1] - at[0]) / (len(at) - 1)
        start = max(float(at[0]) - period / 4.0, float(strokes[0]))
        count = int((float(strokes[-1]) - start) / period + _CUT)
        return start + period * np.arange(count + 1.0)
    return np.empty(0)
