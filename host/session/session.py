"""A real-time session: `with Session(folder, url, log=file) as s: s.start(); ...`.

A loop in a C thread keeps the time; Python watches it, writes the log, and
brings back a device that was unplugged. However the session is left, the force is zero first.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from os import PathLike
from typing import Any, Self

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DeviceError
from springpot.codegen.files import parse_path
from springpot.codegen.messages import caution, notice
from springpot.codegen.types import JsonObject
from springpot.host.devices.device import RECONNECT_S, requirements_from_keys
from springpot.host.devices.drivers import find_driver
from springpot.host.emission.emission import read_emission
from springpot.host.native.c_library import COLUMN, COLUMNS, INPUT, NONE, LoopRows, Stop
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.session.c_loop import scene_step_functions
from springpot.host.session.live_warnings import Alarm, LiveWarnings
from springpot.host.session.outcome import (
    BY_USER,
    LoopSettings,
    LoopState,
    expected_ticks,
    hypervisor_steal_ms,
)
from springpot.host.session.runner import SessionRunner, TakeRows
from springpot.host.stability.check import require_held
from springpot.trainer.recordings.journal import MIN_SAMPLES, JournalWriter
from springpot.trainer.recordings.recording import Zero

# Results of `run --json` that the loop and its links count.
_OF_LOOP = ("ticks", "late", "ring_dropped", "watchdog_trips", "disconnects", "resets")
_OF_LINKS = ("samples", "sequence_gaps", "crc_errors", "unsent", "saturated")


# Channels of a log beside position and force, which are what the tool did and what was sent: every
# call in order, bit for bit, so that `springpot validate` can make each again.
_CHANNELS = tuple(name for name in COLUMNS if name not in ("position_m", "sent_n"))


class SessionLog(JournalWriter):
    """The log of a session: a recording with a row for each tick."""

    _last: tuple[float, float] = (0.0, 0.0)

    def take(self, rows: LoopRows) -> None:
        """Take the next rows of the loop. Raises DeviceError where the disk is full."""
        if len(rows):
            given_m = rows[:, COLUMN["position_m"]]  # as the scene got it, which may be no number
            position_m = _finite(given_m, self._last[0])
            sent_n = _finite(rows[:, COLUMN["sent_n"]], self._last[1])
            others = rows[:, [COLUMN[name] for name in _CHANNELS]]
            self.append(position_m, sent_n, np.column_stack((given_m, others)))
            self._last = position_m[-1], sent_n[-1]


def _finite(values: Samples, before: float) -> Samples:
    """Hold the last finite value where there is none: a recording has no holes."""
    held = np.append(before, values)
    good = np.maximum.accumulate(np.where(np.isfinite(held), np.arange(len(held)), 0))
    return held[good][1:]


class Extremes:
    """Take the rows of a loop; keep the deepest position and the largest force that was sent.

    max_depth_m: -inf before a position. max_force_n: out of the object or into it.
    """

    def __init__(self) -> None:
        self.max_depth_m, self.max_force_n = -np.inf, 0.0

    def append(self, rows: LoopRows) -> None:
        """Take the next rows; what is no number counts for nothing."""
        called = (rows[:, COLUMN["call"]].astype(int) & NONE) == 0
        depth_m, force_n = rows[called, COLUMN["position_m"]], np.abs(rows[:, COLUMN["sent_n"]])
        self.max_depth_m = float(np.fmax.reduce(depth_m, initial=self.max_depth_m))
        self.max_force_n = float(np.fmax.reduce(force_n, initial=self.max_force_n))


class Session(SessionRunner):
    """Render an emitted scene on a device.

    folder: of `springpot emit`. url: of the device. log: file to write, a recording with every
    call. seconds: 0, until `stop`. max_force_n, max_depth_m: beyond
    them the session ends. Files that are not as emitted are a UserWarning; log and result name
    them. place_m: where an object with a map is pressed, x and y. report: takes lines for
    people, by default a logger. viewers: take every row too, and never wait. alarm: takes the
    lines of live warnings; an empty one only rings.
    Raises DeviceError where the device cannot be used as the scene wants, UnsafeError where an
    emission was accepted as unstable and the device moves a hand.

    >>> with Session("c", "sim://ecoflex-00-30", "felt.h5", seconds=0.1) as session:
    ...     session.start()
    ...     session.wait()
    >>> session.result()["watchdog_trips"]
    0
    """

    def __init__(
        self,
        folder: str | PathLike[str],
        url: str,
        log: str | PathLike[str] | None = None,
        *,
        seconds: float = 0.0,
        max_force_n: float | None = None,
        max_depth_m: float | None = None,
        reconnect_s: float = RECONNECT_S,
        report: Callable[[str], None] | None = None,
        place_m: tuple[float, float] | None = None,
        viewers: Sequence[TakeRows] = (),
        alarm: Alarm = lambda _line: None,
    ) -> None:
        """Read the emission and resolve limits and requirements; nothing is opened yet."""
        emitted = read_emission(parse_path(folder))
        plan, self._hash, self._edited = emitted.plan, emitted.hash, list(emitted.edited)
        self._scene = SceneLibrary(parse_path(folder))
        if not find_driver(url).virtual:
            require_held(plan, self._scene)
        settings = LoopSettings(
            period_s=plan.dt_s,
            seconds=seconds,
            max_force_n=plan.max_force_n if max_force_n is None else max_force_n,
            max_depth_m=float("inf") if max_depth_m is None else max_depth_m,
            reversed=plan.scene.device.force_sign == -1,
        )
        self._ended = report or notice
        requirements = requirements_from_keys(
            plan.scene.device,
            rate_hz=1 / plan.dt_s,
            watchdog_s=plan.watchdog_s,
            max_n=min(plan.max_force_n, settings.max_force_n),
        )
        self._zero: Zero = "none" if plan.contact else "first"
        self._file = None if log is None else parse_path(log)
        self._log: SessionLog | None = None
        self._warnings, self._felt = LiveWarnings(plan, alarm), Extremes()
        self._warned: list[JsonObject] = []
        self._place_m = place_m
        super().__init__(
            scene_step_functions(self._scene, place_m), url, requirements, settings,
            [self._warnings.append, self._felt.append, *viewers], reconnect_s, report or caution,
        )  # fmt: skip
        self._steal_ms = hypervisor_steal_ms()
        self.line = ""

    def __enter__(self) -> Self:
        """Open the log, then the device: a device that fails leaves no log."""
        if self._file is not None:
            details = {"session": {"scene": self._scene.manifest["scene"], "device": self.url,
                                   "hash": self._hash, "edited": self._edited}}  # fmt: skip
            self._log = SessionLog(
                self._file, self._file.stem, self.settings.period_s, self.url, details,
                zero=self._zero, channels=(INPUT, *_CHANNELS), place_m=self._place_m,
            )  # fmt: skip
            self._takers.insert(0, self._log.take)
        try:
            self.open()
        except BaseException:
            if self._log is not None:
                self._log.discard()
            raise
        return self

    def __exit__(self, *error: Any) -> None:
        """End with zero force, then say why it ended, then close the log."""
        try:
            self.close()
        finally:
            self.line, self.error = self.why(_left_by(error[1], self.state))
            unfelt = not self.counts.samples or self.state.reason != Stop.TIME
            if self.error is None and self.fault() and unfelt:
                self.error = DeviceError(self.line)
            self._warned = self._warnings.finish()
            try:
                (self._report if self.error else self._ended)(self.line)
            finally:
                self._close_log()

    def result(self) -> JsonObject:
        """Return keys of `springpot run --json`, after the end."""
        state, counts, felt = self.state, self.counts, self._felt
        return {
            **{name: getattr(state, name) for name in _OF_LOOP},
            **{name: getattr(counts, name) for name in _OF_LINKS},
            "expected_ticks": expected_ticks(state, self.settings),
            **self.spreads_us(),
            "steal_ms": hypervisor_steal_ms() - self._steal_ms,
            "stale_samples": state.stale,
            "unused_samples": state.unused,
            "latched": bool(state.latched or state.tripped),
            "max_depth_m": felt.max_depth_m if np.isfinite(felt.max_depth_m) else None,
            "max_force_n": felt.max_force_n,
            "log": str(self._file) if self._file is not None else None,
            "scheduler": self.scheduler(),
            "warnings": self._warned,
            "stopped": self.line,
            "hash": self._hash,
            "edited": self._edited,
        }

    def _close_log(self) -> None:
        """Finish the log with how the session ended; of too few rows nothing is left."""
        if self._log is None or self._file is None:
            return
        with self._log as log:
            if log.rows < MIN_SAMPLES:
                self._file = None  # the journal leaves nothing
            elif not log.full:
                metadata = {"stopped": self.line, "state": asdict(self.state),
                            "counts": asdict(self.counts), "scheduler": self.scheduler(),
                            "warnings": self._warned}  # fmt: skip
                log.finish({"end": metadata})


def _left_by(error: BaseException | None, state: LoopState) -> str:
    """Say why the session was left while the loop still ran: its user, Ctrl-C or an error."""
    if error is None:
        return BY_USER
    if isinstance(error, KeyboardInterrupt):
        sent = ": zero force was sent" if state.connected else ""
        return f"interrupted by {str(error) or 'Ctrl-C'}{sent}"
    return f"stopped by {type(error).__name__}"
