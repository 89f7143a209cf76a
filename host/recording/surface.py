"""Where the object's surface is, in the device's own counting: the tool touches it, force zero."""

from collections.abc import Callable

import numpy as np

from springpot.codegen.errors import SpringpotError, UsageError
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import driver_of, parse_device
from springpot.host.native.c_library import COLUMN, IDLE, LoopRows
from springpot.host.recording.indentation import OPEN_LOOP, press_step_functions
from springpot.host.session.outcome import LoopSettings
from springpot.host.session.runner import SessionRunner

TOUCHES = 3
_RATE_HZ, _WATCHDOG_S, _LONGEST_S, _MEAN_S = 1000.0, 0.02, 600.0, 0.3
_STILL_M = 0.2e-3  # the tool moves no more than this while it is measured
_SAME_M = 1.0e-3  # three touches of one surface
_NO_FORCE_N = 1e-3


def find_surface(url: str, touched: Callable[[int], None]) -> float:
    """Let a person touch the surface with the tool, three times; return where it is, mm.

    touched: called with the number of each touch, from 1; returns when the tool is there. The
    device gives no force. Raises UsageError for a device or a URL that has its surface already,
    SpringpotError where the device fails, the tool moves, or the touches differ.
    """
    if driver_of(url).virtual:
        raise UsageError(f"{url}: its surface is at 0: leave --find-surface out")
    if "surface_mm" in parse_device(url).settings:
        raise UsageError(f"{url}: leave surface_mm out of the URL, or --find-surface")
    steps = press_step_functions(np.zeros(1), _NO_FORCE_N, OPEN_LOOP)
    settings = LoopSettings(1 / _RATE_HZ, _LONGEST_S, _NO_FORCE_N)
    required = DeviceRequirements(_RATE_HZ, _WATCHDOG_S, _NO_FORCE_N, examined=True)
    newest, places_m = _Newest(), []
    runner = SessionRunner(steps, url, required, settings, [newest.append], reconnect_s=0.0)
    runner.open()
    try:
        runner.start()
        for number in range(1, TOUCHES + 1):
            touched(number)
            runner.wait(1.5 * _MEAN_S)
            if runner.over:
                break
            places_m.append(newest.place_m(url))
    finally:
        runner.close()
    line, error = runner.why()
    if error is not None or len(places_m) < TOUCHES:
        raise error or SpringpotError(f"{url}: {line}")
    if max(places_m) - min(places_m) > _SAME_M:
        found = ", ".join(f"{1e3 * place_m:.2f}" for place_m in places_m)
        raise SpringpotError(
            f"{url}: the touches are at {found} mm, more than {1e3 * _SAME_M:g} mm from each "
            "other: touch the same place, lightly"
        )
    return round(1e3 * float(np.median(places_m)), 3)


class _Newest:
    """The last rows of a loop."""

    def __init__(self) -> None:
        self._rows: list[LoopRows] = []

    def append(self, rows: LoopRows) -> None:
        self._rows = [*self._rows[-20:], rows]

    def place_m(self, url: str) -> float:
        """Return where the tool is held still."""
        rows = np.concatenate(self._rows) if self._rows else np.empty((0, len(COLUMN)))
        sampled = (rows[:, COLUMN["call"]].astype(int) & IDLE) == 0
        position_m = rows[sampled, COLUMN["position_m"]][-round(_MEAN_S * _RATE_HZ) :]
        if not len(position_m) or not np.isfinite(position_m).all():
            raise SpringpotError(f"{url}: no positions come: check its power and cable")
        if np.ptp(position_m) > _STILL_M:
            raise SpringpotError(
                f"{url}: the tool moved by {1e3 * np.ptp(position_m):.2f} mm while it was "
                "measured: keep it still on the surface until the next line"
            )
        return float(position_m.mean())
