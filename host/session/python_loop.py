"""The same loop as a plain thread of Python: for debugging, other systems, and python-can.

It calls the same C for links and scene; what differs is who keeps the time. Other threads of Python
delay it: `make bench-host` shows by how much.
"""

import threading
import time
from collections import deque
from dataclasses import replace
from typing import Any

import numpy as np

from springpot.codegen.reference.tick import LATCHED
from springpot.host.devices.device import Device
from springpot.host.native.loop_library import (
    COLUMN,
    COLUMNS,
    IDLE,
    NONE,
    RESET,
    SILENT,
    UNSENT,
    Rows,
    Stop,
    empty_rows,
)
from springpot.host.session.loop import LinkCounts, LoopSettings, LoopState
from springpot.host.session.python_link import ENDED, GONE, TRIPPED, CLink, PythonLink
from springpot.host.session.step_functions import Engine

_FIRST_SAMPLE_S, _ARMING_S = 0.2, 1.0
_FLIGHT_ROWS = 1 << 15


class PythonLoop:
    """A thread of Python with the methods of `CLoop`."""

    name = "Python thread"

    def __init__(self, engine: Engine, settings: LoopSettings) -> None:
        self._engine, self._settings = engine, settings
        ffi = engine.library.ffi
        self._step = ffi.cast("int (*)(void *, sp_real, sp_real, sp_real *)", engine.step)
        self._idle = ffi.cast("int (*)(void *, sp_real, sp_real *)", engine.idle)
        self._reset = ffi.cast("void (*)(void *)", engine.reset)
        self._scene = ffi.cast("void *", engine.state)
        self._measured = ffi.cast("double *", engine.measured_n) if engine.measured_n else None
        self._force = ffi.new("sp_real *")
        self._real = np.float32 if ffi.sizeof("sp_real") == 4 else np.float64
        self._state = LoopState()
        self._links: list[PythonLink] = []
        self._kept: list[Any] = []
        self._next: Any = None
        self._link: PythonLink | None = None
        self._want_stop = self._want_pause = self._want_reset = self._reset_next = False
        self._rows: deque[list[float]] = deque()
        self._flight: deque[list[float]] = deque(maxlen=_FLIGHT_ROWS)
        self._row = [0.0] * len(COLUMNS)
        self._arming_s = 0.0  # since when the device was asked to be ready; 0: it is
        self._thread: threading.Thread | None = None

    def start(self, device: Device) -> None:
        """Start the thread."""
        self._link = self._adopt(device)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def attach(self, device: Device) -> None:
        """Go on with a device that came back."""
        self._next = self._adopt(device)

    def ask_stop(self) -> None:
        """End with zero force."""
        self._want_stop = True

    def pause(self, paused: bool) -> None:
        """Zero force, and no calls until it is resumed."""
        self._want_pause = paused

    def reset(self) -> None:
        """Reset the scene, and a device that tripped."""
        self._want_reset = True

    def look(self) -> LoopState:
        """Counters and flags."""
        return self._state

    def counts(self) -> LinkCounts:
        """Counters of all links that this session had."""
        names = LinkCounts.__dataclass_fields__
        return LinkCounts(**{n: sum(getattr(link, n) for link in self._links) for n in names})

    def drain(self) -> Rows:
        """Rows since the last call."""
        rows = [self._rows.popleft() for _ in range(len(self._rows))]
        return np.array(rows) if rows else empty_rows()

    def flight(self, seconds: float) -> Rows:
        """The last rows again, after the end."""
        rows = list(self._flight)[-int(seconds / self._settings.period_s) - 1 :]
        return np.array(rows) if rows else empty_rows()

    def join(self) -> None:
        """Wait for the end of the thread."""
        if self._thread is not None:
            self._thread.join()

    def _adopt(self, device: Device) -> PythonLink:
        link = device.link(self._engine.library)
        if not hasattr(link, "listen"):
            link = CLink(link, self._engine.library.ffi)
        self._links.append(link)
        self._kept.append(device)
        found: PythonLink = link
        return found

    def _tell(self, **changes: Any) -> None:
        self._state = replace(self._state, **changes)

    def _run(self) -> None:
        try:
            self._tick_on()
        finally:
            for _ in range(3):
                if self._link is not None and self._link.write(0.0) == GONE:
                    self._lose()
            self._tell(over=1)

    def _tick_on(self) -> None:
        period_s = self._settings.period_s
        begin_s = deadline_s = time.monotonic()
        if self._link is not None and not self._link.ready:
            self._make_ready(self._link)
        if fresh := self._listen(deadline_s + _FIRST_SAMPLE_S):
            begin_s = deadline_s = time.monotonic()
        while not self._state.reason:
            made = self._link is not None and self._link.made
            behind = not made and time.monotonic() - deadline_s >= period_s
            if not behind and not fresh:
                until_s = deadline_s + period_s / 4
                if (left := deadline_s - time.monotonic()) > 0:
                    time.sleep(left)
                fresh = self._listen(until_s)
            self._accept_wishes()
            if self._state.reason:
                break
            self._tick(begin_s, deadline_s, fresh and not behind, behind)
            fresh = fresh and behind
            deadline_s += period_s
            seconds = self._settings.seconds
            if not self._state.reason and seconds and deadline_s - begin_s >= seconds:
                self._tell(reason=Stop.TIME)

    def _listen(self, until_s: float) -> bool:
        if self._link is None:
            return False
        count = self._link.listen(until_s)
        if count == GONE:
            self._lose()
        elif count == TRIPPED:
            self._trip()
        elif count == ENDED:
            self._tell(reason=Stop.ENDED)
        return bool(count > 0)

    def _make_ready(self, link: PythonLink) -> None:
        link.reset()
        self._arming_s = 0.0 if link.ready else time.monotonic()

    def _at_work(self) -> bool:
        """Whether the scene may be called: no force reaches a device that is not ready."""
        if self._arming_s and self._link is not None:
            if self._link.ready:
                self._arming_s = 0.0
            elif time.monotonic() - self._arming_s > _ARMING_S:
                self._arming_s = 0.0
                self._trip()
        return not (self._state.paused or self._state.tripped or self._arming_s)

    def _lose(self) -> None:
        self._link = None
        kept = int(self._state.latched or self._state.tripped)
        self._tell(kept_trip=kept, connected=0, disconnects=self._state.disconnects + 1)

    def _trip(self) -> None:
        if not self._state.tripped:
            self._tell(tripped=1, watchdog_trips=self._state.watchdog_trips + 1)

    def _accept_wishes(self) -> None:
        if self._next is not None:
            self._link, self._next = self._next, None
            self._reset_next = self._reset_next or not self._state.kept_trip
            self._tell(connected=1, tripped=int(self._state.tripped and self._state.kept_trip))
            self._arming_s = 0.0
            if not self._link.ready:
                self._make_ready(self._link)
        if self._want_reset:
            self._want_reset, self._reset_next = False, True
            self._tell(tripped=0)
            if self._link is not None:
                self._make_ready(self._link)
        if self._state.paused and not self._want_pause:
            self._reset_next = True
        if self._state.paused != self._want_pause:
            self._tell(paused=int(self._want_pause))
        if self._want_stop:
            self._tell(reason=Stop.ASKED)

    def _tick(self, begin_s: float, deadline_s: float, fresh: bool, behind: bool) -> None:
        row, now_s = self._row, time.monotonic()
        link = self._link
        row[COLUMN["time_s"]] = now_s - begin_s
        row[COLUMN["lateness_s"]] = now_s - deadline_s
        row[COLUMN["dt_s"]] = float(self._real(self._settings.period_s))
        row[COLUMN["tick_s"]] = row[COLUMN["notes"]] = 0.0
        row[COLUMN["age_s"]] = now_s - link.arrived_s if fresh and link else np.nan
        row[COLUMN["measured_n"]] = link.measured_n if link else np.nan
        if not self._at_work():
            call, row[COLUMN["returned_n"]] = NONE, 0.0
        else:
            call = self._call(fresh)
        self._check_limits()
        row[COLUMN["call"]] = self._send(call, behind)
        state = self._state
        self._tell(
            ticks=state.ticks + 1,
            stale=state.stale + (not fresh),
            late=state.late + (now_s - deadline_s > self._settings.period_s),
            newest_row=state.newest_row + 1,
            elapsed_s=time.monotonic() - begin_s,
        )
        self._rows.append(row.copy())
        self._flight.append(row.copy())

    def _call(self, fresh: bool) -> int:
        row, call = self._row, 0
        if self._reset_next:
            self._reset(self._scene)
            self._reset_next = False
            self._tell(resets=self._state.resets + 1)
            call |= RESET
        self._force[0] = row[COLUMN["returned_n"]]
        begin_s = time.perf_counter()
        link = self._link
        if fresh and link is not None:
            x, v = float(self._real(link.position_m)), float(self._real(link.velocity_mps))
            if self._measured is not None:
                self._measured[0] = link.measured_n
            notes = self._step(self._scene, x, v, self._force)
            row[COLUMN["position_m"]], row[COLUMN["velocity_mps"]] = x, v
        else:
            call |= IDLE
            notes = self._idle(self._scene, self._settings.period_s, self._force)
        row[COLUMN["tick_s"]] = time.perf_counter() - begin_s
        row[COLUMN["notes"]] = notes
        row[COLUMN["returned_n"]] = self._force[0]
        latched = int(notes >= 0 and bool(notes & LATCHED))
        if latched != self._state.latched:
            trips = self._state.watchdog_trips + latched
            self._tell(latched=latched, watchdog_trips=trips)
        if notes < 0:
            self._tell(reason=Stop.MISUSE)
        return call

    def _check_limits(self) -> None:
        row, settings = self._row, self._settings
        if self._state.reason or not self._at_work():
            return
        measured_n = row[COLUMN["measured_n"]]
        force_n = max(abs(row[COLUMN["returned_n"]]), abs(np.nan_to_num(measured_n)))
        if not force_n <= settings.max_force_n:
            self._tell(reason=Stop.FORCE)
        elif row[COLUMN["position_m"]] > settings.max_depth_m:
            self._tell(reason=Stop.DEPTH)

    def _send(self, call: int, behind: bool) -> int:
        force_n = self._row[COLUMN["returned_n"]]
        if self._state.reason or not self._at_work():
            force_n = 0.0
            call |= SILENT
        put = 1 if self._link is None or behind else self._link.write(force_n)
        if put == GONE:
            self._lose()
        elif put == TRIPPED:
            self._trip()
        if put == 0:
            self._row[COLUMN["sent_n"]] = force_n
            return call
        return call | UNSENT
