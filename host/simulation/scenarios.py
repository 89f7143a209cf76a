"""What a hand wants to do in the closed loop: motions, and the intentions that carry them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Reals, Samples
from springpot.codegen.coupling.linear_loop import Hand
from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.messages import short_repr
from springpot.codegen.plan import Plan
from springpot.host.simulation.hand_loop import Scenario

_FREE_M = 0.002  # start in free air, this far from the surface
RISE_S, SETTLE_S = 0.4, 0.5
PUSH_OF_CLAMP = 11.5 / 12.0
_STICKING_MPS = 1e-3  # slower, a hand does not push against all of the friction
_STRIKE_SPEED_FACTOR = 4.0  # than the maximum trained speed

Motion = Callable[[Samples], Samples]
Force = Callable[[Samples], Samples]


@dataclass(frozen=True, eq=False)
class Case:
    """One case of the closed loop.

    hold_ticks: over which vibration is measured, if not all. must_be_quiet: the hand holds still
    then, so that vibration is a fault. on_stiffer_object: of the object made stiffer, which the
    coupling softens on purpose. must_latch: too few samples come. faster_than_trained: lost
    samples may be felt.
    """

    name: str
    scenario: Scenario
    hold_ticks: tuple[slice, ...] = ()
    must_be_quiet: bool = False
    on_stiffer_object: bool = False
    must_latch: bool = False
    faster_than_trained: bool = False


@dataclass(frozen=True)
class Workspace:
    """Space of a case: surface and trained depth of the scene, clock, clamp, and the device."""

    free_m: float
    base_m: float
    span_m: float
    dt_s: float
    max_mps: float
    max_n: float
    device: LoopDevice
    __repr__ = short_repr

    @staticmethod
    def of(plan: Plan) -> "Workspace":
        """Return the workspace of a plan."""
        base_m = 0.0 if plan.contact else float(plan.range.min_m)
        span_m = float(plan.range.max_m) - base_m
        free_m = -min(_FREE_M, 0.2 * span_m) if plan.contact else base_m + 0.05 * span_m
        return Workspace(free_m, base_m, span_m, plan.dt_s, plan.model.trained.max_mps,
                     float(plan.output.max_n), plan.loop_device)  # fmt: skip

    def at(self, share: float) -> float:
        """Depth at a share of the trained one, m."""
        return self.base_m + share * self.span_m


def hold_motion(space: Workspace, shares: tuple[float, ...], hold_s: float) -> tuple[Motion, float]:
    """Rise to each depth and hold it; and how long that takes, s."""
    stations = [space.free_m, *(space.at(share) for share in shares)]
    period_s = RISE_S + hold_s

    def motion(t: Samples) -> Samples:
        step = np.minimum((t / period_s).astype(int), len(shares) - 1)
        rise = minimum_jerk_rise((t - step * period_s) / RISE_S)
        levels = np.array(stations)
        return np.asarray(levels[step] + (levels[step + 1] - levels[step]) * rise)

    return motion, period_s * len(shares)


def settled_hold_ticks(space: Workspace, shares: int, hold_s: float) -> tuple[slice, ...]:
    """Return ticks of each hold, once it has settled."""
    period_s = RISE_S + hold_s
    edges = [
        (i * period_s + RISE_S + min(SETTLE_S, hold_s / 3.0), (i + 1) * period_s)
        for i in range(shares)
    ]
    return tuple(slice(round(a / space.dt_s), round(b / space.dt_s)) for a, b in edges)


def tap_motion(space: Workspace, frequency_hz: float, share: float) -> Motion:
    """In and out, from free air."""
    top_m = space.at(share)
    return lambda t: (
        space.free_m + (top_m - space.free_m) * 0.5 * (1.0 - np.cos(2.0 * np.pi * frequency_hz * t))
    )


def strike_motion(space: Workspace) -> Motion:
    """Strokes to 80 % at four times the trained speed, each held and left again."""
    height_m = space.at(0.8) - space.free_m
    stroke_s = 1.875 * height_m / (_STRIKE_SPEED_FACTOR * space.max_mps)
    stroke_s = max(stroke_s, 4.0 * space.dt_s)

    def motion(t: Samples) -> Samples:
        phase = t % 1.0
        return space.free_m + height_m * (
            minimum_jerk_rise((phase - 0.2) / stroke_s)
            - minimum_jerk_rise((phase - 0.6) / stroke_s)
        )

    return motion


def minimum_jerk_rise(share: Reals) -> Samples:
    """Minimum-jerk rise from 0 to 1."""
    u = np.clip(share, 0.0, 1.0)
    return np.asarray(u**3 * (10.0 - 15.0 * u + 6.0 * u * u))


def press_scenario(
    space: Workspace, motion: Motion, force: Force, hand: Hand, seconds: float, jitter: float = 0.0
) -> Scenario:
    """A hand that knows object and device: its intention carries the tool along `motion`.

    intention = x + (f + B v + C sign(v) + M a)/k, with the force f of the scene on that motion
    and the device's Coulomb friction C.
    """
    n = round(seconds / space.dt_s)
    rng = np.random.default_rng(1)
    dt_s = space.dt_s * (1.0 + jitter * rng.uniform(-1.0, 1.0, n))
    end_s = np.cumsum(dt_s)
    before, x, after = motion(end_s - space.dt_s), motion(end_s), motion(end_s + space.dt_s)
    v = (after - before) / (2.0 * space.dt_s)
    a = (after - 2.0 * x + before) / space.dt_s**2
    mass_kg = hand.mass_kg + space.device.mass_kg
    damping_nspm = hand.damping_nspm + space.device.viscous_nspm
    needed_n = force(x) + damping_nspm * v + mass_kg * a
    if space.device.coulomb_n > 0.0:
        needed_n += space.device.coulomb_n * np.tanh(v / _STICKING_MPS)
    return _scenario_without_faults(dt_s, x + needed_n / hand.stiffness_npm, np.full(n, np.nan))


def push_scenario(space: Workspace) -> Scenario:
    """A push that rises in half a second and stays for two, in place of the hand's spring."""
    n = round(2.5 / space.dt_s)
    t = np.arange(1, n + 1) * space.dt_s
    push_n = PUSH_OF_CLAMP * space.max_n * minimum_jerk_rise(t / 0.5)
    return _scenario_without_faults(np.full(n, space.dt_s), np.zeros(n), push_n)


def _scenario_without_faults(dt_s: Samples, intended_m: Samples, push_n: Samples) -> Scenario:
    n = len(dt_s)
    return Scenario(dt_s, intended_m, push_n, np.zeros(n), np.zeros(n, dtype=np.uint8))
