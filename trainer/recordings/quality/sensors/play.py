"""Play between the tool and the sensor of its position: where the tool turns, the sensor stands."""

from collections.abc import Iterator

import numpy as np

from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.quality.motion import find_strokes
from springpot.trainer.recordings.quality.sensors.channels import quantisation_step
from springpot.trainer.recordings.quality.sign_evidence import noise_n
from springpot.trainer.recordings.recording import Recording

_STANDS = 0.01  # of the travel
_FALLS = 0.1  # of the stroke's greatest force, meanwhile
_NOISES = 8.0
_LONGER = 2.0  # times as long as before the turn: a sine comes to rest and leaves alike
_FEWEST, _MOST = 2, 0.6  # turns; of them


def play_findings(recording: Recording) -> Iterator[Finding]:
    """Yield a finding if position stands after most turns while the tool goes back already.

    An object that is held relaxes too, ever more slowly; here force falls ever faster.
    """
    grain_m = quantisation_step(recording.position_m) or 0.0
    if grain_m > _STANDS / 2.0 * float(np.ptp(recording.position_m)):
        return  # a coarse sensor stands at each turn
    inwards = [
        end
        for begin, end, _ in find_strokes(recording)
        if recording.position_m[end] > recording.position_m[begin]
    ]
    falls = [_fall(recording, turn) for turn in inwards if turn + 1 < len(recording.position_m)]
    stood = [fall for fall in falls if fall > _FALLS]
    if len(stood) >= _FEWEST and len(stood) > _MOST * len(falls):
        yield warning(
            "play", recording.name,
            f"position stands still after {len(stood)} of {len(falls)} turns while force falls by "
            f"{100 * float(np.median(stood)):.2g} % of its peak",
            "play (backlash) between the tool and the sensor of its position: the loop is too wide",
            "measure position at the tool, or take the play out of the gear",
        )  # fmt: skip


def _fall(recording: Recording, turn: int) -> float:
    """Share of the force at a turn that is lost while position stands after it; 0: as if held."""
    position_m, force_n = recording.position_m, recording.force_n
    near = position_m >= position_m[turn] - _STANDS * float(np.ptp(position_m))
    first, last = turn, turn
    while first > 0 and near[first - 1]:
        first -= 1
    while last + 1 < len(near) and near[last + 1]:
        last += 1
    middle = (turn + last) // 2
    fall_n = float(force_n[turn] - force_n[last])
    faster = force_n[middle] - force_n[last] > force_n[turn] - force_n[middle]
    longer = last - turn > _LONGER * (turn - first)
    if not (faster and longer) or fall_n < _NOISES * noise_n(force_n):
        return 0.0
    return fall_n / float(force_n[turn])
