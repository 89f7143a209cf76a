"""A scene that slides, in closed loop with a simulated hand of three axes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import SpringpotError
from springpot.codegen.short_repr import short_repr
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.simulation.hand_loop import HAND_SUBSTEPS, Operator, load_testbench, tool_device
from springpot.host.simulation.objects import HAND_NAMES

# A force pushes along x and y, and out of the object along the depth; that of the hand's C pushes
# against its axis.
AGAINST = np.array([-1.0, -1.0, 1.0])


@dataclass(frozen=True, eq=False)
class SlideTrace:
    """Hold a motion and its forces, (n, 3): x, y and depth at each tick's start, without noise.

    force_n: what the scene returned then. felt_n: what acted on the tool during the tick. notes:
    (n,).
    """

    position_m: Samples
    velocity_mps: Samples
    force_n: Samples
    felt_n: Samples
    notes: NDArray[np.int32]
    __repr__ = short_repr

    @property
    def work_j(self) -> Samples:
        """Work of the hand against the scene up to each tick's end, (n - 1,)."""
        ways_m = np.diff(self.position_m, axis=0)
        return np.cumsum((ways_m * self.felt_n[:-1]) @ AGAINST)


def run_slide(
    scene: SceneLibrary,
    operator: Operator,
    dt_s: float,
    intended_m: Samples,
    lost: Sequence[int] | NDArray[np.int64] = (),
) -> SlideTrace:
    """Run sp_step3 from a fresh state under a hand that intends to be at intended_m, (n, 3), m.

    It starts there at rest. Sensors are noisy. lost: ticks that get no sample: sp_idle3.
    """
    tools = _Tools(operator, intended_m[0])
    state, seen_m = scene.new_state(), np.array(intended_m[0])
    n = len(intended_m)
    position_m, velocity_mps, force_n = np.empty((3, n, 3))
    notes = np.empty(n, dtype=np.int32)
    idle = set(np.asarray(lost).tolist())
    for i, intended in enumerate(intended_m):
        position_m[i], velocity_mps[i] = tools.truth()
        force_n[i], notes[i] = state.idle3(dt_s) if i in idle else state.step3(seen_m)
        seen_m = tools.step(dt_s, intended, force_n[i])
    late = operator.device.delay_samples
    felt_n = np.concatenate([np.zeros((late, 3)), force_n])[:n]
    return SlideTrace(position_m, velocity_mps, force_n, felt_n, notes)


class _Tools:
    """A hand and its device in each axis."""

    def __init__(self, operator: Operator, start_m: Samples) -> None:
        self._port = load_testbench("double")
        self._tools = [self._tool(operator, k, float(start_m[k])) for k in range(3)]
        self._at, self._speed = (self._port.ffi.new("double *") for _ in range(2))

    def _tool(self, operator: Operator, axis: int, start_m: float) -> Any:
        port = self._port
        tool = port.memory(port.c.sim_tool_size(), "sim_tool")
        status = port.c.sim_tool_init(
            tool, HAND_NAMES.index(operator.hand), tool_device(port, operator.device),
            HAND_SUBSTEPS, 1, operator.seed + axis, start_m,
        )  # fmt: skip
        if status < 0:
            raise SpringpotError(f"the simulated hand refused its arguments (status {status})")
        return tool

    def truth(self) -> tuple[list[float], list[float]]:
        """Position, m, and velocity, m/s, of each axis."""
        found = []
        for tool in self._tools:
            self._port.c.sim_tool_truth(tool, self._at, self._speed)
            found.append((self._at[0], self._speed[0]))
        at, speed = zip(*found, strict=True)
        return list(at), list(speed)

    def step(self, dt_s: float, intended_m: Samples, force_n: Samples) -> Samples:
        """One tick; what the sensors then see, (3,), m."""
        seen = np.empty(3)
        for k, tool in enumerate(self._tools):
            self._port.c.sim_tool_step(
                tool, dt_s, intended_m[k], AGAINST[k] * force_n[k], self._at, self._speed
            )
            seen[k] = self._at[0]
        return seen
