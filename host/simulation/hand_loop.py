"""A scene in closed loop with a simulated hand, in compiled C: sp_closed_loop.h."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.coupling.linear_loop import HandName
from springpot.codegen.coupling.loop_device import ASSUMED_DEVICE, LoopDevice
from springpot.codegen.errors import SpringpotError
from springpot.codegen.messages import short_repr
from springpot.codegen.native.c_library import CLibrary, load_c
from springpot.codegen.types import CData
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.simulation.objects import HAND_NAMES
from springpot.runtime_c.paths import PORT_TESTBENCH, SIM

_TRACED = ("position_m", "velocity_mps", "seen_m", "seen_mps", "force_n")
HAND_SUBSTEPS = 4  # of the hand in a tick: it swings at 5 Hz


@dataclass(frozen=True, eq=False)
class Scenario:
    """Inputs of every tick; arrays of shape (n,).

    dt_s: real time. intended_m: where the hand intends to be at the tick's end. push_n: its force
    in place of its spring, NaN for the spring. error_m: added to what the scene sees, may be NaN.
    dropped: 0, the sample comes; 1, it is lost; 2, it comes with the next one.
    """

    dt_s: Samples
    intended_m: Samples
    push_n: Samples
    error_m: Samples
    dropped: NDArray[np.uint8]
    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class Trace:
    """Outputs of every tick, shape (n,); true position and velocity at the tick's start.

    seen_m, seen_mps: what the scene was given. force_n: what it returned then. felt_n: what acted
    on the tool during the tick.
    """

    position_m: Samples
    velocity_mps: Samples
    seen_m: Samples
    seen_mps: Samples
    force_n: Samples
    felt_n: Samples
    notes: NDArray[np.int32]
    not_finite: int


@dataclass(frozen=True)
class Operator:
    """Who holds which device, and the sensors' seed."""

    hand: HandName
    device: LoopDevice = ASSUMED_DEVICE
    seed: int = 1
    __repr__ = short_repr


class HandLoop:
    """Runs one scene in closed loop, from a fresh state in every run."""

    def __init__(self, library: SceneLibrary) -> None:
        self._library = library
        self._step, self._idle = map(library.address, ("step", "idle"))

    def run(self, scenario: Scenario, operator: Operator, start_m: float = 0.0) -> Trace:
        """Run the scenario with a hand that starts at rest at start_m; sensors are noisy."""
        n = len(scenario.dt_s)
        trace = {name: np.empty(n) for name in _TRACED}
        notes = np.empty(n, dtype=np.int32)
        given = {
            name: np.ascontiguousarray(value, dtype=np.uint8 if name == "dropped" else np.float64)
            for name, value in vars(scenario).items()
        }
        port, state = load_testbench(self._library.real), self._library.new_state()
        addresses = {"step": self._step, "idle": self._idle, "state": state.address}
        scene = {name: port.pointer(address) for name, address in addresses.items()}
        inputs = {name: port.array(values) for name, values in given.items()}
        outputs = {name: port.array(values) for name, values in trace.items()}
        outputs["notes"] = port.array(notes)
        new = port.ffi.new
        not_finite = port.c.sp_closed_loop_run(
            new("sp_closed_loop_scene *", scene),
            held_tool(port, operator, HAND_SUBSTEPS, start_m=start_m),
            n,
            new("sp_closed_loop_scenario *", inputs),
            new("sp_closed_loop_trace *", outputs),
        )
        _check(not_finite)
        late = operator.device.delay_samples
        felt_n = np.concatenate([np.zeros(late), trace["force_n"]])[:n]
        return Trace(**trace, felt_n=felt_n, notes=notes, not_finite=int(not_finite))


def held_tool(
    library: CLibrary,
    operator: Operator,
    substeps: int,
    *,
    start_m: float = 0.0,
    noisy: bool = True,
) -> CData:
    """Return a hand that holds the tool of a device at rest at start_m, m: the C state, sim_tool.

    substeps: of the hand in a tick. noisy: the encoder's position and its filtered difference in
    place of the truth. Raises SpringpotError for a device that cannot be.
    """
    device = operator.device
    held = library.ffi.new(
        "sim_tool_device *",
        {
            "mass_kg": device.mass_kg,
            "viscous_nspm": device.viscous_nspm,
            "coulomb_n": device.coulomb_n,
            "encoder_step_m": device.resolution_um / 1e6,
            "noise_m": device.noise_um / 1e6,
            "delay_samples": device.delay_samples,
        },
    )
    tool, hand = library.memory(library.c.sim_tool_size(), "sim_tool"), operator.hand
    init = library.c.sim_tool_init
    _check(init(tool, HAND_NAMES.index(hand), held, substeps, noisy, operator.seed, start_m))
    return tool


def _check(status: int) -> None:
    if status < 0:
        raise SpringpotError(f"the simulated hand refused its arguments (status {status})")


@cache
def load_testbench(real: str) -> CLibrary:
    """Build the simulated hand and the loop that it closes, for a scene's number type."""
    sources = [PORT_TESTBENCH / "sp_closed_loop.c", *sorted(SIM.glob("*.c"))]
    return load_c([SIM / "sim.h", PORT_TESTBENCH / "sp_closed_loop.h"], sources, real)
