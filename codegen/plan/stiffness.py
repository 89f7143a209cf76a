"""Tangents of a model, from its reference: the maximum one, and that at the trained border."""

import numpy as np

from springpot.codegen.model.model import Model
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.stages.model_force import RangeConfig, Stages, clip, model_force
from springpot.codegen.stages.stage import SceneTicks

STEP = 0.05  # of the trained depth: longer than a leaf of a forest, shorter than a press
RANGE_FACTOR = 1.3  # of the trained depth: the fallback counts too
_SPEEDS = (1.0, 0.25, 0.0625)  # of the maximum trained one
_MAX_TICKS = 200


def max_stiffness_npm(
    stages: Stages, model: Model, trained: RangeConfig, ticks: SceneTicks
) -> float:
    """Maximum secant over 5 % of the depth, pressed from rest at any depth, N/m."""
    base_m = float(trained.min_m)
    span_m = float(trained.max_m) - base_m
    starts_m = base_m + span_m * np.arange(0.0, RANGE_FACTOR, STEP)
    found = 0.0
    for share in _SPEEDS:
        count = 1 + max(1, round(STEP * span_m / (share * model.trained.max_mps * ticks.dt_s)))
        count = min(count, _MAX_TICKS)
        rise_m = STEP * span_m * np.linspace(0.0, 1.0, count)
        motion = (starts_m[:, None] + rise_m).astype(ticks.dtype)
        penetration = motion.ravel()
        motions = {"penetration": penetration, "clipped": clip(trained, penetration)[0]}
        starts = np.arange(0, len(penetration), count)
        force_n = model_force(stages, motions, starts, np.ones(len(penetration), dtype=bool))
        force_n = force_n.reshape(motion.shape).astype(np.float64)
        found = max(found, float((force_n[:, -1] - force_n[:, 0]).max()) / (STEP * span_m))
    return found


def tangent_fallback(stages: Stages, model: Model, ticks: SceneTicks) -> Hammerstein:
    """Kelvin-Voigt tangent at the maximum trained depth, for a model without a passive part.

    Spring: the secant over the last tenth, pressed at a sixteenth of the trained speed. Damper:
    what a press at the trained speed adds; as a Maxwell branch that relaxes within five ticks. Both
    act on the depth beyond the border only, and neither is negative.
    """
    trained = model.trained
    end_m = trained.max_m
    step_m = 0.1 * (end_m - max(trained.min_m, 0.0))
    slow_mps, fast_mps = trained.max_mps / 16.0, trained.max_mps
    slow_n, fast_n = (
        _rise_n(stages, end_m - step_m, step_m, speed, ticks) for speed in (slow_mps, fast_mps)
    )
    spring_npm = max(slow_n / step_m, 0.0)
    damper_nspm = max((fast_n - slow_n) / (fast_mps - slow_mps), 0.0)
    tau_s = 5.0 * ticks.dt_s
    return Hammerstein(
        origin_m=end_m,
        span_m=step_m,
        elastic_n=np.array([spring_npm * step_m]),
        tau_s=np.array([tau_s]),
        branch_n=np.array([[damper_nspm / tau_s * step_m]]),
        radius_m=np.zeros(0),
        stop_n=np.zeros((0, 1)),
        bias_n=0.0,
    )


def _rise_n(stages: Stages, from_m: float, step_m: float, speed: float, ticks: SceneTicks) -> float:
    """Force gained on a straight press from rest, N."""
    count = 1 + min(_MAX_TICKS, max(1, round(step_m / (speed * ticks.dt_s))))
    motion = (from_m + step_m * np.linspace(0.0, 1.0, count)).astype(ticks.dtype)
    motions = {"penetration": motion, "clipped": motion}
    force_n = model_force(stages, motions, np.array([0]), np.ones(count, dtype=bool))
    return float(force_n[-1]) - float(force_n[0])
