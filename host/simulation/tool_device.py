"""A device as the C of the simulated hand takes it: sim_tool_device of sim.h."""

from typing import Any

from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.host.native.c_library import CLibrary


def tool_device(library: CLibrary, device: LoopDevice) -> Any:
    """The struct, for a call of sim_tool_init."""
    return library.ffi.new(
        "sim_tool_device *",
        {
            "mass_kg": device.mass_kg,
            "viscous_nspm": device.viscous_nspm,
            "coulomb_n": device.coulomb_n,
            "encoder_step_m": device.resolution_um / 1e6,
            "delay_samples": device.delay_samples,
        },
    )
