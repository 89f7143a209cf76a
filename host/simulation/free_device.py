"""A simulated device that nobody holds (runtime_c/sim/sim_free.h): what is measured without
hardware, and what tests know the truth of."""

from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

from springpot.host.native.c_library import CLibrary, load
from springpot.runtime_c import paths


@dataclass(frozen=True)
class FreeDeviceTruth:
    """What the device is, by the names of sim_free_settings.

    velocity_noise_mps: negative where velocity is the difference of two positions. sign: 1 where a
    positive command pushes the tool out. bristle_m, static_ratio: LuGre friction, where not 0.
    """

    mass_kg: float = 0.2
    viscous_nspm: float = 2.0
    coulomb_n: float = 0.1
    delay_s: float = 0.001
    position_step_m: float = 10e-6
    position_noise_m: float = 0.0
    velocity_noise_mps: float = -1.0
    sign: float = 1.0
    max_n: float = 10.0
    bias_n: float = 0.0
    bristle_m: float = 0.0
    static_ratio: float = 1.0
    cogging_n: float = 0.0
    cogging_pitch_m: float = 0.0
    seed: int = 0


class FreeDevice:
    """One such device, ticked in lock step."""

    def __init__(self, truth: FreeDeviceTruth, dt_s: float) -> None:
        """At rest at 0. Raises ValueError for a delay beyond 100 ticks."""
        self._library = _library()
        self._state = self._library.memory(self._library.c.sim_free_size(), "sim_free")
        settings = self._library.ffi.new("sim_free_settings *", asdict(truth))
        if self._library.c.sim_free_init(self._state, settings, dt_s) < 0:
            raise ValueError(f"no such device: {truth}")
        self._seen = self._library.ffi.new("double[2]")

    @property
    def address(self) -> int:
        """Address of the C state, for C that moves the device."""
        return self._library.address(self._state)

    def step(self, command_n: float) -> tuple[float, float]:
        """One tick under a command; position_m and velocity_mps at its end, as sensors see them."""
        return self._read(self._library.c.sim_free_step, command_n)

    def true_motion(self) -> tuple[float, float]:
        """Position, m, and velocity, m/s, without sensors."""
        return self._read(self._library.c.sim_free_truth)

    def _read(self, function: Any, *command_n: float) -> tuple[float, float]:
        function(self._state, *command_n, self._seen, self._seen + 1)
        return self._seen[0], self._seen[1]


@cache
def _library() -> CLibrary:
    return load([paths.SIM / "sim_free.h"], sorted(paths.SIM.glob("*.c")))
