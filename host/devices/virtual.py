"""Devices without hardware: a simulated hand or a free device (sim://), a recording (replay://)."""

from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.errors import DataError, UsageError
from springpot.host.devices.device import DeviceRequirements, OpenedDevice, VirtualDevice, too_weak
from springpot.host.devices.url import Address
from springpot.host.native.c_library import CLibrary
from springpot.host.simulation.bench import SimulatedHand
from springpot.host.simulation.free_device import FreeDevice, FreeDeviceTruth
from springpot.host.simulation.objects import PressSettings, parse_url
from springpot.trainer.recordings.recording_file import read_recording

# What the hand intends; its spring and the rendered force decide how deep it comes.
_INTENDED_M, _PRESSES_HZ = 0.02, 0.5
FREE = "free"  # sim://free
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


def simulated_device(address: Address, requirements: DeviceRequirements) -> OpenedDevice:
    """What a sim:// URL names. Raises UsageError for what is none of it."""
    kind = SimulatedFreeDevice if address.place == FREE else SimulatedDevice
    return kind(address, requirements)


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


class SimulatedDevice(VirtualDevice):
    """A hand that presses into whatever the scene renders."""

    def __init__(self, address: Address, requirements: DeviceRequirements) -> None:
        """Take the hand of the URL. Raises UsageError for a wrong one."""
        _require_no_measuring(address, requirements)
        simulated = parse_url(address.url)
        if simulated.presses != PressSettings():
            raise UsageError(
                f"{address.url}: rest, rate, drift and glitch are of recorded presses: leave them "
                "out where a scene is rendered"
            )
        self._hand = SimulatedHand(
            simulated.hand,
            device=LoopDevice(delay_samples=simulated.delay_samples),
            noisy=True,
            seed=simulated.seed,
        )
        self._dt_s = 1 / requirements.rate_hz
        self._memory: Any = None

    def link(self, library: CLibrary) -> Any:
        self._memory = library.memory(library.c.sp_link_sim_size())
        tool = library.pointer(self._hand.address)
        return library.c.sp_link_sim_init(self._memory, tool, self._dt_s, _INTENDED_M, _PRESSES_HZ)


class ReplayDevice(VirtualDevice):
    """The positions of a recording, one a tick; its end ends the session."""

    def __init__(self, address: Address, requirements: DeviceRequirements) -> None:
        """Read it. Raises DataError where it cannot be read or has another rate."""
        _require_no_measuring(address, requirements)
        address.require_known(())
        recording = read_recording(Path(address.place))
        rate_hz = requirements.rate_hz
        if abs(recording.dt_s * rate_hz - 1) > 1e-3:
            raise DataError(
                f"{address.place} is sampled at {recording.rate_hz:g} Hz, the scene runs at "
                f"{rate_hz:g} Hz: import it with --resample-hz {rate_hz:g}"
            )
        self._position_m = np.ascontiguousarray(recording.position_m)
        self._velocity_mps = np.ascontiguousarray(
            backward_velocity(self._position_m, recording.dt_s)
        )
        self._memory: Any = None

    def link(self, library: CLibrary) -> Any:
        self._memory = library.memory(library.c.sp_link_replay_size())
        return library.c.sp_link_replay_init(
            self._memory,
            len(self._position_m),
            library.array(self._position_m),
            library.array(self._velocity_mps),
        )


def _require_no_measuring(address: Address, requirements: DeviceRequirements) -> None:
    if requirements.free:
        raise UsageError(
            f"{address.url}: is no device that is free to move: give a real one that nobody "
            "holds, or sim://free"
        )


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
