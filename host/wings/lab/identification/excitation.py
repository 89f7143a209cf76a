"""What is played to a device that nobody holds: pulses until it moves, then a sweep that swings it
as far as allowed; and the C that plays it (runtime_c/port/posix/sp_excite.h)."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import signal

from springpot.basics import Samples
from springpot.emission import LATCHED
from springpot.loop import StepFunctions, loop_library

WATCHDOG_S = 0.02
STILL_S = 0.5
SEEN_M = 2e-4
SWEEP_S = 9.0
PULSE_S = 0.03  # either way
_PAUSE_S = 0.1
_WEAKEST, _STRONGER = 0.02, 1.25  # of the force limit; from pulse to pulse
_FAST_HZ, _SLOW_HZ = 25.0, 1.5
_SWING = 0.4  # of the travel limit
_FIRST_GAIN, _GAIN_STEP = 0.1, 0.05  # of the force limit
_SPRING = 0.5  # of the force limit, at the travel limit
_BRAKED_S = 0.02  # the damper brakes as much at a speed as the spring at the way of so long


@dataclass(frozen=True)
class MoveLimits:
    """What the test keeps within: force, N, and travel to either side of where it begins, m."""

    max_force_n: float
    max_travel_m: float


@dataclass(frozen=True)
class Excitation:
    """What one run plays. command: (n,), -1 to 1, times a gain.

    sign: of the force where it is known, else 0: then there is no spring, and pulses end as soon as
    one moved the tool. swing_m: how far it is to swing; 0 leaves the gain as it is.
    """

    command: Samples
    dt_s: float
    gain_n: float
    sign: int = 0
    swing_m: float = 0.0
    quiet_ticks: int = 0
    pulse_ticks: int = 0


def pulses(rate_hz: float, limits: MoveLimits) -> Excitation:
    """Return silence, then stronger and stronger pulses to and fro, up to the force limit."""
    half, pause = round(PULSE_S * rate_hz), round(_PAUSE_S * rate_hz)
    quiet = np.zeros(round(STILL_S * rate_hz))
    count = int(np.ceil(np.log(1 / _WEAKEST) / np.log(_STRONGER)))
    sizes = [min(1.0, _WEAKEST * _STRONGER**k) for k in range(count + 1)]
    # The last two are of one size, either way first: what holds it may be weaker one way.
    shapes = [
        size * way * np.repeat([1.0, -1.0, 0.0], [half, half, pause])
        for size, way in zip([*sizes, 1.0], [1.0, -1.0] * len(sizes), strict=False)
    ]
    return Excitation(
        np.concatenate([quiet, *shapes]),
        1 / rate_hz,
        limits.max_force_n,
        quiet_ticks=len(quiet),
        pulse_ticks=2 * half + pause,
    )


def sweep(rate_hz: float, limits: MoveLimits, sign: int) -> Excitation:
    """Return a sine from fast to slow; the C adapts its size to the swing that is wanted."""
    time_s = np.arange(round(SWEEP_S * rate_hz)) / rate_hz
    return Excitation(
        signal.chirp(time_s, _FAST_HZ, SWEEP_S, _SLOW_HZ, method="logarithmic", phi=-90.0),
        1 / rate_hz,
        _FIRST_GAIN * limits.max_force_n,
        sign=sign,
        swing_m=_SWING * limits.max_travel_m,
    )


def excite_step_functions(excitation: Excitation, limits: MoveLimits) -> tuple[StepFunctions, Any]:
    """Return what a loop calls, and the C state (sp_excite) that says how it went."""
    library = loop_library("double")
    command = np.ascontiguousarray(excitation.command, dtype=np.float64)
    stiffness_npm = _SPRING * limits.max_force_n / limits.max_travel_m
    settings: dict[str, Any] = {
        "command": library.array(command),
        "n": len(command),
        "quiet_ticks": excitation.quiet_ticks,
        "pulse_ticks": excitation.pulse_ticks,
        "seen_m": SEEN_M,
        "dt_s": excitation.dt_s,
        "max_force_n": limits.max_force_n,
        "max_travel_m": limits.max_travel_m,
        "swing_m": excitation.swing_m,
        "gain_n": excitation.gain_n,
        "gain_step_n": _GAIN_STEP * limits.max_force_n,
        "sign": excitation.sign,
        "stiffness_npm": stiffness_npm,
        "damping_nspm": _BRAKED_S * stiffness_npm,
        "watchdog_s": WATCHDOG_S,
        "latched_note": LATCHED,
    }
    excite = library.ffi.new("sp_excite *", settings)
    return StepFunctions.of(library, "sp_excite", excite, kept=(excite, command)), excite
