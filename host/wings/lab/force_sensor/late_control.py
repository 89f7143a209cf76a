"""Settings of the force control for a sensor that is late (runtime_c/port/posix/sp_press.h)."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from springpot.basics import Samples
from springpot.devices import OPEN_LOOP
from springpot.host.wings.lab.force_sensor.alignment import Delay
from springpot.simulation import RATE_HZ

_POLE_RADPS = 600.0  # of the observer: it hears the encoder's steps as little noise
_OBSERVER_LATE_S = 2.8 / _POLE_RADPS  # of its force; its velocity is not
_REACTION_S = 1 / RATE_HZ + 1.5 / _POLE_RADPS  # of the damper, besides the motor's delay
_DAMPING = 0.25  # of the mass per reaction time; a damper so late makes a free tool ring at pi/2
_RATIO = 1.0  # of damping to critical, where the object is stiffest; at most
_RESISTANCE = 10.0  # reaction times: its low-pass takes less than half of the damping
_MIN_MASS_KG = 0.05
_LEAD = 0.8  # of the command's maximum, at most
_STEP = round(0.02 * RATE_HZ)  # over which compliance is measured: above noise
_BINS, _PER_ROOT_N = 64, 4.0  # of force, by its root
_KEPT = 0.5  # of what is known, at each press
_MIN_N2 = 1e-3


class Compliance:
    """How far the object gave way for each newton, by force, in the presses up to now."""

    def __init__(self) -> None:
        self._sums = np.zeros((2, _BINS))  # of motion times change of force, and of its square

    def learn(self, position_m: Samples, force_n: Samples) -> None:
        """Take a press, both (n,), one value a tick."""
        step_m = position_m[_STEP:] - position_m[:-_STEP]
        step_n = force_n[_STEP:] - force_n[:-_STEP]
        place = _place(0.5 * (force_n[_STEP:] + force_n[:-_STEP])).astype(int)
        products = (step_m * step_n, step_n**2)
        self._sums *= _KEPT
        self._sums += [np.bincount(place, product, _BINS) for product in products]

    def at(self, force_n: Samples) -> Samples:
        """Return the compliance at forces (n,), m/N; 0 if nothing is known."""
        known, found_mpn = self._found()
        if not len(known):
            return np.zeros_like(force_n)
        return np.asarray(np.interp(_place(force_n), known + 0.5, found_mpn))

    @property
    def min_mpn(self) -> float:
        """Where the object is stiffest; 0 if nothing is known."""
        return float(min(self._found()[1], default=0.0))

    def _found(self) -> tuple[NDArray[np.intp], Samples]:
        known = np.flatnonzero(self._sums[1] > _MIN_N2)
        of_motion, of_force = self._sums[:, known]
        return known, np.maximum(0.0, of_motion / of_force)


def _place(force_n: Samples) -> Samples:
    return np.asarray(np.minimum(_PER_ROOT_N * np.sqrt(np.maximum(force_n, 0.0)), _BINS - 1))


def late_gains(delay: Delay, compliance: Compliance) -> Mapping[str, float]:
    """Return gains of sp_press for a late sensor and motor: stable on soft and stiff objects."""
    reaction_s = _REACTION_S + delay.motor_s
    behind_s = max(0.0, delay.value_s - _OBSERVER_LATE_S)
    return {
        **OPEN_LOOP,
        "mass_kg": _mass_kg(delay),
        "pole": math.exp(-_POLE_RADPS / RATE_HZ),
        "damping_nspm": _damping_nspm(delay, compliance),
        "resistance_share": 1 / (RATE_HZ * _RESISTANCE * reaction_s),
        "motor_late": round(RATE_HZ * delay.motor_s),
        "sensor_late": round(RATE_HZ * behind_s),
    }


def led_command(command_n: Samples, delay: Delay, compliance: Compliance) -> Samples:
    """Return the command, and what damper and mass will take of it; (n,), N, one value a tick."""
    speed_mps = compliance.at(command_n) * np.gradient(command_n) * RATE_HZ
    change_mps2 = np.gradient(speed_mps) * RATE_HZ
    taken_n = _damping_nspm(delay, compliance) * speed_mps + _mass_kg(delay) * change_mps2
    max_n = _LEAD * float(np.max(np.abs(command_n)))
    return np.asarray(command_n + np.clip(taken_n, -max_n, max_n))


def _mass_kg(delay: Delay) -> float:
    return max(_MIN_MASS_KG, delay.mass_kg)


def _damping_nspm(delay: Delay, compliance: Compliance) -> float:
    max_nspm = _DAMPING * _mass_kg(delay) / (_REACTION_S + delay.motor_s)
    root_nspm = math.sqrt(_mass_kg(delay) / max(compliance.min_mpn, 1e-9))
    return min(max_nspm, 2 * _RATIO * root_nspm)
