"""A device that presses with a force sensor beside it: late by a delay that is found first."""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import asdict
from functools import partial
from typing import Any

import numpy as np

from springpot import DeviceError, SpringpotError
from springpot.basics import Samples
from springpot.console import say
from springpot.devices import OPEN_LOOP, Limits, PressedDevice, PressRows, rest
from springpot.host.wings.lab.force_sensor.alignment import (
    PRELOAD_N,
    SWING_N,
    Delay,
    ForcedMotion,
    aligned_force,
    alignment_command,
    find_delay,
)
from springpot.host.wings.lab.force_sensor.late_control import Compliance, late_gains, led_command
from springpot.host.wings.lab.force_sensor.sensor import ForceSensor
from springpot.host.wings.lab.force_sensor.sources import open_sensor
from springpot.loop import COLUMN, LoopRows, Progress, SessionRunner
from springpot.simulation import RATE_HZ

_RECOVERY_S = 3.0  # of the object, after the press that finds the delay
_ROOM = 2.5  # over its command, for the chirp meets the resonance of tool and object
_FINE_MS = 0.5
_START = 50  # rows before the sensor must have measured
_WAITING = 100  # rows that are aligned at once


@contextmanager
def opened_sensor(url: str) -> Iterator[Callable[..., PressedDevice]]:
    """Open a force sensor for `springpot record --force`; yields what presses beside it.

    Raises UsageError for a wrong URL, DeviceError with one line for whatever else is wrong.
    """
    with closing(open_sensor(url)) as sensor:
        yield partial(SensedPressDevice, sensor=sensor)


class SensedPressDevice(PressedDevice):
    """Presses with commanded forces, which the sensor measures."""

    sensed = True
    room = 1.6  # over an object that stiffens under a fast press
    max_mps = 0.35  # the observer's damper holds it back

    def __init__(
        self,
        url: str,
        object_name: str,
        limits: Limits,
        on_progress: Callable[[Progress], None],
        sensor: ForceSensor,
    ) -> None:
        super().__init__(url, object_name, limits, on_progress)
        self._sensor, self._room_n = sensor, limits.max_force_n or math.inf
        self._delay: Delay | None = None
        self._compliance = Compliance()
        self._runner: SessionRunner | None = None

    @property
    def gains(self) -> Mapping[str, float]:
        return late_gains(self._found(), self._compliance)

    def driven(self, command_n: Samples) -> Samples:
        return led_command(command_n, self._found(), self._compliance)

    def prepare(self) -> dict[str, Any]:
        """Find how late the sensor is, by a press of five seconds."""
        share = min(1.0, self._room_n / (_ROOM * (PRELOAD_N + SWING_N)))
        command_n = alignment_command(RATE_HZ, share)
        rows = _AlignmentRows(len(command_n), self._sensor)
        self.drive(command_n, command_n, OPEN_LOOP, rows, _ROOM)
        motion = ForcedMotion(
            self._start_s() + rows.table[:, COLUMN["time_s"]],
            rows.table[:, COLUMN["position_m"]],
            -rows.table[:, COLUMN["sent_n"]],
            *self._sensor.samples(),
        )
        self._delay = delay = find_delay(motion, self._sensor.url)
        force_n = aligned_force(motion.t_s, delay.value_s, motion.sensor_s, motion.sensor_n)
        self._compliance.learn(motion.position_m, force_n)
        half_ms = 500 * (delay.high_s - delay.low_s)
        wide = "" if half_ms <= _FINE_MS else ": more than half a sample: end other programs"
        late = f"{1e3 * delay.value_s:.2f} ms late, +- {half_ms:.2f} ms (95 %)"
        say(f"{self._sensor.url}: {late}{wide}")
        rest(_RECOVERY_S)
        return {"force_sensor": {"url": self._sensor.url, **asdict(delay)}}

    def press(
        self,
        command_n: Samples,
        on_samples: Callable[[Samples, Samples], None] = lambda _position_m, _force_n: None,
    ) -> tuple[Samples, Samples]:
        """Press as every device does, and learn how the object gave way for the next press."""
        position_m, force_n = super().press(command_n, on_samples)
        self._compliance.learn(position_m, force_n)
        return position_m, force_n

    def attach(self, runner: SessionRunner) -> None:
        self._runner = runner
        self._sensor.on_force = runner.sense

    def rows(self, n: int, on_samples: Callable[[Samples, Samples], None]) -> PressRows:
        late_s = self._found().value_s
        return _SensedRows(n, on_samples, self._sensor, late_s, self._start_s)

    def unmeasured(self) -> SpringpotError:
        return self._sensor.error or DeviceError(
            f"{self._sensor.url}: silent for 100 ms while pressing, force zero, stopped: check its "
            "cable and power"
        )

    def _found(self) -> Delay:
        if self._delay is None:
            self.prepare()
        assert self._delay is not None
        return self._delay

    def _start_s(self) -> float:
        assert self._runner is not None
        return 1e-9 * self._runner.state.start_ns


class _SensedRows(PressRows):
    """A row is kept once the sensor's samples reach beyond its time.

    start_s: when the loop's time began, of time.monotonic.
    """

    def __init__(
        self,
        n: int,
        on_samples: Callable[[Samples, Samples], None],
        sensor: ForceSensor,
        late_s: float,
        start_s: Callable[[], float],
    ) -> None:
        super().__init__(n, on_samples)
        self._sensor, self._late_s, self._start_s = sensor, late_s, start_s
        self._waiting = np.empty((0, len(COLUMN)))
        self._seen = 0
        sensor.forget()

    def append(self, rows: LoopRows) -> None:
        self.unmeasured |= _is_silent(rows, self._seen)
        self._seen += len(rows)
        self._waiting = np.concatenate((self._waiting, rows))
        if len(self._waiting) < _WAITING or self.unmeasured:
            return
        sensor_s, sensor_n = self._sensor.samples()
        if not len(sensor_s):
            return
        t_s = self._start_s() + self._waiting[:, COLUMN["time_s"]]
        ready = int(np.searchsorted(t_s + self._late_s, sensor_s[-1]))
        aligned, self._waiting = self._waiting[:ready], self._waiting[ready:]
        aligned[:, COLUMN["measured_n"]] = aligned_force(
            t_s[:ready], self._late_s, sensor_s, sensor_n
        )
        super().append(aligned)


class _AlignmentRows(PressRows):
    """All columns of a press, as the loop has them."""

    def __init__(self, n: int, sensor: ForceSensor) -> None:
        super().__init__(n, lambda _position_m, _force_n: None)
        self._n_rows = n
        self.table = np.empty((0, len(COLUMN)))
        sensor.forget()

    @property
    def full(self) -> bool:
        return len(self.table) >= self._n_rows

    def append(self, rows: LoopRows) -> None:
        self.unmeasured |= _is_silent(rows, len(self.table))
        self.unlocated |= not np.isfinite(rows[:, COLUMN["position_m"]]).all()
        self.table = np.concatenate((self.table, rows))


def _is_silent(rows: LoopRows, seen: int) -> bool:
    begun = np.arange(seen, seen + len(rows)) >= _START
    return bool(np.isnan(rows[begun, COLUMN["measured_n"]]).any())
