"""Gain margin of the loop of hand, device, coupling and object, and its vibration from noise.

From the loop's frequency response. All but the object is stable by itself, so the least gain on
the object's force at which the response passes -1 is the first at which the loop is unstable.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.coupling.gains import state_transition
from springpot.codegen.coupling.linear_loop import CHECKED_HANDS, Hand
from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.coupling.object_tangent import ObjectTangent, Response
from springpot.codegen.scene import Coupling
from springpot.codegen.stages.windows import LOWPASS_TAU_S

_MIN_HZ = 0.5
# Frequencies even in their logarithm, for hands of .5 Hz and more; and even, up to half the rate.
_N_LOG, _N_EVEN = 320, 160


@dataclass(frozen=True)
class LoopMargin:
    """The worst of hands, delays and depths.

    gain_margin: how many times as stiff as it is the loop just holds the object, at depths that a
    hand holds; pressed_margin: at those that are only pressed. vibration_mps: RMS speed of the
    tool at rest from the encoder's noise and steps. hand, extra_delay: of the gain margin.
    as_spring: the object was counted as one, without losses.
    """

    gain_margin: float
    pressed_margin: float
    vibration_mps: float
    hand: Hand
    extra_delay: int
    as_spring: bool

    @property
    def object_text(self) -> str:
        """The object, and how it was counted if that is cautious."""
        return "this object" + (" (taken as a spring without losses)" if self.as_spring else "")

    @property
    def least(self) -> float:
        """The gain margin at any depth."""
        return min(self.gain_margin, self.pressed_margin)

    @property
    def is_stable(self) -> bool:
        """True if the loop holds the object as it is."""
        return self.least > 1.0

    @property
    def hand_text(self) -> str:
        """The hand, and its delay beyond the device's own."""
        return f"{self.hand.name} hand{', a sample later' if self.extra_delay else ''}"


@dataclass(frozen=True, eq=False)
class LoopOnCircle:
    """The loop but its coupling, at points z of a circle, (n,).

    object_npm: force over depth, (depths, n). compliance: tool over force, m/N, (n,).
    """

    dt_s: float
    z: Response
    object_npm: Response
    compliance: Response

    @staticmethod
    def build(
        tangent: ObjectTangent,
        dt_s: float,
        device: LoopDevice,
        smoothing: float,
        hand: Hand,
        extra_delay: int,
        radius: float = 1.0,
    ) -> "LoopOnCircle":
        """Evaluate object, hand and delay at the points z of a circle, on which stability is read.

        radius: 1 for stability; below 1, for loops whose every motion decays as fast as that.
        """
        z = radius * np.exp(1j * _angles(dt_s))
        moved = _compute_compliance(hand, device, dt_s, z)
        delayed = moved * z ** -(device.delay_samples + extra_delay)
        smoothed = smoothing / (1.0 - (1.0 - smoothing) / z)
        return LoopOnCircle(dt_s, z, tangent.compute_response(z), delayed * smoothed)

    def gain_margins(self, coupling: Coupling) -> Samples:
        """Return the gain margin on the object's force at each depth, (depths,).

        0 with a coupling that is unstable without any object.
        """
        proxy_per_tool, proxy_per_force, tool_npm, force_gain = _couple(coupling, self.dt_s, self.z)
        if _limit_gain((self.compliance * tool_npm)[None])[0] <= 1.0:
            return np.zeros(len(self.object_npm))
        closed = self.compliance * force_gain / (1.0 + self.compliance * tool_npm)
        if coupling.mode == "proxy":
            closed = proxy_per_tool * closed - proxy_per_force
        return _limit_gain(self.object_npm * closed)

    def vibration_mps(self, coupling: Coupling, noise_m: float) -> Samples:
        """Return RMS speed of the tool at each depth, (depths,), from white position noise."""
        proxy_per_tool, proxy_per_force, tool_npm, force_gain = _couple(coupling, self.dt_s, self.z)
        pressed_npm = self.object_npm
        if coupling.mode == "proxy":
            pressed_npm = pressed_npm * proxy_per_tool / (1.0 - proxy_per_force * pressed_npm)
        loop = self.compliance * (tool_npm + force_gain * pressed_npm)
        speed = loop / (1.0 + loop) * (self.z - 1.0) / self.dt_s
        return _rms_of_noise(speed, self.dt_s, noise_m)


def compute_loop_margin(
    tangent: ObjectTangent,
    coupling: Coupling,
    dt_s: float,
    device: LoopDevice,
    smoothing: float,
    hands: Sequence[tuple[Hand, int]] = CHECKED_HANDS,
) -> LoopMargin:
    """Return by what factor the object could be stiffer before the loop of any hand is unstable.

    The least over `hands`, each with its samples of extra delay; and the greatest vibration from
    the encoder's noise. smoothing: weight of the newest force, 1 for none.
    """
    noise_m, held = compute_noise_m(device), tangent.is_held
    margins: list[LoopMargin] = []
    for hand, extra_delay in hands:
        loop = LoopOnCircle.build(tangent, dt_s, device, smoothing, hand, extra_delay)
        gains, speeds_mps = loop.gain_margins(coupling), loop.vibration_mps(coupling, noise_m)
        pressed = float(gains[~held].min(initial=np.inf))
        margins.append(
            LoopMargin(
                float(gains[held].min()),
                pressed,
                float(speeds_mps[held].max()),
                hand,
                extra_delay,
                tangent.is_spring,
            )
        )
    worst = min(margins, key=lambda margin: margin.least)
    return LoopMargin(
        min(margin.gain_margin for margin in margins),
        min(margin.pressed_margin for margin in margins),
        max(margin.vibration_mps for margin in margins),
        worst.hand,
        worst.extra_delay,
        tangent.is_spring,
    )


def compute_noise_m(device: LoopDevice) -> float:
    """Return the RMS of an encoder's noise and rounding to its steps, m."""
    return 1e-6 * math.hypot(device.noise_um, device.resolution_um / math.sqrt(12.0))


def compute_held_noise_n(coupling: Coupling, dt_s: float, noise_m: float) -> float:
    """Return the RMS force of a coupling, N, whose tool and proxy are held, from position noise."""
    tool_npm = _couple(coupling, dt_s, np.exp(1j * _angles(dt_s)))[2]
    return float(_rms_of_noise(tool_npm[None], dt_s, noise_m)[0])


def _rms_of_noise(gain: Response, dt_s: float, noise_m: float) -> Samples:
    """RMS of white noise behind a gain (rows, angles): (rows,)."""
    fraction = np.gradient(_angles(dt_s)) / math.pi
    return np.asarray(noise_m * np.sqrt((np.abs(gain) ** 2 * fraction).sum(axis=1)))


@lru_cache(maxsize=16)
def _angles(dt_s: float) -> Samples:
    """Angles on the upper half circle, (n,), ascending to pi."""
    low = 2.0 * math.pi * _MIN_HZ * dt_s
    by_ratio = np.geomspace(low, math.pi, _N_LOG)[:-1]
    return np.asarray(np.unique(np.append(by_ratio, np.linspace(low, math.pi, _N_EVEN))))


def _compute_compliance(hand: Hand, device: LoopDevice, dt_s: float, z: Response) -> Response:
    """Position of the tool over a force that is held for a tick, m/N."""
    k, b, m = hand.stiffness_npm, hand.damping_nspm, hand.mass_kg
    phi = state_transition(k, b + device.viscous_nspm, m + device.mass_kg, dt_s)
    position, velocity = (1.0 - phi[0, 0]) / k, -phi[1, 0] / k
    poles = (z - phi[0, 0]) * (z - phi[1, 1]) - phi[0, 1] * phi[1, 0]
    return np.asarray(((z - phi[1, 1]) * position + phi[0, 1] * velocity) / poles)


def _couple(coupling: Coupling, dt_s: float, z: Response) -> tuple[Response, ...]:
    """Return the transfer functions of the virtual coupling (sp_couple.h) at each z.

    Proxy over tool; proxy over the model's force, m/N; force over tool, N/m; force over the model's
    force. Of "off": 0, 0, 0, 1.
    """
    if coupling.mode == "off":
        none = np.zeros_like(z)
        return none, none, none, none + 1.0
    k, b, m = coupling.stiffness_npm, coupling.damping_nspm, coupling.mass_kg
    phi = state_transition(k, b, m, dt_s)
    weight, back = dt_s / (dt_s + LOWPASS_TAU_S), 1.0 / z
    velocity = weight * (1.0 - back) / dt_s / (1.0 - (1.0 - weight) * back)
    poles = (z - phi[0, 0]) * (z - phi[1, 1]) - phi[0, 1] * phi[1, 0]

    def solve_proxy(position: Response, speed: Response) -> tuple[Response, Response]:
        return (
            ((z - phi[1, 1]) * position + phi[0, 1] * speed) / poles,
            (phi[1, 0] * position + (z - phi[0, 0]) * speed) / poles,
        )

    proxy_per_tool, speed_per_tool = solve_proxy(
        (1.0 - phi[0, 0]) + (dt_s - phi[0, 1]) * velocity,
        -phi[1, 0] + (1.0 - phi[1, 1]) * velocity,
    )
    one = np.ones_like(z)
    proxy_per_force, speed_per_force = solve_proxy(
        -one * (1.0 - phi[0, 0]) / k, one * phi[1, 0] / k
    )
    tool_npm = -k * (proxy_per_tool - 1.0) - b * (speed_per_tool - velocity)
    return proxy_per_tool, proxy_per_force, tool_npm, -k * proxy_per_force - b * speed_per_force


def _limit_gain(loop: Response) -> Samples:
    """Return the least gain at which 1 + gain x loop has a root on the circle, (rows,).

    There the loop, stable below, begins to swing. loop: (rows, angles).
    """
    real, imag = loop.real, loop.imag
    rise = imag[:, 1:] - imag[:, :-1]
    fraction = -imag[:, :-1] / np.where(rise == 0.0, 1.0, rise)
    crossing = real[:, :-1] + fraction * (real[:, 1:] - real[:, :-1])
    crosses = (imag[:, :-1] * imag[:, 1:] <= 0.0) & (crossing < 0.0)
    least = np.minimum(np.where(crosses, crossing, 0.0).min(axis=1), np.minimum(real[:, -1], 0.0))
    return np.asarray(np.where(least < 0.0, -1.0 / np.where(least < 0.0, least, -1.0), np.inf))
