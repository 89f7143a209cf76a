"""Where the object's surface is, in the device's own counting: the tool touches it, force zero."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from springpot import Device, SpringpotError
from springpot.basics import Samples
from springpot.devices import OPEN_LOOP, press_step_functions
from springpot.loop import COLUMN, IDLE, LoopRows, LoopSettings, SessionRunner, requirements_of

TOUCHES = 3
_RATE_HZ, _WATCHDOG_S = 1000.0, 0.02
_LONGEST_S = 600.0
_MEAN_S = 0.3
_STILL_M = 0.2e-3  # the tool moves no more than this while it is measured
_SAME_M = 1.0e-3  # three touches of one surface
_NO_FORCE_N = 1e-3


@dataclass(frozen=True)
class Surface:
    """Position of the undeformed surface, m, and how far the touches were from each other."""

    surface_m: float
    spread_m: float


class _Newest:
    """The last rows of a loop."""

    def __init__(self) -> None:
        self._rows: list[LoopRows] = []

    def append(self, rows: LoopRows) -> None:
        self._rows = [*self._rows[-20:], rows]

    def position_m(self) -> Samples:
        """Return the positions of the last moment, (n,)."""
        rows = np.concatenate(self._rows) if self._rows else np.empty((0, len(COLUMN)))
        sampled = (rows[:, COLUMN["call"]].astype(int) & IDLE) == 0
        return np.asarray(rows[sampled, COLUMN["position_m"]][-round(_MEAN_S * _RATE_HZ) :])


def find_surface(url: str, keys: Device, touched: Callable[[int], None]) -> Surface:
    """Let a person touch the surface with the tool, three times; the device gives no force.

    keys: the scene's [device]; its own surface does not count. touched: called with the number of
    each touch, from 1; returns when the tool is there. Raises SpringpotError where the device
    fails, the tool moves, or the touches differ.
    """
    steps = press_step_functions(np.zeros(1), _NO_FORCE_N, OPEN_LOOP)
    settings = LoopSettings(1 / _RATE_HZ, _LONGEST_S, _NO_FORCE_N)
    required = requirements_of(keys, rate_hz=_RATE_HZ, watchdog_s=_WATCHDOG_S, max_n=_NO_FORCE_N,
                               examined=True)  # fmt: skip
    newest = _Newest()
    runner = SessionRunner(steps, url, required, settings, log=newest, reconnect_s=0.0)
    places_m = []
    try:
        runner.start()
        for number in range(1, TOUCHES + 1):
            touched(number)
            runner.wait(1.5 * _MEAN_S)
            if runner.over:
                break
            places_m.append(_place_m(newest.position_m(), url))
    finally:
        runner.close()
    line, error = runner.why()
    if error is not None or len(places_m) < TOUCHES:
        raise error or SpringpotError(f"{url}: {line}")
    spread_m = max(places_m) - min(places_m)
    if spread_m > _SAME_M:
        found = ", ".join(f"{1e3 * place_m:.2f}" for place_m in places_m)
        raise SpringpotError(
            f"{url}: the touches are at {found} mm, more than {1e3 * _SAME_M:g} mm from each "
            "other: touch the same place, lightly"
        )
    return Surface(1e-3 * keys.surface_mm + float(np.median(places_m)), spread_m)


def _place_m(position_m: Samples, url: str) -> float:
    if not len(position_m) or not np.isfinite(position_m).all():
        raise SpringpotError(f"{url}: no positions come: `springpot doctor --device {url}`")
    if np.ptp(position_m) > _STILL_M:
        raise SpringpotError(
            f"{url}: the tool moved by {1e3 * np.ptp(position_m):.2f} mm while it was measured: "
            "keep it still on the surface until the next line"
        )
    return float(position_m.mean())
