"""Excitations on a real device: the loop of a session, with the exciting C in place of a scene."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from springpot import Device, DeviceError
from springpot.console import reading_keys
from springpot.devices import trip_error
from springpot.host.wings.lab.identification.excitation import (
    WATCHDOG_S,
    Excitation,
    MoveLimits,
    excite_step_functions,
)
from springpot.loop import (
    COLUMN,
    NONE,
    LoopRows,
    LoopSettings,
    Progress,
    SessionRunner,
    empty_rows,
    requirements_of,
)

_MORE_S = 1.0
_REST_S = 0.3  # after a run
_BEYOND = 1.5  # of the travel limit: the loop's own, behind that of the C that excites


class FreeSession:
    """Plays excitations on the device of a URL; each opens it anew."""

    def __init__(
        self,
        url: str,
        keys: Device,
        on_progress: Callable[[Progress], None] = lambda _progress: None,
    ) -> None:
        """keys: of the scene, for the drives that need some."""
        self.max_n: float | None = None
        self._url, self._keys, self._on_progress = url, keys, on_progress
        self._start_m: float | None = None

    def __call__(self, excitation: Excitation, limits: MoveLimits) -> tuple[LoopRows, Any]:
        """Play one. Raises DeviceError where the device fails, KeyboardInterrupt on q."""
        steps, excite = excite_step_functions(excitation, limits)
        count = len(excitation.command)
        settings = LoopSettings(
            period_s=excitation.dt_s,
            seconds=count * excitation.dt_s + _MORE_S,
            max_force_n=limits.max_force_n,
            max_depth_m=np.inf if self._start_m is None
            else self._start_m + _BEYOND * limits.max_travel_m,
        )  # fmt: skip
        requirements = requirements_of(
            self._keys,
            rate_hz=1 / excitation.dt_s,
            watchdog_s=WATCHDOG_S,
            max_n=limits.max_force_n,
            free=True,
        )
        played = _Played(count)
        runner = SessionRunner(
            steps, self._url, requirements, settings, log=played, reconnect_s=0.0
        )
        try:
            self.max_n = runner.max_n
            runner.start()
            self._watch(runner, played, excite)
        finally:
            runner.close()
        line, error = runner.why()
        if error is not None and not (excite.latched or played.full):
            raise error
        rows = played.rows
        if not (excite.latched or excite.seen or played.full):
            raise DeviceError(f"{self._url}: the test did not come to its end: {line}")
        if len(rows):
            self._start_m = float(rows[0, COLUMN["position_m"]])
        time.sleep(_REST_S)
        return rows, excite

    def _watch(self, runner: SessionRunner, played: "_Played", excite: Any) -> None:
        with reading_keys() as keys:
            for progress in runner.watch(0.05):
                self._on_progress(progress)
                if set(keys.pressed()) & set("q \x1b"):
                    raise KeyboardInterrupt
                if progress.state.tripped and not played.full:
                    raise trip_error(self._url, progress.state)
                if played.full or excite.latched or excite.at >= excite.n:
                    runner.stop()


class _Played:
    """Rows of one run, from the first call on."""

    def __init__(self, count: int) -> None:
        self._count, self._parts, self._taken = count, [empty_rows()], 0

    @property
    def full(self) -> bool:
        return self._taken >= self._count

    @property
    def rows(self) -> LoopRows:
        return np.concatenate(self._parts)[: self._count]

    def append(self, rows: LoopRows) -> None:
        calls = rows[:, COLUMN["call"]].astype(int)
        rows = rows[(calls & NONE) == 0] if not self._taken else rows
        self._parts.append(rows.copy())
        self._taken += len(rows)
