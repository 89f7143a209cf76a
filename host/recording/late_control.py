"""Settings of the force control for a sensor that is late (runtime_c/port/posix/sp_press.h)."""

import math
from collections.abc import Mapping

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.host.force_sensor.alignment import Delay
from springpot.host.recording.indentation import OPEN_LOOP
from springpot.host.recording.protocols import RATE_HZ

_POLE_RADPS = 600.0  # of the observer: it hears the encoder's steps as little noise
_OBSERVER_LATE_S = 2.8 / _POLE_RADPS  # of its force; its velocity is not
_REACTION_S = 1 / RATE_HZ + 1.5 / _POLE_RADPS  # of the damper, besides the motor's delay
# Of the mass per reaction time: a third of where a damper makes a stiff object ring.
_DAMPING = 0.2
_RESISTANCE = 10.0  # reaction times: what it takes from the damping is half of that at most
_LEAD = 0.4  # of the command's maximum, at most
_LIGHTEST_KG = 0.05


def late_gains(delay: Delay) -> Mapping[str, float]:
    """Of sp_press, for a sensor and a motor that are late; stable whatever is pressed."""
    reaction_s = _REACTION_S + delay.motor_s
    behind_s = max(0.0, delay.value_s - _OBSERVER_LATE_S)
    return {
        **OPEN_LOOP,
        "mass_kg": _mass_kg(delay),
        "pole": math.exp(-_POLE_RADPS / RATE_HZ),
        "damping_nspm": _damping_nspm(delay),
        "resistance_share": 1 / (RATE_HZ * _RESISTANCE * reaction_s),
        "motor_late": round(RATE_HZ * delay.motor_s),
        "sensor_late": round(RATE_HZ * behind_s),
    }


def led_command(command_n: Samples, compliance_mpn: float, delay: Delay) -> Samples:
    """The command and what damper and mass will take of it on an object of that compliance, N.

    command_n: (n,), one value a tick.
    """
    change_nps = np.gradient(command_n) * RATE_HZ
    taken_n = compliance_mpn * (
        _damping_nspm(delay) * change_nps
        + _mass_kg(delay) * np.gradient(change_nps) * RATE_HZ
    )
    most_n = _LEAD * float(np.max(np.abs(command_n)))
    return np.asarray(command_n + np.clip(taken_n, -most_n, most_n))


def _mass_kg(delay: Delay) -> float:
    return max(_LIGHTEST_KG, delay.mass_kg)


def _damping_nspm(delay: Delay) -> float:
    return _DAMPING * _mass_kg(delay) / (_REACTION_S + delay.motor_s)
