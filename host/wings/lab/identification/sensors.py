"""What the device's sensors give: the step of its position, the noise of its velocity."""

import numpy as np

from springpot.basics import Samples
from springpot.host.wings.lab.identification.fit import Matrix, MotionFit
from springpot.host.wings.lab.identification.free_motion import FreeMotion
from springpot.host.wings.lab.identification.result import Identified

_MIN_LEVELS = 20  # of positions, to tell a step
_GRID_ERROR = 0.1  # of the step: positions lie no farther from its multiples
_STUDENT_SEGMENTS = 2.1


def position_step(position_m: Samples) -> Identified:
    """The smallest step of positions (n,), where they are multiples of one."""
    levels_m = np.unique(position_m)
    gaps_m = np.diff(levels_m)
    gaps_m = gaps_m[gaps_m > 1e-6 * np.ptp(levels_m) / len(levels_m)]
    if len(gaps_m) < _MIN_LEVELS:
        return Identified(why=f"{len(gaps_m) + 1} positions were seen: too few to tell their step")
    step_m = float(np.median(gaps_m[gaps_m < 1.5 * np.quantile(gaps_m, 0.05)]))
    for _ in range(3):
        counts = np.round(gaps_m / step_m)
        step_m = float(np.sum(counts * gaps_m) / np.sum(counts**2))
    error = np.sqrt(np.mean((gaps_m / step_m - np.round(gaps_m / step_m)) ** 2))
    if error > _GRID_ERROR:
        max_step_m = float(np.median(gaps_m))
        why = f"positions are multiples of no step: it is below {1e6 * max_step_m:.2g} um"
        return Identified(None, 0.0, max_step_m, why)
    half_width_m = 2 * float(error) * step_m / np.sqrt(len(gaps_m)) + 1e-6 * step_m
    return Identified(step_m, step_m - half_width_m, step_m + half_width_m)


def velocity_noise(motion: FreeMotion, fit: MotionFit) -> Identified:
    """Standard deviation of the device's velocity about the fitted one, less a lag of its own."""
    ticks = fit.residual_m.shape[1]
    places = fit.begins[:, None] + np.arange(ticks)
    seen_mps = motion.velocity_mps[places]
    if not np.isfinite(seen_mps).all() or not np.any(seen_mps):
        return Identified(why="the device gives no velocity")
    rest_mps = _without_lag(seen_mps, fit.velocity_mps, motion.dt_s)
    by_segment = np.mean(rest_mps**2, axis=1)
    variance = float(np.mean(by_segment))
    spread = _STUDENT_SEGMENTS * float(np.std(by_segment)) / np.sqrt(len(by_segment))
    value = np.sqrt(variance)
    if spread > 0.36 * variance:  # of the variance: twice as much as of its root, and some
        why = "it depends on the motion: a filter of the device's own, or friction, shows in it"
        return Identified(None, 0.0, float(np.sqrt(variance + spread)), why)
    low, high = np.sqrt(variance - spread), np.sqrt(variance + spread)
    return Identified(float(value), float(low), float(high))


def _without_lag(seen_mps: Matrix, true_mps: Matrix, dt_s: float) -> Matrix:
    """Less what a scale and a lag of up to the second order explain."""
    slope = np.gradient(true_mps, dt_s, axis=1)
    bend = np.gradient(slope, dt_s, axis=1)
    table = np.stack([true_mps.ravel(), slope.ravel(), bend.ravel()], axis=1)
    found, *_ = np.linalg.lstsq(table, seen_mps.ravel(), rcond=None)
    rest: Matrix = seen_mps - (table @ found).reshape(seen_mps.shape)
    return rest
