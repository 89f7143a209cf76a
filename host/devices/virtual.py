"""Devices without hardware: a simulated hand (sim://), a recording (replay://)."""

from pathlib import Path

import numpy as np

from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.emit.golden import differentiate
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.types import CData
from springpot.host.devices.device import DeviceRequirements, VirtualDevice
from springpot.host.devices.drivers import Address, parse_device
from springpot.host.simulation.bench import SUBSTEPS
from springpot.host.simulation.hand_loop import Operator, held_tool
from springpot.host.simulation.objects import (
    ALL_OBJECTS,
    BENCH_RATE_HZ,
    HAND_NAMES,
    OBJECTS,
    PLACED_OBJECTS,
    VARIANTS,
    PressSettings,
    SimulatedObject,
)
from springpot.trainer.recordings.recording_file import read_recording

# What the hand intends; its spring and the rendered force decide how deep it comes.
_INTENDED_M, _PRESSES_HZ = 0.02, 0.5


_SETTINGS = ("variant", "stiffer", "hand", "seed", "delay", "rest", "rate", "drift", "glitch",
             "x", "y")  # fmt: skip


def parse_url(url: str, default_seed: int = 0) -> SimulatedObject:
    """Read `sim://OBJECT?variant=b&stiffer=10&hand=mid&seed=1&delay=1`.

    Presses take `rest=5&rate=50&drift=0.1&glitch=1` beside it; a lump `x=0.005&y=0.01`, m.
    default_seed: where the URL has none.
    Raises UsageError naming what is unknown and listing what exists.
    """
    address = parse_device(url)
    address.require_known(_SETTINGS)
    number, choice, name = address.number, address.choice, address.place.removesuffix("/")
    if name not in ALL_OBJECTS:
        raise UsageError(f"{url}: no object {name!r}: use one of {', '.join(ALL_OBJECTS)}")
    rate_hz = address.whole("rate", BENCH_RATE_HZ, 1, BENCH_RATE_HZ)
    if BENCH_RATE_HZ % rate_hz:
        raise UsageError(
            f"{url}: rate={rate_hz}: the bench samples at {BENCH_RATE_HZ} Hz: give a whole part of "
            "that, such as 500, 200, 100 or 50"
        )
    presses = PressSettings(
        rest_s=number("rest", 0.0, 0.0, 3600.0) if "rest" in address.settings else None,
        rate_hz=rate_hz,
        drift_npmin=number("drift", 0.0, -1.0, 1.0),
        glitch=choice("glitch", ("0", "1")) == "1",
    )
    simulated = SimulatedObject(
        name,
        variant=choice("variant", VARIANTS),
        stiffer=number("stiffer", 1.0, 0.01, 1000.0),
        hand=choice("hand", HAND_NAMES),
        seed=address.whole("seed", default_seed, 0, 2**31 - 1),
        delay_samples=address.whole("delay", 0, 0, 1),
        presses=presses,
        x_m=number("x", 0.0, -1.0, 1.0),
        y_m=number("y", 0.0, -1.0, 1.0),
    )
    if name not in PLACED_OBJECTS and (simulated.x_m or simulated.y_m):
        raise UsageError(f"{url}: {name} is the same everywhere: leave x and y out")
    if name not in OBJECTS and simulated.variant != "a":
        raise UsageError(
            f"{url}: variant={simulated.variant}: {name} has no variants, they are of "
            f"{', '.join(OBJECTS)}: leave variant out"
        )
    return simulated


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
        self._velocity_mps = np.ascontiguousarray(differentiate(self._position_m, recording.dt_s))
        self._memory: CData = None

    def link(self, library: CLibrary) -> CData:
        """Make the link that gives the recording's samples one by one."""
        self._memory = library.memory(library.c.sp_link_replay_size())
        return library.c.sp_link_replay_init(
            self._memory,
            len(self._position_m),
            library.array(self._position_m),
            library.array(self._velocity_mps),
        )
