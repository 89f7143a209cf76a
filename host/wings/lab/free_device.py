"""A simulated device that nobody holds (runtime_c/sim/sim_free.h): to measure without hardware."""

from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

from springpot import UsageError
from springpot.devices import Address, DeviceRequirements, VirtualDevice, too_weak
from springpot.native import SIM, CLibrary, load_c

# Settings of sim://free: default, least, most, and what one is of the device's own unit.
_FREE_SETTINGS = {
    "mass": ("mass_kg", 0.2, 0.001, 100.0, 1.0),
    "viscous": ("viscous_nspm", 2.0, 0.0, 1e3, 1.0),
    "coulomb": ("coulomb_n", 0.1, 0.0, 1e3, 1.0),
    "delay_ms": ("delay_s", 1.0, 0.0, 10.0, 1e-3),
    "step_um": ("position_step_m", 10.0, 0.0, 1e4, 1e-6),
    "noise_um": ("position_noise_m", 3.0, 0.0, 1e4, 1e-6),
    "velocity_noise_mps": ("velocity_noise_mps", -1.0, 0.0, 10.0, 1.0),
    "sign": ("sign", 1.0, -1.0, 1.0, 1.0),
    "max_n": ("max_n", 10.0, 0.0, 1e4, 1.0),
    "bias_n": ("bias_n", 0.0, -1e3, 1e3, 1.0),
}


@dataclass(frozen=True)
class FreeDeviceTruth:
    """Hold the true parameters of a device, by the names of sim_free_settings.

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
    return load_c([SIM / "sim_free.h"], sorted(SIM.glob("*.c")))


class SimulatedFreeDevice(VirtualDevice):
    """A device that nobody holds: to be measured, nothing else."""

    def __init__(self, address: Address, requirements: DeviceRequirements) -> None:
        """Make it. Raises UsageError for a wrong URL, or where something is to be rendered."""
        if not requirements.free:
            raise UsageError(
                f"{address.url}: nobody holds that device, it is there for `springpot identify`: "
                "to render or record, give sim://OBJECT"
            )
        truth = _free_truth(address)
        self.max_n = truth.max_n
        if truth.max_n < requirements.max_n:
            gives = f"gives at most {truth.max_n:g} N"
            raise too_weak(address.url, gives, requirements, truth.max_n)
        self._device = FreeDevice(truth, 1 / requirements.rate_hz)
        self._memory: Any = None

    def link(self, library: CLibrary) -> Any:
        self._memory = library.memory(library.c.sp_link_free_size())
        return library.c.sp_link_free_init(self._memory, library.pointer(self._device.address))


def _free_truth(address: Address) -> FreeDeviceTruth:
    address.require_known((*_FREE_SETTINGS, "seed"))
    sign = address.number("sign", 1.0, -1.0, 1.0)
    if sign not in (-1.0, 1.0):
        raise UsageError(f"{address.url}: sign={sign:g}: give 1 or -1")
    values = {
        name: unit * address.number(key, default, least, most)
        for key, (name, default, least, most, unit) in _FREE_SETTINGS.items()
    }
    return FreeDeviceTruth(**values, seed=int(address.number("seed", 0, 0, 2**32 - 1)))
