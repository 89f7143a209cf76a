"""A loop on a device with its log: what rendering and recording have in common."""

import contextlib
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from springpot.codegen.entry_points import blame_package
from springpot.codegen.errors import DeviceError, SpringpotError, UsageError
from springpot.codegen.messages import short_repr
from springpot.host.devices.device import RECONNECT_S, DeviceRequirements
from springpot.host.devices.drivers import open_device
from springpot.host.native.c_library import COLUMN, IDLE, NONE, LoopRows, Stop, empty_rows
from springpot.host.output import print_line
from springpot.host.session.c_loop import CLoop, StepFunctions
from springpot.host.session.outcome import (
    BY_USER,
    LinkCounts,
    LoopSettings,
    LoopState,
    percentiles_us,
)
from springpot.host.session.supervisor import DeviceSupervisor

_DRAIN_S = 0.02
_FIRST_SAMPLE_S = 0.2  # no device takes longer for it
TakeRows = Callable[[LoopRows], None]


@dataclass(frozen=True)
class Progress:
    """Live state of a session: rate_hz over the last moment, the newest row, counters."""

    elapsed_s: float
    rate_hz: float
    depth_m: float
    force_n: float
    age_s: float
    state: LoopState
    __repr__ = short_repr


class SessionRunner:
    """A loop on a device: what rendering and recording have in common.

    takers: get the rows as they come, until one raises, which ends the loop.
    """

    _loop: CLoop
    _supervisor: DeviceSupervisor

    def __init__(
        self,
        steps: StepFunctions,
        url: str,
        requirements: DeviceRequirements,
        settings: LoopSettings,
        takers: Sequence[TakeRows] = (),
        reconnect_s: float = RECONNECT_S,
        report: Callable[[str], None] = print_line,
    ) -> None:
        """Keep what the loop calls and who takes its rows; the device is opened later."""
        self.url, self.settings = url, settings
        self._steps, self._requirements, self._reconnect_s = steps, requirements, reconnect_s
        self._takers, self._report = list(takers), report
        self.error: SpringpotError | None = None
        self._drain_thread: threading.Thread | None = None
        self._latest = empty_rows(1)
        self._lateness_s = [np.zeros(0, dtype=np.float32)]
        self._ticks_s = [np.zeros(0, dtype=np.float32)]
        self._stopped = False

    def open(self) -> None:
        """Open the device. Raises DeviceError where it cannot be used."""
        device = open_device(self.url, self._requirements)
        self._loop = CLoop(self._steps, self.settings)
        self._supervisor = DeviceSupervisor(
            self._loop, device, self.url, self._requirements, self._reconnect_s, self._report,
            self._fail,
        )  # fmt: skip

    def __enter__(self) -> Self:
        self.open()
        return self

    def __exit__(self, *error: Any) -> None:
        self.close()

    def start(self) -> None:
        """Begin ticking; returns at once."""
        if self._drain_thread is not None:
            raise UsageError("this session was started already: make a new one")
        if "_loop" not in vars(self):
            raise UsageError("this session is not open: use it in a with statement")
        self._loop.start(self._supervisor.device)
        self._drain_thread = threading.Thread(target=self._drain, daemon=True)
        self._drain_thread.start()

    def sense(self, measured_n: float) -> None:
        """A sensor beside the device measured this, just now; from any thread."""
        self._loop.sense(measured_n)

    def pause(self) -> None:
        """Zero force until `resume`; the device stays in use."""
        self._loop.pause(True)

    def resume(self) -> None:
        """Go on: the scene is reset, the force rises from zero."""
        self._loop.pause(False)

    def reset(self) -> None:
        """Forget the past and unlatch, also in the device; the force rises from zero."""
        self._loop.reset()

    def wait(self, seconds: float | None = None) -> None:
        """Sleep until the loop has ended by itself, or for so many seconds at most."""
        if self._drain_thread is not None:
            self._drain_thread.join(seconds)

    def stop(self) -> None:
        """End with zero force, and wait for that."""
        if self._stopped:
            return
        if self._drain_thread is not None:
            self._loop.ask_stop()
            self._loop.join()
            self._drain_thread.join()
        device = self._supervisor.device
        with blame_package(f"{type(device).__name__}.stop", type(device), DeviceError):
            device.stop()
        self._stopped = True

    def close(self) -> None:
        """Stop with zero force, and free the port, even if Ctrl-C comes again meanwhile."""
        try:
            while not self._stopped:
                with contextlib.suppress(KeyboardInterrupt):
                    self.stop()
        finally:
            device = self._supervisor.device
            with blame_package(f"{type(device).__name__}.close", type(device), DeviceError):
                device.close()

    @property
    def over(self) -> bool:
        return bool(self._drain_thread is not None and not self._drain_thread.is_alive())

    @property
    def device_failure(self) -> str:
        """Reason why the device is gone or off, if one is known; else empty."""
        return self._supervisor.device.failure

    @property
    def state(self) -> LoopState:
        return self._loop.get_status()

    @property
    def counts(self) -> LinkCounts:
        return self._loop.counts()

    def watch(self, every_s: float = 0.1) -> Iterator[Progress]:
        """Yield progress until the loop ends."""
        before, before_s = 0, 0.0
        while not self.over:
            time.sleep(every_s)
            state, row = self.state, self._latest[-1]
            passed_s = max(1e-9, state.elapsed_s - before_s)
            yield Progress(
                elapsed_s=state.elapsed_s,
                rate_hz=(state.ticks - before) / passed_s,
                depth_m=float(row[COLUMN["position_m"]]),
                force_n=float(row[COLUMN["sent_n"]]),
                age_s=float(row[COLUMN["age_s"]]),
                state=state,
            )
            before, before_s = state.ticks, state.elapsed_s

    def why(self, asked_by: str = BY_USER) -> tuple[str, SpringpotError | None]:
        """One line: why it stopped and what to do; the error, where it was one.

        asked_by: who ended it, where it did not end by itself.
        """
        if self.error is not None:
            return str(self.error), self.error
        state, settings, row, line = self.state, self.settings, self._latest[-1], ""
        match state.reason:
            case Stop.FORCE:
                force_n = np.fmax(abs(row[COLUMN["returned_n"]]), abs(row[COLUMN["measured_n"]]))
                line = (
                    f"the force reached {force_n:.3g} N, the limit is {settings.max_force_n:g} N: "
                    "raise --max-force-n, or press less"
                )
            case Stop.DEPTH:
                line = (
                    f"the tool came {1e3 * row[COLUMN['position_m']]:.3g} mm deep, the limit is "
                    f"{1e3 * settings.max_depth_m:g} mm: raise --max-depth-mm, or press less"
                )
            case Stop.RATE:
                line = (
                    f"for a fifth of the last 100 periods of {1e3 * settings.period_s:g} ms no "
                    f"sample came, force zero: {self._supervisor.device.rate_advice}"
                )
            case Stop.MISUSE:
                line = "the scene refused its arguments: report this"
        if line:
            kind = DeviceError if state.reason == Stop.RATE else SpringpotError
            return f"stopped: {line}", kind(f"stopped: {line}")
        ends = {
            Stop.BUTTON: "stopped by the device's button",
            Stop.TIME: f"ran for {settings.seconds:g} s",
            Stop.ENDED: "the replay has no more samples",
        }
        fault = self.fault()
        if not fault and (state.latched or state.tripped):
            fault = (
                "the watchdog had tripped and the force was zero: the key r (reset) takes it back"
            )
        return "; ".join(filter(None, (ends.get(Stop(state.reason), asked_by), fault))), None

    def fault(self) -> str:
        """Say why the session ended without the device and what to do; empty if it was there."""
        state = self.state
        if not self.counts.samples and state.elapsed_s > _FIRST_SAMPLE_S:
            return "no sample ever came, the force was zero: check cable and power"
        return "" if state.connected else "the device was gone: plug it in and start again"

    def spreads_us(self) -> dict[str, dict[str, float]]:
        """Percentiles and maximum: how late ticks began, and how long the calls took, us."""
        times_s = {"lateness_us": self._lateness_s, "tick_us": self._ticks_s}
        return {name: percentiles_us(np.concatenate(parts)) for name, parts in times_s.items()}

    def scheduler(self) -> str:
        """Who keeps the time, and what the system granted for it."""
        return self._loop.scheduler()

    def _drain(self) -> None:
        """Thread beside the loop: hand rows on, look after the device, end at an error."""
        reported = False
        while True:
            before = self._loop.get_status()
            try:
                self._take(self._loop.drain(), before.elapsed_s)
            except SpringpotError as error:
                self._fail(error)
            except OSError as error:
                self._fail(DeviceError(f"the log cannot go on ({error}): stopped, force zero"))
            if before.over:
                return
            state = self._loop.get_status()
            if state.ticks and not reported:
                reported = True
                if refused := self._loop.refused():
                    self._report(refused)
            self._supervisor.poll(state, before.elapsed_s)
            time.sleep(_DRAIN_S)

    def _take(self, rows: LoopRows, heard_s: float) -> None:
        """Hand new rows to the takers, and keep what timing and progress need of them."""
        if not len(rows):
            return
        self._latest = rows[-1:]
        self._lateness_s.append(rows[:, COLUMN["lateness_s"]].astype(np.float32))
        called = (rows[:, COLUMN["call"]].astype(int) & (IDLE | NONE)) == 0
        self._ticks_s.append(rows[called, COLUMN["tick_s"]].astype(np.float32))
        if np.isfinite(rows[:, COLUMN["age_s"]]).any():
            self._supervisor.saw_sample(heard_s)
        for take in self._takers:
            if self.error is None:
                take(rows)

    def _fail(self, error: SpringpotError) -> None:
        if self.error is None:
            self.error = error
        self._loop.ask_stop()
