"""A real-time session: `with Session(folder, url, log=file) as s: s.start(); ...`.

A loop (a C thread by default) keeps the time; Python watches it, writes the log, and brings back a
device that was unplugged. However the session is left, the force is zero first.
"""

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal, Protocol, Self

import numpy as np

from springpot.codegen.scene import Device as DeviceKeys
from springpot.host.board_loop import BoardLoop
from springpot.host.device import Device, Wanted
from springpot.host.devices import open_device
from springpot.host.emission import read_emission
from springpot.host.engine import Engine, scene_engine
from springpot.host.library import SceneLibrary
from springpot.host.loop import CLoop, LinkCounts, Loop, LoopSettings, LoopState
from springpot.host.loop_library import (
    COLUMN,
    GOT_CPU,
    GOT_FIFO,
    GOT_LOCKED,
    GOT_SLACK,
    IDLE,
    NONE,
    Rows,
    empty_rows,
)
from springpot.host.output import say
from springpot.host.python_loop import PythonLoop
from springpot.host.serial_device import SerialDevice
from springpot.host.session_log import SessionLog, flight_seconds, write_flight
from springpot.runtime_c.errors import DeviceError, SpringpotError, UsageError
from springpot.trainer.recording import Zero

LoopKind = Literal["c", "python"]
RECONNECT_S = 10.0
_PUMP_S, _RETRY_S = 0.02, 0.05
_TIME, _ENDED, _MISUSE, _CLOCK = 2, 5, 6, 7


@dataclass(frozen=True)
class Progress:
    """What a person watches: rate_hz over the last moment, the newest row, counters."""

    elapsed_s: float
    rate_hz: float
    depth_m: float
    force_n: float
    age_s: float
    state: LoopState


class RowTaker(Protocol):
    """Where the rows of a loop go."""

    def append(self, rows: Rows) -> None:
        """Take the next rows."""
        ...


class Running:
    """A loop on a device with its log: what rendering and recording have in common."""

    def __init__(
        self,
        engine: Engine,
        url: str,
        wanted: Wanted,
        settings: LoopSettings,
        log: RowTaker | None = None,
        kind: LoopKind = "c",
        reconnect_s: float = RECONNECT_S,
        tell: Callable[[str], None] = say,
    ) -> None:
        self.url, self._wanted, self._settings = url, wanted, settings
        self._log, self._reconnect_s, self._tell = log, reconnect_s, tell
        self._device: Device = open_device(url, wanted)
        if getattr(self._device, "only_python", False):
            kind = "python"
        self._loop: Loop
        if isinstance(self._device, SerialDevice) and self._device.renders:
            self._loop = BoardLoop(self._device, settings)
        else:
            self._loop = (CLoop if kind == "c" else PythonLoop)(engine, settings)
        self.loop_name = self._loop.name
        self.error: SpringpotError | None = None
        self._pump: threading.Thread | None = None
        self._latest = empty_rows(1)
        self._lateness: list[Any] = []
        self._ticks_s: list[Any] = []
        self._fresh_s = time.monotonic()
        self._returning: threading.Thread | None = None
        self._told_trips = 0
        self._stopped = False

    def start(self) -> None:
        """Start the loop."""
        if self._pump is not None:
            raise UsageError("this session was started already: make a new one")
        self._loop.start(self._device)
        self._fresh_s = time.monotonic()
        self._pump = threading.Thread(target=self._run_pump, daemon=True)
        self._pump.start()

    def pause(self) -> None:
        """Zero force until `resume`; the device stays in use."""
        self._loop.pause(True)

    def resume(self) -> None:
        """Go on: the scene is reset, the force rises from zero."""
        self._loop.pause(False)

    def reset(self) -> None:
        """Forget the past and unlatch, also in the device; the force rises from zero."""
        self._loop.reset()

    def stop(self) -> None:
        """End with zero force, and wait for that."""
        if self._stopped:
            return
        if self._pump is not None:
            self._loop.ask_stop()
            self._loop.join()
            self._pump.join()
        self._device.stop()
        self._stopped = True

    def close(self) -> None:
        """Stop, and free the port; an impatient second Ctrl-C does not get in between."""
        try:
            while not self._stopped:
                with contextlib.suppress(KeyboardInterrupt):
                    self.stop()
        finally:
            self._device.close()

    @property
    def over(self) -> bool:
        """Whether the loop has ended by itself."""
        return bool(self._pump is not None and not self._pump.is_alive())

    @property
    def state(self) -> LoopState:
        """Counters and flags of the loop."""
        return self._loop.look()

    @property
    def counts(self) -> LinkCounts:
        """Counters of the links."""
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

    def why(self) -> tuple[str, SpringpotError | None]:
        """Return one line: why it stopped and what to do; the error, where it was one."""
        if self.error is not None:
            return str(self.error), self.error
        state, row, settings = self.state, self._latest[-1], self._settings
        match state.reason:
            case 2:
                line = f"ran for {settings.seconds:g} s"
            case 3:
                force_n = max(
                    abs(row[COLUMN["returned_n"]]), np.nan_to_num(abs(row[COLUMN["measured_n"]]))
                )
                line = (
                    f"stopped: the force reached {force_n:.3g} N, the limit is "
                    f"{settings.max_force_n:g} N: raise --max-force-n, or press less"
                )
                return line, SpringpotError(line)
            case 4:
                line = (
                    f"stopped: the tool came {1e3 * row[COLUMN['position_m']]:.3g} mm deep, the "
                    f"limit is {1e3 * settings.max_depth_m:g} mm: raise --max-depth-mm, or press "
                    "less"
                )
                return line, SpringpotError(line)
            case 5:
                line = "the replay has no more samples"
            case 6:
                line = "stopped: the scene refused its arguments: report this"
                return line, SpringpotError(line)
            case _:
                line = "stopped by the user"
        if state.latched or state.tripped:
            line += "; the watchdog had tripped and the force was zero: `reset` takes it back"
        return line, None

    def flight(self) -> Rows:
        """The last seconds of rows, after the end."""
        return self._loop.flight(flight_seconds())

    def lateness_s(self) -> Any:
        """Lateness of every tick, (n,)."""
        return np.concatenate(self._lateness) if self._lateness else np.zeros(1)

    def ticks_s(self) -> Any:
        """Time of every call, (n,)."""
        return np.concatenate(self._ticks_s) if self._ticks_s else np.zeros(1)

    def scheduler(self) -> str:
        """What the system granted the loop, and what to do where it refused."""
        if self.loop_name != CLoop.name:
            return self.loop_name + (", SCHED_OTHER" if self.loop_name != BoardLoop.name else "")
        got = self.state.got
        named = [
            name
            for bit, name in ((GOT_LOCKED, "memory locked"), (GOT_CPU, "own CPU"),
                              (GOT_SLACK, "1 ns timer slack"))
            if got & bit
        ]  # fmt: skip
        policy = "SCHED_FIFO" if got & GOT_FIFO else "SCHED_OTHER"
        return ", ".join([self.loop_name, policy, *named])

    def _run_pump(self) -> None:
        told = False
        while True:
            over = bool(self._loop.look().over)
            try:
                self._take(self._loop.drain())
            except SpringpotError as error:
                self._fail(error)
            except OSError as error:
                self._fail(DeviceError(f"the log cannot go on ({error}): stopped, force zero"))
            if over:
                return
            state = self._loop.look()
            if state.ticks and not told:
                told = True
                self._tell_refused(state)
            self._mind(state)
            time.sleep(_PUMP_S)

    def _take(self, rows: Rows) -> None:
        if not len(rows):
            return
        self._latest = rows[-1:]
        self._lateness.append(rows[:, COLUMN["lateness_s"]].astype(np.float32))
        called = (rows[:, COLUMN["call"]].astype(int) & (IDLE | NONE)) == 0
        self._ticks_s.append(rows[called, COLUMN["tick_s"]].astype(np.float32))
        if np.isfinite(rows[:, COLUMN["age_s"]]).any():
            self._fresh_s = time.monotonic()
        if self._log is not None and self.error is None:
            self._log.append(rows)

    def _mind(self, state: LoopState) -> None:
        """Look after the device: gone, silent, tripped."""
        if not state.connected:
            if self._returning is None:
                self._returning = threading.Thread(target=self._bring_back, daemon=True)
                self._returning.start()
            return
        if state.watchdog_trips > self._told_trips:
            self._told_trips = state.watchdog_trips
            if state.tripped:
                error = self.counts.device_error
                said = f" (its error 0x{error:x})" if error else ""
                self._tell(
                    f"the device switched its motor off{said}: force zero until reset (r), or stop"
                )
            else:
                self._tell("no sample for the watchdog's time: force zero until reset (r), or stop")
        silent_s = time.monotonic() - self._fresh_s
        if silent_s > (self._reconnect_s or 1.0) and not state.paused and not state.tripped:
            self._fail(
                DeviceError(
                    f"{self.url}: connected but silent for {silent_s:.1f} s, force zero: restart "
                    "the device"
                )
            )

    def _bring_back(self) -> None:
        """Open the device again until the time for that is over; then the session ends."""
        if not self._device.comes_back or not self._reconnect_s:
            self._fail(DeviceError(f"{self.url}: gone, force zero, stopped: plug it in"))
            return
        begin_s = time.monotonic()
        self._tell(f"{self.url}: gone, force zero; waiting {self._reconnect_s:g} s for it")
        self._device.close()
        last: SpringpotError = DeviceError("")
        while time.monotonic() - begin_s < self._reconnect_s and not self._loop.look().over:
            try:
                device = open_device(self.url, self._wanted)
            except SpringpotError as error:
                last = error
                time.sleep(_RETRY_S)
                continue
            self._device = device
            self._loop.attach(device)
            while not self._loop.look().connected and not self._loop.look().over:
                time.sleep(0.001)
            state = self._loop.look()
            self._told_trips = state.watchdog_trips
            self._fresh_s = time.monotonic()
            then = (
                "force ramps in" if not state.kept_trip else "it had tripped before: reset with r"
            )
            self._tell(f"{self.url}: back after {time.monotonic() - begin_s:.2f} s, {then}")
            self._returning = None
            return
        self._fail(
            DeviceError(
                f"{self.url}: gone for {self._reconnect_s:g} s, force zero, stopped ({last}): plug "
                "it in and start again"
            )
        )

    def _fail(self, error: SpringpotError) -> None:
        if self.error is None:
            self.error = error
        self._loop.ask_stop()

    def _tell_refused(self, state: LoopState) -> None:
        if self.loop_name == CLoop.name and self._settings.real_time and not state.got & GOT_FIFO:
            self._tell(
                "the system refused SCHED_FIFO, ticks may be late: `springpot doctor` says how to "
                "allow it"
            )


class Session:
    """Render an emitted scene on a device.

    folder: of `springpot emit`. url: of the device. log: file to write, a recording with every
    call; beside it the flight recorder. seconds: 0, until `stop`. max_force_n, max_depth_m: beyond
    them the session ends. Raises DeviceError where the device cannot be used as the scene wants.
    """

    def __init__(
        self,
        folder: Path,
        url: str,
        log: Path | None = None,
        *,
        seconds: float = 0.0,
        max_force_n: float | None = None,
        max_depth_m: float | None = None,
        loop: LoopKind = "c",
        reconnect_s: float = RECONNECT_S,
        tell: Callable[[str], None] = say,
    ) -> None:
        plan, _ = read_emission(folder)
        self._scene = SceneLibrary(folder)
        greatest_n = max(float(plan.output.greatest_n), -float(plan.output.least_n))
        settings = LoopSettings(
            period_s=plan.dt_s,
            seconds=seconds,
            max_force_n=greatest_n if max_force_n is None else max_force_n,
            max_depth_m=float("inf") if max_depth_m is None else max_depth_m,
        )
        self._rate_hz, self._settings, self._tell = 1 / plan.dt_s, settings, tell
        wanted = wanted_of(
            plan.scene.device,
            rate_hz=1 / plan.dt_s,
            watchdog_s=float(plan.output.watchdog_s),
            greatest_n=min(greatest_n, settings.max_force_n),
            hash=self._scene.manifest["hash"],
        )
        self._zero: Zero = "none" if plan.contact else "first"
        self._file, self._url = log, url
        self._log: SessionLog | None = None
        self._args = (scene_engine(self._scene), url, wanted, settings)
        self._options: dict[str, Any] = {"kind": loop, "reconnect_s": reconnect_s, "tell": tell}
        self._run: Running | None = None
        self._steal_ms = steal_ms()
        self.line, self.error = "", None  # type: str, SpringpotError | None
        self.flight_file: Path | None = None

    def __enter__(self) -> Self:
        if self._file is not None:
            details = {"session": {"scene": self._scene.manifest["scene"], "device": self._url,
                                   "hash": self._scene.manifest["hash"]}}  # fmt: skip
            self._log = SessionLog(
                self._file, self._settings.period_s, self._url, details, zero=self._zero
            )
        try:
            self._run = Running(*self._args, log=self._log, **self._options)
        except BaseException:
            if self._log is not None:
                self._log.discard()
            raise
        return self

    def __exit__(self, *error: Any) -> None:
        run = self.running
        try:
            run.close()
        finally:
            self.line, self.error = run.why()
            if error[0] is not None and run.error is None:
                self.line = f"stopped by {error[0].__name__}"
            self._tell(self.line)
            self._close_log(run)

    @property
    def running(self) -> Running:
        """The running half: pause, resume, reset, watch."""
        assert self._run is not None, "use the session in a with statement"
        return self._run

    def start(self) -> None:
        """Start the loop."""
        self.running.start()

    def stop(self) -> None:
        """End with zero force."""
        self.running.stop()

    def pause(self) -> None:
        """Zero force until `resume`."""
        self.running.pause()

    def resume(self) -> None:
        """Go on, the force rising from zero."""
        self.running.resume()

    def reset(self) -> None:
        """Forget the past, unlatch."""
        self.running.reset()

    def result(self) -> dict[str, Any]:
        """Keys of `springpot run --json`, after the end."""
        run = self.running
        state, counts = run.state, run.counts
        planned = state.reason == _TIME
        expected_s = self._settings.seconds if planned else state.elapsed_s
        return {
            "ticks": state.ticks,
            "expected_ticks": round(expected_s * self._rate_hz),
            "late": state.late,
            "lateness_us": _spread_us(run.lateness_s()),
            "tick_us": _spread_us(run.ticks_s()),
            "steal_ms": steal_ms() - self._steal_ms,
            "ring_dropped": state.ring_dropped,
            "sequence_gaps": counts.sequence_gaps,
            "samples": counts.samples,
            "stale_samples": state.stale,
            "unsent": counts.unsent,
            "crc_errors": counts.crc_errors,
            "watchdog_trips": state.watchdog_trips,
            "disconnects": state.disconnects,
            "resets": state.resets,
            "latched": bool(state.latched or state.tripped),
            "log": str(self._file) if self._file is not None else None,
            "flight": str(self.flight_file) if self.flight_file is not None else None,
            "scheduler": run.scheduler(),
            "stopped": self.line,
            "hash": self._scene.manifest["hash"],
        }

    def _close_log(self, run: Running) -> None:
        if self._log is None or self._file is None:
            return
        with self._log as log:
            try:
                self.flight_file = write_flight(self._file, run.flight(), self.line)
            except OSError as error:
                self._tell(f"{self._file.parent}: no flight recorder written ({error.strerror})")
            if not log.rows:
                log.discard()
                return
            if log.room:
                facts = {"stopped": self.line, "state": asdict(run.state),
                         "counts": asdict(run.counts), "scheduler": run.scheduler()}  # fmt: skip
                log.finish({"end": facts})


def wanted_of(keys: DeviceKeys, **wanted: Any) -> Wanted:
    """What the scene's [device] says, with what the scene itself wants."""
    return Wanted(
        surface_m=1e-3 * keys.surface_mm,
        m_per_turn=keys.m_per_turn,
        sign=keys.sign,
        zero_turns=keys.zero_turns,
        max_torque_nm=keys.max_torque_nm,
        **wanted,
    )


def steal_ms() -> float:
    """Time that the hypervisor took from this machine since it started, ms of all processors."""
    try:
        fields = Path("/proc/stat").read_text().split("\n", 1)[0].split()
        return 10.0 * int(fields[8])
    except (OSError, IndexError, ValueError):
        return 0.0


def _spread_us(seconds: Any) -> dict[str, float]:
    seconds = seconds if len(seconds) else np.zeros(1)
    p50, p99, p999 = np.percentile(seconds, [50, 99, 99.9])
    spread = {"p50": p50, "p99": p99, "p999": p999, "max": seconds.max()}
    return {name: round(1e6 * float(value), 3) for name, value in spread.items()}
