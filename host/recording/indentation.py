"""A real device that presses an object under force control, for recording: the loop of a session
with a force controller (runtime_c/port/posix/sp_press.h) in place of a scene."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DeviceError, SpringpotError
from springpot.codegen.notes import LATCHED
from springpot.codegen.types import CData, JsonObject
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import find_driver
from springpot.host.native.c_library import COLUMN, NONE, LoopRows, empty_rows, loop_library
from springpot.host.recording.protocols import RATE_HZ
from springpot.host.session.c_loop import StepFunctions
from springpot.host.session.outcome import LoopSettings, LoopState
from springpot.host.session.runner import Progress, SessionRunner
from springpot.host.session.terminal import reading_keys, wait_for_enter

WATCHDOG_S = 0.02
_HEADROOM = 1.2  # of the motor over the command, for the controller
_REST_S = 0.5  # between two presses
_MORE_TICKS = 50  # so that none of the command's is missing when clocks differ
# Force control through a link with a period of delay: gentler than that of the simulated device.
_GAINS = {"p_gain": 1.0, "d_gain_s": 0.01, "d_time_s": 0.0015}
OPEN_LOOP = {"p_gain": 0.0, "d_gain_s": 0.0, "d_time_s": 0.0015}
TakeSamples = Callable[[Samples, Samples], None]  # of positions, m, and forces, N

# Faults of sp_press.h, and what to do.
_FAULTS = {
    1: "ran into the object faster than {mps:g} m/s, braked, stopped: has it lost what it presses? "
    "else slow the protocol down, or raise --max-speed-mps",
    2: "its force sensor shows {measured_n:.2g} N where the motor gives {motor_n:.2g} N, force "
    "zero, stopped: does the tool touch the object, does the sensor move with the force, are its "
    "scale and sign right?",
    3: "the force control rings, force zero, stopped: put the tool on the object, take play out of "
    "its mount, or press a softer object",
}


@dataclass(frozen=True)
class Limits:
    """Beyond them a press stops; max_force_n None: `room` x the maximum command.

    max_speed_mps: into the object; None: the device's `max_mps`.
    """

    max_force_n: float | None = None
    max_depth_m: float = 0.03
    max_speed_mps: float | None = None


class PressRows:
    """Rows of one press of n commands; the force is the device's own.

    table: (rows, columns). unmeasured: a row has no force, but for the first `silent` ones.
    unlocated: a position is no number.
    """

    def __init__(self, n: int, on_samples: TakeSamples, silent: int = 0) -> None:
        self._n, self._on_samples, self._silent = n, on_samples, silent
        self.table = empty_rows()
        self.unmeasured = self.unlocated = False

    @property
    def full(self) -> bool:
        return len(self.table) == self._n

    def column(self, name: str) -> Samples:
        """Return a column of the loop's rows, (rows,)."""
        return np.asarray(self.table[:, COLUMN[name]])

    def append(self, rows: LoopRows) -> None:
        """Take the loop's next rows."""
        rows = rows[(rows[:, COLUMN["call"]].astype(int) & NONE) == 0]
        rows = rows[: self._n - len(self.table)]
        position_m, force_n = rows[:, COLUMN["position_m"]], rows[:, COLUMN["measured_n"]]
        measured_n = force_n[max(0, self._silent - len(self.table)) :]
        self.unmeasured |= bool(np.isnan(measured_n).any())
        self.unlocated |= not np.isfinite(position_m).all()
        # An infinite force is beyond the limit: the loop has stopped.
        if self.unlocated or not np.isfinite(measured_n).all():
            return
        if len(rows):
            self.table = np.concatenate((self.table, rows))
            self._on_samples(position_m, force_n)


class PressedDevice:
    """Presses with commanded forces; each press starts the device anew.

    object_name: of the object under it, as part of file names. place_m: where the object was last
    put to be pressed. rate_hz: of the samples that are
    kept. sensed: a sensor beside the device measures. room: of the limit of force over the command,
    if none is given. max_mps: limit of speed, likewise: above that of the softest known object.
    """

    rate_hz = RATE_HZ
    start_s: float | None = None  # of the last press, since this device was taken
    place_m: tuple[float, float] | None = None
    sensed = False
    room = 1.3
    max_mps = 0.6

    def __init__(
        self, url: str, object_name: str, limits: Limits, on_progress: Callable[[Progress], None]
    ) -> None:
        """Keep whom to press and within which limits; the device is opened for each press."""
        self.object_name = object_name
        self.session = datetime.now(UTC).isoformat(timespec="seconds")
        self._taken_s = time.perf_counter()
        self.url, self._limits = url, limits
        self._on_progress = on_progress

    def prepare(self) -> JsonObject:
        """Make ready for the first press; what the recordings say of the device."""
        return {}

    def go_to(self, place_m: tuple[float, float]) -> None:
        """Ask whoever runs it to put the object's place, x and y, m, under the tool.

        Raises UsageError if nobody answers.
        """
        if place_m == self.place_m:
            return
        wait_for_enter(
            f"put x = {1e3 * place_m[0]:.4g} mm, y = {1e3 * place_m[1]:.4g} mm of the object under "
            "the tool, which gives no force, and press Enter"
        )
        self.place_m = place_m

    def press(
        self, command_n: Samples, on_samples: TakeSamples = lambda _position_m, _force_n: None
    ) -> tuple[Samples, Samples]:
        """Drive one press; command_n: (n,), N, one value each ms. Returns position_m and force_n.

        Raises DeviceError where the device fails or measures no force, SpringpotError at a limit.
        """
        position_m, force_n = self.measure(command_n, on_samples)
        self.start_s = time.perf_counter() - self._taken_s - len(command_n) / RATE_HZ
        rest(_REST_S)
        return position_m, force_n

    def measure(self, command_n: Samples, on_samples: TakeSamples) -> tuple[Samples, Samples]:
        """Drive one press as `press`, without what comes after it."""
        rows = PressRows(len(command_n), on_samples)
        self.drive(command_n, self.gains, rows, self.room)
        return rows.column("position_m"), rows.column("measured_n")

    @property
    def gains(self) -> Mapping[str, float]:
        """Gains of the force control."""
        # A drive's torque is its own command: fed back, it would only chase itself.
        return OPEN_LOOP if find_driver(self.url).echoes else _GAINS

    def attach(self, runner: SessionRunner) -> None:
        """A press begins with this loop."""

    def drive(
        self, command_n: Samples, gains: Mapping[str, float], rows: PressRows, room: float
    ) -> None:
        """Let the loop follow the command; room: of the limit over it.

        Raises as `press`.
        """
        max_n = float(np.max(np.abs(command_n)))
        max_mps = self._limits.max_speed_mps or self.max_mps
        steps = press_step_functions(command_n, _HEADROOM * max_n, {**gains, "max_mps": max_mps})
        settings = LoopSettings(
            period_s=1 / RATE_HZ,
            seconds=(len(command_n) + _MORE_TICKS) / RATE_HZ + 1.0,
            max_force_n=self._limits.max_force_n or room * max_n,
            max_depth_m=self._limits.max_depth_m,
            sensed=self.sensed,
        )
        requirements = DeviceRequirements(RATE_HZ, WATCHDOG_S, _HEADROOM * max_n, presses=True)
        runner = SessionRunner(
            steps, self.url, requirements, settings, [rows.append], reconnect_s=0.0
        )
        with runner:
            self.attach(runner)
            runner.start()
            self._watch(runner, rows, steps.owners[0])
        line, error = runner.why()
        if not rows.full:
            self._require_no_fault(steps.owners[0])
            raise error or SpringpotError(f"{self.url}: the press did not come to its end: {line}")

    def _watch(self, runner: SessionRunner, rows: PressRows, press: CData) -> None:
        """Watch a press until its rows are full; raise what ends it before: keys, faults."""
        with reading_keys() as pressed:
            for progress in runner.watch(0.05):
                self._on_progress(progress)
                if set(pressed()) & set("q \x1b"):
                    raise KeyboardInterrupt
                if rows.unmeasured:
                    raise self.unmeasured()
                if rows.unlocated:
                    raise DeviceError(
                        f"{self.url}: sent a position that is no number, force zero, stopped: "
                        "check its position sensor; what came before is kept"
                    )
                if progress.state.watchdog_trips and not rows.full:
                    self._require_no_fault(press)
                    raise trip_error(self.url, progress.state, runner.device_failure)
                if rows.full:
                    runner.stop()

    def _require_no_fault(self, press: CData) -> None:
        """Raise what the press itself ended for."""
        if press.fault:
            fault = _FAULTS[press.fault].format(
                mps=press.max_mps, measured_n=press.mean_measured_n, motor_n=press.mean_motor_n
            )
            raise DeviceError(f"{self.url}: {fault}; what came before is kept")

    def unmeasured(self) -> SpringpotError:
        """Return the error of a press that measures no force."""
        return DeviceError(
            f"{self.url}: measures no force: recording needs a load cell, an ODrive of firmware "
            "0.6 that sends its torques (0x1C), or a sensor beside it, --force URL"
        )


def rest(seconds: float) -> None:
    """Wait between two presses; q and escape leave, as in a press."""
    until_s = time.perf_counter() + seconds
    with reading_keys() as pressed:
        while (left_s := until_s - time.perf_counter()) > 0:
            time.sleep(min(left_s, 0.05))
            if set(pressed()) & set("q \x1b"):
                raise KeyboardInterrupt


def trip_error(url: str, state: LoopState, why: str = "") -> DeviceError:
    """Return the error of a watchdog that ended a press: the loop's own, or the device's.

    why: what the device says of it.
    """
    ms = 1e3 * WATCHDOG_S
    if why:
        return DeviceError(f"{url}: {why}; stopped, force zero: press anew")
    if state.tripped:
        return DeviceError(
            f"{url}: switched its motor off: no force reached it for {ms:g} ms, or it met a fault "
            f"of its own; stopped. On this computer {state.late} periods began late: end other "
            "programs, then check cable and power"
        )
    return DeviceError(
        f"{url}: silent for {ms:g} ms while pressing, force zero, stopped: check cable, rate and "
        "power"
    )


def press_step_functions(
    command_n: Samples, max_force_n: float, gains: Mapping[str, float]
) -> StepFunctions:
    """A force controller that follows command_n, one value a tick; gains: fields of sp_press."""
    library = loop_library("double")
    command_n = np.ascontiguousarray(command_n, dtype=np.float64)
    settings: JsonObject = {
        "command_n": library.array(command_n),
        "n": len(command_n),
        "dt_s": 1 / RATE_HZ,
        "max_force_n": max_force_n,
        "watchdog_s": WATCHDOG_S,
        "latched_note": LATCHED,
        **gains,
    }
    press = library.ffi.new("sp_press *", settings)
    c, address = library.c, library.address
    return StepFunctions(
        library,
        step=address(c.sp_press_step),
        idle=address(c.sp_press_idle),
        reset=address(c.sp_press_reset),
        state=address(press),
        measured_n=address(library.ffi.addressof(press, "measured_n")),
        owners=(press, command_n),
    )
