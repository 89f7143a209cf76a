"""How far the force in float32 may be from the one in float64, computed before anything is run.

Half a unit in the last place, `U`, is added for each operation and each constant, as textbooks of
error analysis do (Higham, Accuracy and Stability, chapter 3), to first order in U, and carried to
the force by the slopes of what follows. What is not continuous has ties: inputs so near to a
tree's threshold, or to the noise band of a velocity's window, that the two numbers may decide
otherwise. There no distance is promised; the motion alone says which ticks they are.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.plan.plan import Plan
from springpot.codegen.stages.fir import SUMS, FirStage
from springpot.codegen.stages.forest import CompactForestStage
from springpot.codegen.stages.lags import LagsStage
from springpot.codegen.stages.passive.hammerstein import HammersteinStage
from springpot.codegen.stages.position_velocity import PositionVelocityStage
from springpot.codegen.stages.rbf import RBF_VECTOR_WIDTH, RbfStage

U = 2.0**-24
_PAST = 1024  # samples that no feature of these models looks beyond


@dataclass(frozen=True)
class MotionRange:
    """max_m: the deepest position, within the trained ones. max_step_m: in a tick, at most."""

    max_m: float
    max_step_m: float


class ForceRounding:
    """Of a plan in float64 with contact at the surface, without coupling and smoothing."""

    def __init__(self, plan: Plan, motion: MotionRange) -> None:
        assert plan.real == "double" and plan.couple is None and plan.smooth_alpha is None
        assert motion.max_m <= plan.range.max_m
        self._plan, self._motion = plan, motion
        self._features = _feature_errors(plan, motion)
        self._before = np.zeros(0)

    @property
    def bound_n(self) -> float:
        """Largest distance of the two forces at a tick without a tie, N."""
        plan = self._plan
        found = 0.0
        if plan.passive is not None:
            found += _passive_error(plan.passive, self._motion)
        if isinstance(plan.regressor, CompactForestStage):
            forest = plan.regressor.forest
            whole_n = forest.leaf_step_n * np.iinfo(np.uint16).max * forest.n_trees
            found += 3 * U * (abs(forest.bias_n) + whole_n)  # sums of leaves are exact
        if isinstance(plan.regressor, RbfStage):
            found += _rbf_error(plan.regressor, self._features)
        return found + 4 * U * plan.max_force_n  # onset

    def ties(self, position_m: Samples) -> NDArray[np.bool_]:
        """Ticks, (n,), at which the two may decide otherwise; call it on each part in turn."""
        plan, features = self._plan, self._plan.features
        first = not len(self._before)
        whole = np.concatenate([self._before, position_m])
        self._before = whole[-_PAST:]
        depth = np.clip(whole, plan.range.min_m, plan.range.max_m)
        tied = np.zeros(len(depth), dtype=bool)
        if isinstance(features, PositionVelocityStage):
            # What a window's decision compares: two slopes and the band, rounded thrice each.
            window_m = self._motion.max_step_m * len(features.per_step)
            margin_m = 3 * U * (2 * window_m + float(features.band_m)) + 2 * U * abs(
                float(plan.range.min_m)
            )
            narrow, wide = (
                replace(features, band_m=features.band_m + sign * margin_m) for sign in (-1, 1)
            )
            rested = np.zeros(1, dtype=np.intp)
            tied = narrow.reference(depth, rested)[:, 1] != wide.reference(depth, rested)[:, 1]
        elif isinstance(plan.regressor, CompactForestStage) and features is not None:
            starts = np.zeros(1, dtype=np.intp)
            values = features.reference(depth, starts)
            for i, thresholds in enumerate(plan.regressor.forest.thresholds):
                margin = self._features[i]
                low, high = (
                    np.searchsorted(thresholds, values[:, i] + s) for s in (-margin, margin)
                )
                tied |= low != high
        return tied if first else tied[len(tied) - len(position_m) :]


def _feature_errors(plan: Plan, motion: MotionRange) -> Samples:
    """Of each feature, in its unit; positions are clipped to the smallest trained one, rounded."""
    stage, clipped_m = plan.features, U * abs(float(plan.range.min_m))
    if stage is None:
        return np.zeros(0)
    if isinstance(stage, LagsStage):
        return np.full(stage.n_features, 2 * clipped_m + 2 * U * motion.max_m)
    if isinstance(stage, PositionVelocityStage):
        per_s = stage.per_step[0]
        return np.array([clipped_m, (3 * U * motion.max_step_m + 2 * clipped_m) * per_s])
    assert isinstance(stage, FirStage)
    # A tap, its product, the sums of every sixteenth, the four that join them, and the comparison.
    position_m = clipped_m + (2 + stage.taps.shape[1] / SUMS + 4 + 1) * U * motion.max_m
    return np.asarray(position_m * np.abs(stage.taps).sum(axis=1))


def _passive_error(stage: HammersteinStage, motion: MotionRange) -> float:
    """N. Its curves carry the rounding of the depth; its branches add to it at each tick."""
    config = stage.config
    assert stage.flow is None and stage.damage is None and stage.surface is None
    assert not any(step.by_depth for step in stage.steps)
    share = 5 * U * (1.0 + abs(config.origin_m) * config.per_span)  # of u
    step = config.per_span * motion.max_step_m
    errors, sizes = [], []
    spring, slope, size = _curves(stage.spring[:, :, None], config.n_pieces)
    errors.append(spring(share)[0])
    sizes.append(size[0] + abs(config.bias_n))
    for stop in stage.stops:
        of_curve, _, size = _curves(stop[:, :, None], config.n_pieces)
        errors.append(of_curve(3 * share)[0])
        sizes.append(size[0])
    of_curve, slope, size = _curves(stage.branches, config.n_pieces)
    for branches in stage.steps:
        its = slice(branches.first, branches.first + branches.count)
        loss = np.asarray(branches.loss, dtype=np.float64)
        rise_n = slope[its] * step
        held_n = np.minimum(size[its], rise_n / loss)
        in_float = 0.0 if branches.double else held_n / loss + 3 * held_n + rise_n / loss
        errors += list(2 * of_curve(share)[its] + U * (rise_n / loss + held_n + in_float))
        sizes += list(held_n)
    sums = len(sizes) / 4 + 4 + len(stage.stops)
    return float(np.sum(errors) + sums * U * np.sum(sizes))


def _curves(nodes: Any, n_pieces: int) -> tuple[Callable[[float], Samples], Samples, Samples]:
    """Of curves (J + 1, 2, curves): error by that of u; largest slope, for u from 0 to 1; size."""
    values, slopes = np.moveaxis(np.abs(np.asarray(nodes, dtype=np.float64)), 1, 0)
    pieces, steepest = max(n_pieces - 1, 1), slopes.max(axis=0)
    size = values.max(axis=0) + steepest
    slope = pieces * steepest
    # The way in a piece carries the error of u, and its own; then eight operations.
    return lambda of_u: slope * (of_u + 3 * U) + 8 * U * size, slope, size


def _rbf_error(stage: RbfStage, features: Samples) -> float:
    """N. Sums of powers of distances are convex: they are largest at a corner of the ranges."""
    lowest, highest, mean, per_scale = np.asarray(stage.standard, dtype=np.float64).T
    ends = (np.stack([lowest, highest]) - mean) * per_scale
    scaled = np.maximum(np.abs(lowest), np.abs(highest)) + np.abs(mean)
    z_error = per_scale * (features + 3 * U * scaled) + 2 * U * np.abs(ends).max(axis=0)
    weights = np.abs(np.asarray(stage.weights_n, dtype=np.float64))
    centers = np.asarray(stage.centers, dtype=np.float64)
    sums = len(weights) / RBF_VECTOR_WIDTH + 3 + 8
    radial = 0.0
    for corner in ((ends[i, 0], ends[j, 1]) for i in (0, 1) for j in (0, 1)):
        distance = np.linalg.norm(np.array(corner)[:, None] - centers, axis=0)
        error = z_error.max() + 2 * U * (distance + np.abs(centers).max(axis=0))
        of_center = 3 * distance**2 * np.sqrt(2.0) * error + sums * U * distance**3
        radial = max(radial, float(weights @ of_center))
    tail = np.abs(np.asarray(stage.tail_n, dtype=np.float64))
    linear = tail[1:] @ z_error + 5 * U * (tail[0] + tail[1:] @ np.abs(ends).max(axis=0))
    return radial + float(linear)
