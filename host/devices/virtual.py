"""Devices without hardware: a simulated hand (sim://), a recording (replay://)."""

from pathlib import Path

import numpy as np

from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.types import CData
from springpot.host.devices.device import DeviceRequirements, VirtualDevice
from springpot.host.devices.drivers import Address
from springpot.host.native.c_library import CLibrary
from springpot.host.simulation.bench import SUBSTEPS
from springpot.host.simulation.hand_loop import Operator, held_tool
from springpot.host.simulation.objects import PressSettings, parse_url
from springpot.trainer.recordings.recording_file import read_recording

# What the hand intends; its spring and the rendered force decide how deep it comes.
_INTENDED_M, _PRESSES_HZ = 0.02, 0.5


class SimulatedDevice(VirtualDevice):
    """A hand that presses into whatever the scene renders."""

    def __init__(self, address: Address, requirements: DeviceRequirements) -> None:
        """Take the hand of the URL. Raises UsageError for a wrong one."""
        simulated = parse_url(address.url)
        of_object = (simulated.variant, simulated.stiffer) != ("a", 1.0)
        if of_object or simulated.presses != PressSettings():
            raise UsageError(
                f"{address.url}: variant, stiffer, rest, rate, drift and glitch are of recorded "
                "presses: leave them out where a scene is rendered"
            )
        device = LoopDevice(delay_samples=simulated.delay_samples)
        self._operator = Operator(simulated.hand, device, simulated.seed)
        self._dt_s = 1 / requirements.rate_hz
        self._memory: CData = None

    def link(self, library: CLibrary) -> CData:
        link = library.memory(library.c.sp_link_sim_size())
        tool = held_tool(library, self._operator, SUBSTEPS)
        self._memory = (link, tool)
        return library.c.sp_link_sim_init(link, tool, self._dt_s, _INTENDED_M, _PRESSES_HZ)


class ReplayDevice(VirtualDevice):
    """The positions of a recording, one a tick; its end ends the session."""

    def __init__(self, address: Address, requirements: DeviceRequirements) -> None:
        """Read it. Raises DataError where it cannot be read or has another rate."""
        address.require_known(())
        recording = read_recording(Path(address.place))
        rate_hz = requirements.rate_hz
        if abs(recording.dt_s * rate_hz - 1) > 1e-3:
            raise DataError(
                f"{address.place} is sampled at {recording.rate_hz:g} Hz, the scene runs at "
                f"{rate_hz:g} Hz: import it from its source with --resample-hz {rate_hz:g}"
            )
        self._position_m = np.ascontiguousarray(recording.position_m)
        self._velocity_mps = np.ascontiguousarray(
            backward_velocity(self._position_m, recording.dt_s)
        )
        self._memory: CData = None

    def link(self, library: CLibrary) -> CData:
        self._memory = library.memory(library.c.sp_link_replay_size())
        return library.c.sp_link_replay_init(
            self._memory,
            len(self._position_m),
            library.array(self._position_m),
            library.array(self._velocity_mps),
        )
