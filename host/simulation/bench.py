"""The simulated bench: soft objects, device and hands of runtime_c/sim, as a device `sim://OBJECT`."""

from collections.abc import Callable
from functools import cache

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.native.c_library import CLibrary, load_c
from springpot.codegen.types import CData, JsonObject
from springpot.host.simulation.objects import (
    ALL_OBJECTS,
    PLACED_OBJECTS,
    VARIANTS,
    SimulatedObject,
)
from springpot.runtime_c import paths

MAX_COMMAND_N = 12.0
DT_S = 0.001
SUBSTEPS = 16
_CHUNK = 250  # samples handed on at once


class SimulatedBench:
    """An object under a force-controlled device at 1 kHz, as its sensors see it.

    rate_hz: of the samples that are kept. session: of this object and what is random about it.
    place_m: where a lump is pressed, m; None of an object that is the same everywhere.
    """

    start_s: float | None = None  # of the last press, if it met what the ones before had pressed
    _state: CData = None
    _ticks = 0  # since this object was put there

    def __init__(self, simulated: SimulatedObject, substeps: int = SUBSTEPS) -> None:
        """Put the object under the device; substeps of the integrator in each ms."""
        self.object_name, self.rate_hz = simulated.name, simulated.presses.rate_hz
        self.session = f"{simulated.name}, seed {simulated.seed}"
        placed = simulated.name in PLACED_OBJECTS
        self.place_m = (simulated.x_m, simulated.y_m) if placed else None
        self._simulated, self._substeps = simulated, substeps
        self._library = bench_library()
        self._presses = 0

    def prepare(self) -> JsonObject:
        """Nothing: it is ready."""
        return {}

    def go_to(self, place_m: tuple[float, float]) -> None:
        """Press a fresh object at another place, x and y, m, from now on.

        Raises UsageError if the object is the same everywhere.
        """
        if self.place_m is None:
            raise UsageError(
                f"sim://{self.object_name}: is the same everywhere: give sim://lump to a protocol "
                "of places"
            )
        if place_m == self.place_m:
            return
        self.place_m, self._state = place_m, None

    def press(
        self,
        command_n: Samples,
        on_samples: Callable[[Samples, Samples], None] = lambda _position_m, _force_n: None,
    ) -> tuple[Samples, Samples]:
        """Drive one press from rest; every press has noise of its own.

        command_n: (n,), N, one value each ms.
        Returns position_m and force_n at `rate_hz`, and calls on_samples with the newest of both
        about four times a second. Raises DeviceError where the command is beyond the device.
        """
        command_n = np.ascontiguousarray(command_n, dtype=np.float64)
        if not np.all(np.abs(command_n) <= MAX_COMMAND_N):
            raise DeviceError(
                f"the command reaches {np.max(np.abs(command_n)):.1f} N and the simulated device "
                f"gives {MAX_COMMAND_N:g} N: lower the protocol's amplitude_n"
            )
        settings, step = self._simulated.presses, round(1 / (DT_S * self.rate_hz))
        if self._state is None or settings.rest_s is None:
            self._put_object()
        else:
            self._move(np.zeros(round(settings.rest_s / DT_S)))
        self._presses += 1
        self.start_s = None if settings.rest_s is None else DT_S * self._ticks
        parts = []
        chunk = step * max(1, _CHUNK // step)
        for begin in range(0, len(command_n), chunk):
            begin_s = DT_S * self._ticks
            position_m, force_n = self._move(command_n[begin : begin + chunk])
            time_s = begin_s + DT_S * np.arange(len(force_n))
            force_n += (settings.drift_npmin / 60.0) * time_s
            if settings.glitch and begin == 0:
                position_m[0] = 0.0
            parts.append((position_m[::step], force_n[::step]))
            on_samples(*parts[-1])
        return np.concatenate([p for p, _ in parts]), np.concatenate([f for _, f in parts])

    def _put_object(self) -> None:
        """Put a fresh object on the bench, with a noise of its own for each press."""
        c, memory = self._library.c, self._library.memory
        self._state, self._ticks = memory(c.sim_bench_size(), "sim_bench"), 0
        seed = (self._simulated.seed << 32) + self._presses
        of_object, delay_samples = object_arguments(self._simulated), self._simulated.delay_samples
        _check(c.sim_bench_init(self._state, *of_object, seed, delay_samples, self._substeps))
        if self.place_m is not None:
            _check(c.sim_bench_place(self._state, *self.place_m))

    def _move(self, command_n: Samples) -> tuple[Samples, Samples]:
        """Follow a command; position_m and force_n of every ms, both (n,)."""
        command_n = np.ascontiguousarray(command_n)
        position_m, force_n = np.empty_like(command_n), np.empty_like(command_n)
        arrays = map(self._library.array, (command_n, position_m, force_n))
        _check(self._library.c.sim_bench_record(self._state, len(command_n), *arrays))
        self._ticks += len(command_n)
        return position_m, force_n


@cache
def bench_library() -> CLibrary:
    """Load the simulated objects, device and hands."""
    return load_c([paths.SIM / "sim.h"], sorted(paths.SIM.glob("*.c")))


def object_arguments(simulated: SimulatedObject) -> tuple[int, int, float]:
    """Return object, variant and stiffness factor as the C takes them."""
    names = ALL_OBJECTS.index(simulated.name), VARIANTS.index(simulated.variant)
    return *names, simulated.stiffer


def _check(status: int) -> None:
    """Raise ValueError for a negative status: our own wrong use of the C."""
    if status < 0:
        raise ValueError(f"the simulated bench refused its arguments (status {status})")
