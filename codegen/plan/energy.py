"""Constants of the account of energy: what the object can store at each depth, at most."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Real, Reals
from springpot.codegen.plan.limits import OutputConfig
from springpot.codegen.scene import Coupling
from springpot.codegen.stages.model_force import RangeConfig, Stages, model_force
from springpot.codegen.stages.stage import SceneTicks

STATE_REALS = 9  # sp_energy_state; emitted C asserts the size of a state
_POINTS = 128  # of the trained depth, in the integral
# An encoder at rest goes to and fro by one step: a spring in ticks would lose K dx^2/2 each time.
ENCODER_STEPS = 1.5
LOOK_S = 0.004  # between two looks at how the tool moves
TURN_S = 0.05  # how long a hand is taken to turn as fast as it did


@dataclass(frozen=True)
class EnergyConfig:
    """sp_energy_config of sp_energy.h, member by member."""

    slack_m: Real
    from_m: Real
    most_j: Real
    push_n: Real
    stiffness_npm: Real
    look_ticks: Real
    keep: Real


@dataclass(frozen=True)
class StorageBounds:
    """Hold what bounds the stored energy beside the model's stages."""

    trained: RangeConfig
    output: OutputConfig
    coupling: Coupling


def energy_config(
    stages: Stages, bounds: StorageBounds, resolution_m: float, ticks: SceneTicks
) -> EnergyConfig:
    """The account over the trained depth: a parabola above the energy of every press.

    Its slope beyond the trained depth is the maximum force at least.
    """
    dt_s, real = ticks.dt_s, ticks.dtype
    from_m, to_m = float(bounds.trained.min_m), float(bounds.trained.max_m)
    span_m, max_n = to_m - from_m, _max_force_n(bounds.output)
    way_m = span_m * np.arange(1, _POINTS + 1) / _POINTS
    force_n = _most_force_n(stages, bounds, from_m + way_m, ticks)
    work_j = np.cumsum(np.diff(way_m, prepend=0.0) * force_n)  # from above: the force never falls
    push_n = float(force_n[0]) + (0.0 if bounds.coupling.mode == "off" else 0.5 * max_n)
    rest_npm = float(np.max((work_j - push_n * way_m) / way_m**2))
    return EnergyConfig(
        slack_m=real(ENCODER_STEPS * resolution_m),
        from_m=real(from_m),
        # Without a surface it is not known what was stored above the lowest position.
        most_j=real(0.0 if ticks.surface else max_n * span_m),
        push_n=real(push_n),
        stiffness_npm=real(max(rest_npm, (max_n - push_n) / (2.0 * span_m), 0.0)),
        look_ticks=real(LOOK_S / dt_s),
        keep=real(np.exp(-max(LOOK_S, dt_s) / TURN_S)),
    )


def _most_force_n(
    stages: Stages, bounds: StorageBounds, depths_m: Reals, ticks: SceneTicks
) -> Reals:
    """Force at each depth, (n,), N, that no motion passes: pressed there in one tick from rest.

    That is the sum of a passive model's curves; what a regressor gives is bounded by the clamp. A
    coupling's spring k stores F^2/(2 k) <= F x/2 besides, F its force.
    """
    most_n = np.full(len(depths_m), _max_force_n(bounds.output))
    if stages.regressor is not None or not ticks.surface:
        return most_n
    motion = np.stack([np.zeros_like(depths_m), depths_m], axis=1).astype(ticks.dtype).ravel()
    starts = np.arange(0, len(motion), 2)
    motions = {"penetration": motion, "clipped": motion}
    pressed_n = model_force(stages, motions, starts, np.ones(len(motion), dtype=bool))[1::2]
    rising_n = np.maximum.accumulate(np.clip(pressed_n.astype(np.float64), 0.0, None))
    bounded_n: Reals = np.minimum(rising_n, most_n)
    return bounded_n


def _max_force_n(output: OutputConfig) -> float:
    return max(float(output.max_n), -float(output.min_n))
