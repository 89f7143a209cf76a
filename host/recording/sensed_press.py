"""A device that presses with a force sensor beside it, late by a delay that is found first.

Between motor and sensor moves one mass: m a = u(t - d) - b v - c sign(v) - F(t), with the motor's
force u, late by d, and the sensor's F, which is here late by tau: F(t) = F_sensor(t + tau). A fast
press excites the mass; u(t - d) is linear in u and its derivatives, and tau alone is sought.
"""

import math
import threading
import time
from array import array
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.optimize import minimize_scalar
from scipy.signal import chirp

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DeviceError, SpringpotError, UsageError
from springpot.codegen.types import JsonMapping, JsonObject
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import parse_device
from springpot.host.devices.serial_device import SerialDevice
from springpot.host.devices.wire import constant
from springpot.host.output import print_line
from springpot.host.recording.indentation import (
    OPEN_LOOP,
    PressedDevice,
    PressRows,
    TakeSamples,
    rest,
)
from springpot.host.recording.protocols import RATE_HZ
from springpot.host.session.runner import SessionRunner

CHIRP_PEAK_N = 2.8  # of the alignment's press
_SMOOTH_S = 0.003  # of the Gaussian that differentiates
_FIRST_S, _LAST_S, _STEP_S = -0.005, 0.040, 1e-3  # where the delay is sought
_CREEP_MPS = 2e-3  # below it friction has no clear sign
_MAX_UNEXPLAINED = 0.25  # of the force's standard deviation
_POLE_RADPS = 600.0  # of the observer: it hears the encoder's steps as little noise
_DAMPING = 0.25  # of the mass per reaction time; a damper so late makes a free tool ring at pi/2
_RESISTANCE = 10.0  # reaction times: its low-pass takes less than half of the damping
_MIN_MASS_KG = 0.05
_MIN_RATE_HZ, _COUNT_S = 400.0, 0.5
_RECOVERY_S = 3.0  # of the object, after the press that finds the delay
_ROOM = 2.5  # over its command, for the chirp meets the resonance of tool and object
_SILENT, _TAIL_S = 50, 0.1  # rows before the sensor must measure; it is no later than that


@dataclass(frozen=True)
class Delay:
    """Delays of force and motor behind the position, s; the mass between them, kg."""

    value_s: float
    motor_s: float
    mass_kg: float


def alignment_command(share: float = 1.0) -> Samples:
    """Return a chirp from 2 to 30 Hz on a preload, N, one value each ms; share: of its force."""
    rise, t_s = np.linspace(0.0, 1.0, 400) ** 2, np.arange(4000) / RATE_HZ
    chirp_n = 1.5 + 1.3 * chirp(t_s, 2.0, 4.0, 30.0, method="logarithmic", phi=-90.0)
    return share * np.concatenate([chirp_n[0] * rise, chirp_n, chirp_n[-1] * rise[::-1]])


def find_delay(
    motion: tuple[Samples, Samples, Samples], sensor: tuple[Samples, Samples], url: str
) -> Delay:
    """Return how late the sensor is, s, by comparing its forces with the motor's in one press.

    The press is that of `alignment_command`. motion: times, positions and the motor's forces, (n,)
    each, positive into the object. sensor: its times on the same clock and its forces, (k,) both.
    Raises DeviceError where its force does not fit the motion.
    """
    # A loop that was held up makes up for its ticks at once: a force stays until the next.
    t_s, position_m, motor_n = motion
    step_s = float(np.median(np.diff(t_s)))
    even_s = np.arange(t_s[0], t_s[-1], step_s)
    x_m = np.interp(even_s, t_s, position_m)
    u_n = motor_n[np.searchsorted(t_s, even_s, "right") - 1]
    smooth = partial(gaussian_filter1d, sigma=_SMOOTH_S / step_s)
    speed_mps = smooth(x_m, order=1) / step_s
    columns = [smooth(u_n, order=k) / step_s**k for k in range(3)]
    columns += [smooth(x_m, order=2) / step_s**2, speed_mps, np.ones(len(x_m))]
    columns += [smooth(speed_mps / np.hypot(speed_mps, _CREEP_MPS))]
    first_s, last_s = max(t_s[0], sensor[0][0]), min(t_s[-1], sensor[0][-1])
    rows = (even_s > first_s + _LAST_S) & (even_s < last_s - 1.3 * _LAST_S)  # off the ends
    terms = np.stack(columns, axis=1)[rows]

    def fitted(late_s: float) -> tuple[float, Samples]:
        """Share of the variance that is not explained, and the coefficients."""
        force_n = smooth(np.interp(even_s + late_s, *sensor))[rows]
        weights = np.linalg.lstsq(terms, force_n)[0]
        return float(np.var(force_n - terms @ weights) / np.var(force_n)), weights

    near_s = min(np.arange(_FIRST_S, _LAST_S, _STEP_S), key=lambda late_s: fitted(late_s)[0])
    around = (near_s - _STEP_S, near_s + _STEP_S)
    late_s = float(minimize_scalar(lambda late_s: fitted(late_s)[0], bounds=around).x)
    missed, weights = fitted(late_s)
    if missed > _MAX_UNEXPLAINED**2:
        raise DeviceError(
            f"{url}: {100 * math.sqrt(missed):.0f} % of its force does not fit the tool's motion: "
            "is it between tool and object, firmly fixed, and along the device's axis?"
        )
    if weights[0] <= 0:
        raise DeviceError(
            f"{url}: its force falls where the motor pushes harder: turn its sign, &n_per_unit=-1"
        )
    motor_s = max(0.0, float(-weights[1] / weights[0]) - step_s / 2)  # a force is held for a step
    return Delay(late_s, motor_s, max(_MIN_MASS_KG, float(-weights[3] / weights[0])))


def late_gains(delay: Delay) -> Mapping[str, float]:
    """Return gains of sp_press for a late sensor and motor: stable on soft and stiff objects."""
    reaction_s = 1 / RATE_HZ + 1.5 / _POLE_RADPS + delay.motor_s
    return {
        **OPEN_LOOP,
        "mass_kg": delay.mass_kg,
        "pole": math.exp(-_POLE_RADPS / RATE_HZ),
        "damping_nspm": _DAMPING * delay.mass_kg / reaction_s,
        "resistance_share": 1 / (RATE_HZ * _RESISTANCE * reaction_s),
        "motor_late": round(RATE_HZ * delay.motor_s),
        "sensor_late": round(RATE_HZ * max(0.0, delay.value_s - 2.8 / _POLE_RADPS)),
    }


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
        """Open the sensor's port, and read it in a thread. Raises UsageError for a wrong URL."""
        address = parse_device(url)
        if address.scheme != "serial":
            raise UsageError(f"{url}: no sensor: use serial:///dev/ttyACM1?baud=921600")
        self.url, self._factor = url, address.number("n_per_unit", 1.0, -1e6, 1e6)
        self.on_force: Callable[[float], None] = lambda _force_n: None
        self._device = SerialDevice(address, DeviceRequirements(RATE_HZ, 0.02, 0.0, senses=True))
        self._samples, self._lock, self._over = array("d"), threading.Lock(), threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def require_rate(self) -> None:
        """Wait until its rate is known. Raises DeviceError where it is too low, or it failed."""
        self._over.wait(_COUNT_S)  # shorter if the thread failed
        rate_hz = len(self._samples) / 3 / _COUNT_S  # flat: stamp, arrival, force of each
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
            stamp_s, arrived_s, force_n = np.array(self._samples).reshape(-1, 3).T
        line_s = np.polyval(np.polyfit(stamp_s, arrived_s, 1), stamp_s)
        return line_s + np.min(arrived_s - line_s), force_n

    def close(self) -> None:
        self._over.set()
        self._thread.join(1.0)
        self._device.stop()
        self._device.close()

    def _run(self) -> None:
        """Read samples until the end, and keep an error for who asks next."""
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
        """Keep a sample with its stamp and its time of arrival. Raises DeviceError."""
        if not values["status"] & constant("LOAD_CELL"):
            raise DeviceError(f"{self.url}: its samples carry no force: give one with a load cell")
        if self._samples and stamp_s <= self._samples[-3]:
            raise DeviceError(f"{self.url}: its numbers went back, it restarted: start again")
        force_n = self._factor * values["measured_n"]
        with self._lock:
            self._samples.extend((stamp_s, time.perf_counter(), force_n))
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
        print_line(f"{self._sensor.url}: {1e3 * self._delay.value_s:.2f} ms late")
        rest(_RECOVERY_S)
        return {"force_sensor": {"url": self._sensor.url, **asdict(self._delay)}}

    def measure(self, command_n: Samples, on_samples: TakeSamples) -> tuple[Samples, Samples]:
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
