"""The linear loop that a scene closes: an object's tangent, a coupling, a delay, and a hand."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.coupling.gains import state_transition
from springpot.codegen.coupling.loop_device import ASSUMED_DEVICE, LoopDevice
from springpot.codegen.scene import Coupling
from springpot.codegen.stages.windows import LOWPASS_TAU_S as VELOCITY_S
from springpot.codegen.types import Scalar

_LIMIT_TOLERANCE = 1.001  # of the first unstable stiffness
Matrices = Samples
HandName = Literal["mid", "firm", "light"]


@dataclass(frozen=True)
class Hand:
    """A hand that holds the device: one mass with it, on a spring and a damper."""

    name: HandName
    mass_kg: float
    stiffness_npm: float
    damping_nspm: float


# From a stiff pinch to one fingertip; the first one is the design hand.
HAND_MODELS = (
    Hand("mid", 0.25, 400.0, 6.0),
    Hand("firm", 0.03, 5000.0, 5.0),
    Hand("light", 0.03, 50.0, 0.5),
)
DESIGN_HAND = HAND_MODELS[0]
# The hands of every check, and samples beyond the device's own delay.
CHECKED_HANDS = (*((hand, 0) for hand in HAND_MODELS), (DESIGN_HAND, 1))


@dataclass(frozen=True)
class LinearLoop:
    """All of the loop but the object's stiffness.

    coupling: its mode is "off", "tool" or "proxy". smoothing: weight of the newest force, 1 none.
    The device's Coulomb friction does not count: it would only brake.
    """

    dt_s: float
    coupling: Coupling
    hand: Hand
    device: LoopDevice = ASSUMED_DEVICE
    smoothing: float = 1.0

    def spectral_radius(self, stiffness_npm: float | Samples) -> Samples:
        """Maximum |eigenvalue| of one tick for each object stiffness (n,), N/m: shape (n,)."""
        matrices = self._tick(np.atleast_1d(np.asarray(stiffness_npm, dtype=np.float64)))
        radius: Samples = np.abs(np.linalg.eigvals(matrices)).max(axis=1)
        return radius

    def swing_radius(self, stiffness_npm: float | Samples) -> Samples:
        """Return `spectral_radius` of the swings alone: without the positive eigenvalues below 1.

        Those creep to their end, however slowly, and no hand feels them vibrate.
        """
        values = np.linalg.eigvals(self._tick(np.atleast_1d(np.asarray(stiffness_npm, np.float64))))
        creeps = (values.imag == 0.0) & (values.real > 0.0) & (values.real < 1.0)
        radius: Samples = np.where(creeps, 0.0, np.abs(values)).max(axis=1)
        return radius

    def max_stiffness_npm(self) -> float:
        """Return the stiffness, N/m, up to which the loop is stable with every softer object too.

        1e7 where it is with all; 0 where it is not even with the softest.
        """
        grid = np.geomspace(1.0, 1e7, 400)
        low = 0.0
        while len(unstable := np.flatnonzero(self.spectral_radius(grid) >= 1.0)):
            first = int(unstable[0])
            if first == 0:
                return low
            low, high = float(grid[first - 1]), float(grid[first])
            if high / low < _LIMIT_TOLERANCE:
                return low
            grid = np.linspace(low, high, 20)
        return 1e7

    def _tick(self, stiffness_npm: Samples) -> Matrices:
        """Return the loop's matrix for each stiffness of the object: (n, states, states).

        Its columns are one tick applied to each unit vector of the state: tool and its past, proxy,
        the smoothed force and those that are under way to the motor.
        """
        mode = self.coupling.mode
        states, n = 4 + 2 * (mode != "off") + 1 + self.device.delay_samples, len(stiffness_npm)
        unit = np.eye(states)
        x, v, x_before, v_held = unit[:4]
        weight = self.dt_s / (self.dt_s + VELOCITY_S)
        v_held = v_held + weight * ((x - x_before) / self.dt_s - v_held)
        proxy: list[Scalar] = []
        k = stiffness_npm[:, None]
        if mode == "off":
            force = k * x
            v_held = 0.0 * v_held
        else:
            x_p, v_p = unit[4:6]
            force, *proxy = self._couple(x, v_held, x_p, v_p, k * (x_p if mode == "proxy" else x))
        force_index = 4 + len(proxy)
        smoothed = self.smoothing * force + (1.0 - self.smoothing) * unit[force_index]
        queue = [smoothed, *unit[force_index : force_index + self.device.delay_samples]]
        moved_x, moved_v = self._move(x, v, queue[-1])
        next_state = np.empty((n, states, states))
        for row, value in enumerate([moved_x, moved_v, x, v_held, *proxy, *queue]):
            next_state[:, row] = value
        return next_state

    def _couple(
        self, x: Scalar, v: Scalar, x_p: Scalar, v_p: Scalar, model_n: Scalar
    ) -> tuple[Scalar, Scalar, Scalar]:
        """Step the coupling of sp_couple.h: return the force at the tool, and the moved proxy."""
        coupling = self.coupling
        k, b, m = coupling.stiffness_npm, coupling.damping_nspm, coupling.mass_kg
        phi = state_transition(k, b, m, self.dt_s)
        e, w, rest = x_p - x, v_p - v, -model_n / k
        force = -k * e - b * w
        x_next = x + self.dt_s * v + rest + phi[0, 0] * (e - rest) + phi[0, 1] * w
        return force, x_next, v + phi[1, 0] * (e - rest) + phi[1, 1] * w

    def _move(self, x: Scalar, v: Scalar, force: Scalar) -> tuple[Scalar, Scalar]:
        """Hand and device under a force that is held for a tick, exactly."""
        hand, device = self.hand, self.device
        b, m = hand.damping_nspm + device.viscous_nspm, hand.mass_kg + device.mass_kg
        phi = state_transition(hand.stiffness_npm, b, m, self.dt_s)
        rest = -force / hand.stiffness_npm
        return rest + phi[0, 0] * (x - rest) + phi[0, 1] * v, phi[1, 0] * (x - rest) + phi[1, 1] * v
