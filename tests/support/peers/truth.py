"""A simulated object, and a hand that holds a tool, without the devices that measure them."""

import numpy as np

from springpot.codegen.coupling.linear_loop import HandName
from springpot.codegen.coupling.loop_device import ASSUMED_DEVICE, LoopDevice
from springpot.host.simulation.bench import SUBSTEPS, bench_library, object_arguments
from springpot.host.simulation.hand_loop import Operator, held_tool
from springpot.host.simulation.objects import SimulatedObject


def check(status: int) -> None:
    """Raise ValueError where the C refuses its arguments."""
    if status < 0:
        raise ValueError(f"status {status}")


class ObjectMotion:
    """One object under a prescribed motion. Moves go on where the last one ended."""

    def __init__(
        self, simulated: SimulatedObject, dt_s: float = 1e-3, substeps: int = SUBSTEPS
    ) -> None:
        library, given = bench_library(), object_arguments(simulated)
        self._c, self._array = library.c, library.array
        self._state = library.memory(self._c.sim_object_size(), "sim_object")
        check(self._c.sim_object_init(self._state, *given, dt_s, substeps))
        if simulated.name == "lump":
            check(self._c.sim_object_place(self._state, simulated.x_m, simulated.y_m))

    def move(self, position_m: np.ndarray) -> np.ndarray:
        """Return the true force (n,), N, at each position (n,), m, linear between samples."""
        held_m = np.ascontiguousarray(position_m, dtype=np.float64)
        force_n, array = np.empty_like(held_m), self._array
        check(self._c.sim_object_move(self._state, len(held_m), array(held_m), array(force_n)))
        return force_n


class SimulatedHand:
    """A hand holding the device: a mass, a spring to where it intends to be, a damper."""

    def __init__(
        self,
        hand: HandName = "mid",
        device: LoopDevice = ASSUMED_DEVICE,
        noisy: bool = False,
        seed: int = 0,
    ) -> None:
        library = bench_library()
        self._c = library.c
        self._tool = held_tool(library, Operator(hand, device, seed), SUBSTEPS, noisy=noisy)
        self._out = library.ffi.new("double[2]")

    def step(self, dt_s: float, intended_m: float, force_n: float) -> tuple[float, float]:
        """Advance one tick of `dt_s` under a rendered force; return position_m, velocity_mps."""
        out = self._out
        check(self._c.sim_tool_step(self._tool, dt_s, intended_m, force_n, out, out + 1))
        return out[0], out[1]
