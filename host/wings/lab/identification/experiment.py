"""The test of a free device: pulses until it moves, a sweep, and what stops it."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from springpot import DeviceError, SpringpotError
from springpot.basics import Samples
from springpot.host.wings.lab.identification.estimate import estimate_device
from springpot.host.wings.lab.identification.excitation import (
    PULSE_S,
    SEEN_M,
    STILL_S,
    WATCHDOG_S,
    Excitation,
    MoveLimits,
    pulses,
    sweep,
)
from springpot.host.wings.lab.identification.free_motion import FreeMotion, free_motion, unlocated
from springpot.host.wings.lab.identification.result import DeviceMeasured
from springpot.loop import LoopRows

_DRIFTS = 0.05  # of the travel limit, while it rests
_LATE_S = 0.005  # of the motion after its force, more or less
_SHARE = 0.2  # of the way back that the way forth must be, to count


class Mover(Protocol):
    """Plays an excitation on a device."""

    @property
    def max_n(self) -> float | None:
        """The largest force that the device promises."""
        ...

    def __call__(self, excitation: Excitation, limits: MoveLimits) -> tuple[LoopRows, Any]:
        """Play it; the rows, and the C state (sp_excite) after it."""
        ...


def identify_device(
    mover: Mover,
    limits: MoveLimits,
    rate_hz: float,
    url: str,
    say_step: Callable[[str], None] = lambda _line: None,
) -> DeviceMeasured:
    """Move a device that nobody holds, and find what it is. say_step: called before each part.

    Raises DeviceError where it does not move, moves by itself, or samples are missing;
    SpringpotError where it came to the travel limit.
    """
    say_step("pulses, until it moves")
    quiet, sign = find_sign(mover, limits, rate_hz, url)
    say_step(f"a sweep of {sweep(rate_hz, limits, sign).command.size / rate_hz:g} s")
    rows, excite = mover(sweep(rate_hz, limits, sign), limits)
    _require_awake(excite, url)
    _require_within(excite, limits, url)
    return estimate_device(free_motion(rows, sign, 1 / rate_hz, url), quiet, sign, mover.max_n, url)


def find_sign(mover: Mover, limits: MoveLimits, rate_hz: float, url: str) -> tuple[FreeMotion, int]:
    """Find the rest before the pulses, and the sign: 1 if a positive force pushes the tool out."""
    excitation = pulses(rate_hz, limits)
    rows, excite = mover(excitation, limits)
    _require_awake(excite, url)
    dt_s = 1 / rate_hz
    quiet = free_motion(rows[: excitation.quiet_ticks], 1, dt_s, url)
    _require_rest(quiet, limits, url)
    _require_within(excite, limits, url)
    if not excite.seen:
        raise DeviceError(
            f"{url}: does not move: {limits.max_force_n:g} N for {1e3 * PULSE_S:g} ms moved it "
            f"by no more than {1e3 * SEEN_M:g} mm: switch its power on, release its brake, free "
            "the tool, or give more force with --max-force-n"
        )
    played = free_motion(rows[: excite.n], 1, dt_s, url)
    return quiet, -1 if positive_raises(excitation, played.position_m) else 1


def _require_rest(quiet: FreeMotion, limits: MoveLimits, url: str) -> None:
    tenth = max(1, len(quiet.position_m) // 10)
    moved_m = float(np.mean(quiet.position_m[-tenth:]) - np.mean(quiet.position_m[:tenth]))
    if abs(moved_m) > _DRIFTS * limits.max_travel_m:
        raise DeviceError(
            f"{url}: moves by itself, {1e3 * moved_m:.2g} mm in {STILL_S:g} s without force: lay "
            "it so that gravity does not pull the tool, take away springs and hands, and let it "
            "come to rest"
        )


def _require_within(excite: Any, limits: MoveLimits, url: str) -> None:
    if excite.beyond and not np.isfinite(excite.beyond_m):
        raise unlocated(url)
    if excite.beyond:
        raise SpringpotError(
            f"{url}: came {1e3 * excite.beyond_m:.3g} mm from where it began, the limit is "
            f"{1e3 * limits.max_travel_m:g} mm, force zero: give more room with --max-travel-mm, "
            "less force with --max-force-n, or see what pulls it"
        )


def _require_awake(excite: Any, url: str) -> None:
    if excite.latched and not excite.beyond:
        raise DeviceError(
            f"{url}: silent for {1e3 * WATCHDOG_S:g} ms, force zero, stopped: check cable, rate "
            "and power"
        )


def positive_raises(excitation: Excitation, position_m: Samples) -> bool:
    """Return whether a positive force raises the position, by the last two pulses.

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
    """Return how far one pulse moved the tool the way of its force, m.

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
