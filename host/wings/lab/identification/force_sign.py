"""Which way a positive force pushes the tool, from pulses to and fro."""

import numpy as np

from springpot.basics import Samples
from springpot.host.wings.lab.identification.excitation import PULSE_S, Excitation

_LATE_S = 0.005  # of the motion after its force, more or less
_SHARE = 0.2  # of the way back that the way forth must be, to count


def positive_raises(excitation: Excitation, position_m: Samples) -> bool:
    """Whether a positive force raises the position, by the last two pulses.

    position_m: (n,), of the ticks that were played, the last pulse being the last.
    """
    score = 0.0
    for end in (len(position_m), len(position_m) - excitation.pulse_ticks):
        begin = end - excitation.pulse_ticks
        if begin >= excitation.quiet_ticks:
            pulse = slice(begin, end)
            score += _pushed_m(excitation, excitation.command[pulse], position_m[pulse])
    return score > 0


def _pushed_m(excitation: Excitation, command: Samples, position_m: Samples) -> float:
    """How far one pulse moved the tool the way of its force, m.

    What coasts is still moving forth while the force pushes back. What is stuck one way, by
    friction and a force that always acts, moves in the second half only.
    """
    half, late = round(PULSE_S / excitation.dt_s), round(_LATE_S / excitation.dt_s)
    begin_m, middle_m, end_m = position_m[[0, half + late, 2 * half + late]]
    forth_m, back_m = float(middle_m - begin_m), float(end_m - middle_m)
    way = float(np.sign(command[0]))
    if forth_m * back_m > 0 and abs(forth_m) < _SHARE * abs(back_m):
        return -way * back_m
    return way * (forth_m if forth_m * back_m > 0 else forth_m - back_m)
