"""Watching a board that renders by itself: its calls become the rows of the log.

The board keeps the time; the host feeds it motion where it has no sensor of its own (`?feed=FILE`),
and refuses a board whose model is another. Rows hold what the board says it was given and returned,
so that `springpot validate` compares the board's forces with this machine's, bit for bit.
"""

import contextlib
import threading
import time
from pathlib import Path
from typing import Any, cast

import numpy as np

from springpot import read_recordings
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.reference.notes import LATCHED
from springpot.host.devices.device import OpenedDevice
from springpot.host.devices.serial_device import SerialDevice
from springpot.host.devices.wire import Frame, constant
from springpot.host.native.loop_library import COLUMNS, IDLE, RESET, LoopRows, Stop, empty_rows
from springpot.host.session.loop import LinkCounts, LoopSettings, LoopState

_POLL_S, _AGAIN_S = 0.0005, 0.05


class BoardLoop:
    """Has the methods of CLoop; the ticks are the board's."""

    name = "board"
    no_sample_advice = "a board without a sensor is fed: add ?feed=RECORDING.h5 to its URL"

    def __init__(self, device: SerialDevice, settings: LoopSettings) -> None:
        self._settings = settings
        self._device = device
        self._feed = _feed(device, settings)
        self._state = LoopState()
        self._rows: list[list[float]] = []
        self._lock = threading.Lock()
        self._kept: list[list[float]] = []
        self._want_stop = False
        self._next: SerialDevice | None = None
        self._actions: list[str] = ["RESET"]
        self._asked: tuple[int, bytes] | None = None  # the command under way: sequence, bytes
        self._again_s = 0.0
        self._begun = False
        self._counts = dict.fromkeys(LinkCounts.__dataclass_fields__, 0)
        self._thread: threading.Thread | None = None

    def start(self, device: OpenedDevice) -> None:
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def attach(self, device: OpenedDevice) -> None:
        """Go on with a board that came back: it has started anew, and so must the log."""
        self._next = cast("SerialDevice | None", device.rendering_board())
        if self._next is None:
            raise DeviceError(f"{self._device.address.url}: came back without its scene: flash it")

    def ask_stop(self) -> None:
        self._want_stop = True

    def sense(self, measured_n: float) -> None:
        """Nothing: a board renders by its own sensors."""

    def pause(self, paused: bool) -> None:
        self._actions.append("STOP" if paused else "START")
        self._update(paused=int(paused))

    def reset(self) -> None:
        self._actions.append("RESET")

    def get_status(self) -> LoopState:
        return self._state

    def counts(self) -> LinkCounts:
        receiver = self._device.receiver
        return LinkCounts(
            samples=self._counts["samples"],
            crc_errors=self._counts["crc_errors"] + receiver.crc_errors,
            sequence_gaps=self._counts["sequence_gaps"] + receiver.gaps,
        )

    def drain(self) -> LoopRows:
        with self._lock:
            rows, self._rows = self._rows, []
        self._kept = (self._kept + rows)[-(1 << 15) :]
        return np.array(rows) if rows else empty_rows()

    def flight(self, seconds: float) -> LoopRows:
        rows = self._kept[-int(seconds / self._settings.period_s) - 1 :]
        return np.array(rows) if rows else empty_rows()

    def join(self) -> None:
        if self._thread is not None:
            self._thread.join()

    def scheduler(self) -> str:
        return self.name

    def refused(self) -> str:
        return ""

    def _update(self, **changes: Any) -> None:
        self._state = LoopState(**{**self._state.__dict__, **changes})

    def _run(self) -> None:
        try:
            self._watch()
        finally:
            self._update(over=1)

    def _watch(self) -> None:
        begin_s = time.monotonic()
        while not self._state.reason:
            now_s = time.monotonic() - begin_s
            self._update(elapsed_s=now_s)
            if self._next is not None:
                self._counts["crc_errors"] += self._device.receiver.crc_errors
                self._counts["sequence_gaps"] += self._device.receiver.gaps
                self._device, self._next = self._next, None
                self._actions, self._asked, self._begun = ["RESET"], None, False
                self._update(connected=1)
            if self._state.connected:
                try:
                    self._feed_until(now_s)
                    self._act(now_s)
                    self._listen(now_s)
                except DeviceError:
                    self._update(connected=0, disconnects=self._state.disconnects + 1)
            if self._want_stop:
                self._update(reason=Stop.ASKED)
            elif self._settings.seconds and now_s >= self._settings.seconds:
                self._update(reason=Stop.TIME)
            elif self._feed is not None and self._feed.over:
                self._update(reason=Stop.ENDED)
            time.sleep(_POLL_S)
        with contextlib.suppress(DeviceError):
            self._listen(time.monotonic() - begin_s)

    def _act(self, now_s: float) -> None:
        """Send the oldest command that is not acknowledged, again and again: it acts once."""
        if not self._actions or now_s < self._again_s:
            return
        self._again_s = now_s + _AGAIN_S
        device = self._device
        if self._asked is None:
            required, sequence = device.requirements, device.sender.sequence
            self._asked = sequence, device.sender.encode(
                "command", action=constant(self._actions[0]), rate_hz=required.rate_hz,
                watchdog_s=required.watchdog_s,
            )  # fmt: skip
        device.write(self._asked[1])

    def _acknowledged(self, command: int) -> None:
        if self._asked is not None and command == self._asked[0]:
            self._actions.pop(0)
            self._asked = None
            self._again_s = 0.0

    def _feed_until(self, now_s: float) -> None:
        if self._feed is not None:
            for position_m, velocity_mps in self._feed.until(now_s):
                self._device.send("feed", position_m=position_m, velocity_mps=velocity_mps)

    def _listen(self, now_s: float) -> None:
        """Take the calls that came; the log begins with a reset, so that it can be repeated."""
        rows = []
        for frame in self._device.frames():
            if frame.name == "ack":
                self._acknowledged(frame.values["command"])
            elif frame.name == "rendered" and not frame.old:
                self._begun = self._begun or bool(frame.values["call"] & constant("WAS_RESET"))
                rows += [self._row(frame, now_s)] if self._begun else []
        with self._lock:
            self._rows += rows

    def _row(self, frame: Frame, now_s: float) -> list[float]:
        """One call of the board as a row of the log."""
        values = frame.values
        idle = bool(values["call"] & constant("IDLE"))
        was_reset = bool(values["call"] & constant("WAS_RESET"))
        row = {name: float(values.get(name, 0.0)) for name in COLUMNS} | {
            "time_s": now_s,
            "returned_n": values["force_n"],
            "sent_n": values["force_n"],
            "measured_n": np.nan,
            "call": float(IDLE * idle + RESET * was_reset),
            "age_s": np.nan if idle else 0.0,
        }
        state = self._state
        latched = int(bool(values["notes"] & LATCHED))
        self._counts["samples"] += not idle
        self._update(
            ticks=state.ticks + 1,
            stale=state.stale + idle,
            newest_row=state.newest_row + 1,
            resets=state.resets + was_reset,
            latched=latched,
            watchdog_trips=state.watchdog_trips + (latched > state.latched),
        )
        return list(row.values())


class _Feed:
    """Motion for a board, one sample a period."""

    def __init__(self, file: Path, period_s: float) -> None:
        found = read_recordings(file)
        if len(found) != 1:
            raise UsageError(f"?feed={file}: {len(found)} recordings: give the file of one")
        recording = found[0]
        if abs(recording.dt_s / period_s - 1) > 1e-3:
            raise UsageError(
                f"{file} is sampled at {recording.rate_hz:g} Hz, the board runs at "
                f"{1 / period_s:g} Hz: import it from its source with --resample-hz "
                f"{1 / period_s:g}"
            )
        self._position_m = recording.position_m
        self._velocity_mps = backward_velocity(recording.position_m, recording.dt_s)
        self._period_s, self._at = period_s, 0

    @property
    def over(self) -> bool:
        return self._at == len(self._position_m)

    def until(self, now_s: float) -> list[tuple[float, float]]:
        """Samples that are due."""
        due = min(int(now_s / self._period_s), len(self._position_m))
        part = slice(self._at, due)
        self._at = max(self._at, due)
        return list(
            zip(self._position_m[part].tolist(), self._velocity_mps[part].tolist(), strict=True)
        )


def _feed(device: SerialDevice, settings: LoopSettings) -> _Feed | None:
    file = device.address.settings.get("feed")
    return _Feed(Path(file), settings.period_s) if file else None
