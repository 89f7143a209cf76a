"""A device that presses with a force sensor beside it, late by a delay that is found first."""

import threading
import time
from array import array
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import asdict
from functools import partial
from typing import Any

import numpy as np

from springpot import SpringpotError
from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DeviceError
from springpot.codegen.types import JsonMapping, JsonObject
from springpot.host.console.output import say
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.serial_device import SerialDevice
from springpot.host.devices.url import Address, parse_address
from springpot.host.devices.wire import constant
from springpot.host.recording.alignment import (
    CHIRP_PEAK_N,
    Delay,
    alignment_command,
    find_delay,
    late_gains,
)
from springpot.host.recording.indentation import OPEN_LOOP, PressedDevice, rest
from springpot.host.recording.press_rows import PressRows
from springpot.host.recording.protocols import RATE_HZ
from springpot.host.session.runner import SessionRunner

_MIN_RATE_HZ, _COUNT_S = 400.0, 0.5
_RECOVERY_S = 3.0  # of the object, after the press that finds the delay
_ROOM = 2.5  # over its command, for the chirp meets the resonance of tool and object
_SILENT, _TAIL_S = 50, 0.1  # rows before the sensor must measure; it is no later than that


@contextmanager
def opened_sensor(url: str) -> Iterator[Callable[..., PressedDevice]]:
    """Open a force sensor for `springpot record --force`; yields what presses beside it.

    Raises UsageError for a wrong URL, DeviceError with one line for whatever else is wrong.
    """
    with closing(ForceSensor(url)) as sensor:
        sensor.require_rate()
        yield partial(SensedPressDevice, sensor=sensor)


class ForceSensor:
    """Load cell of a springpot serial device, of which a thread takes the samples.

    on_force: called with each force as it comes. error: what ended the thread.
    """

    error: SpringpotError | None = None

    def __init__(self, url: str) -> None:
        address = parse_address(url, {"serial": "serial:///dev/ttyACM1?baud=921600"}, "sensor")
        address.require_known(("baud", "n_per_unit"))
        self.url, self._factor = url, address.number("n_per_unit", 1.0, -1e6, 1e6)
        self.on_force: Callable[[float], None] = lambda _force_n: None
        settings = {name: its for name, its in address.settings.items() if name == "baud"}
        plain = Address(url, "serial", "", address.place, settings)
        self._device = SerialDevice(plain, DeviceRequirements(RATE_HZ, 0.02, 0.0, senses=True))
        self._taken, self._lock, self._over = array("d"), threading.Lock(), threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def require_rate(self) -> None:
        """Wait until its rate is known. Raises DeviceError where it is too low, or it failed."""
        self._over.wait(_COUNT_S)
        rate_hz = len(self._taken) / 3 / _COUNT_S
        if self.error is not None:
            raise self.error
        if rate_hz < _MIN_RATE_HZ:
            raise DeviceError(
                f"{self.url}: sends {rate_hz:.0f} samples a second, a recording at 1 kHz needs "
                f"{_MIN_RATE_HZ:g}: check power and wiring, or take a faster one than an HX711"
            )

    def samples(self) -> tuple[Samples, Samples]:
        """Return times on the host's clock, s, and forces, N, (n,) both, oldest first.

        A sample is only ever held back on its way: the sensor's clock is the line below arrivals.
        """
        with self._lock:
            stamp_s, arrived_s, force_n = np.array(self._taken).reshape(-1, 3).T
        line_s = np.polyval(np.polyfit(stamp_s, arrived_s, 1), stamp_s)
        return line_s + np.min(arrived_s - line_s), force_n

    def close(self) -> None:
        self._over.set()
        self._thread.join(1.0)
        self._device.stop()
        self._device.close()

    def _run(self) -> None:
        try:
            while not self._over.is_set():
                for frame in self._device.frames():
                    if frame.name == "sample" and not frame.old:
                        self._take(frame.sequence / RATE_HZ, frame.values)
                time.sleep(0.0005)
        except SpringpotError as error:
            self.error = error
            self._over.set()

    def _take(self, stamp_s: float, values: JsonMapping) -> None:
        if not values["status"] & constant("LOAD_CELL"):
            raise DeviceError(f"{self.url}: its samples carry no force: give one with a load cell")
        if self._taken and stamp_s <= self._taken[-3]:
            raise DeviceError(f"{self.url}: its numbers went back, it restarted: start again")
        force_n = self._factor * values["measured_n"]
        with self._lock:
            self._taken.extend((stamp_s, time.monotonic(), force_n))
        self.on_force(force_n)


class SensedPressDevice(PressedDevice):
    """Presses with commanded forces, which the sensor measures."""

    sensed = True
    room = 1.7  # over an object that stiffens under a fast press
    max_mps = 0.35  # the observer's damper holds it back
    _delay: Delay
    _runner: SessionRunner

    def __init__(self, *arguments: Any, sensor: ForceSensor) -> None:
        super().__init__(*arguments)
        self._sensor = sensor

    def prepare(self) -> JsonObject:
        """Find how late the sensor is, by a press of five seconds."""
        most_n = self._limits.max_force_n or _ROOM * CHIRP_PEAK_N
        command_n = alignment_command(min(1.0, most_n / (_ROOM * CHIRP_PEAK_N)))
        rows, sensor = self._pressed(command_n, OPEN_LOOP, _ROOM)
        motion = rows["time_s"], rows["position_m"], -rows["sent_n"]
        self._delay = find_delay(motion, sensor, self._sensor.url)
        say(f"{self._sensor.url}: {1e3 * self._delay.value_s:.2f} ms late")
        rest(_RECOVERY_S)
        return {"force_sensor": {"url": self._sensor.url, **asdict(self._delay)}}

    def measure(
        self, command_n: Samples, on_samples: Callable[[Samples, Samples], None]
    ) -> tuple[Samples, Samples]:
        """Drive one press; its samples get the sensor's force of their moment once it is over."""
        rows, sensor = self._pressed(command_n, late_gains(self._delay), self.room)
        force_n = np.interp(rows["time_s"] + self._delay.value_s, *sensor)
        on_samples(rows["position_m"], force_n)
        return rows["position_m"], force_n

    def attach(self, runner: SessionRunner) -> None:
        self._runner, self._sensor.on_force = runner, runner.sense

    def unmeasured(self) -> SpringpotError:
        return self._sensor.error or DeviceError(
            f"{self._sensor.url}: silent for 100 ms while pressing, force zero, stopped: check its "
            "cable and power"
        )

    def _pressed(
        self, command_n: Samples, gains: Mapping[str, float], room: float
    ) -> tuple[Mapping[str, Samples], tuple[Samples, Samples]]:
        """Columns of the loop, times on the host's clock, and times and forces of the sensor."""
        rows = PressRows(len(command_n), lambda _position_m, _force_n: None, _SILENT)
        self.drive(command_n, gains, rows, room)
        time.sleep(_TAIL_S)
        columns = {name: rows.column(name) for name in ("time_s", "position_m", "sent_n")}
        columns["time_s"] += 1e-9 * self._runner.state.start_ns
        return columns, self._sensor.samples()
