"""Numpy reference of the emitted C: the same operations in the same order, bit for bit."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.configs import ForestTable, FracConfig, RangeConfig, VelocityConfig
from springpot.codegen.forest_table import LEAF_SLOT, SLOT_BITS
from springpot.codegen.plan import Plan
from springpot.codegen.reference_tick import HELD, OUTSIDE, RESYNC, Guarding, Tail

Reals = NDArray[Any]
Notes = NDArray[np.int32]
_CHUNK = 4096  # samples whose walk through the forest stays in the cache


@dataclass(frozen=True, eq=False)
class Run:
    """What the C returns for each tick: force_n, shape (n,), the scene's type; notes, (n,)."""

    force_n: Reals
    notes: Notes


def run_reference(plan: Plan, position_m: Reals, velocity_mps: Reals | None = None) -> Run:
    """Run the plan on positions (and device velocities) from a fresh state.

    position_m, velocity_mps: shape (n,), any float type; rounded to the scene's type first.
    """
    raw = np.asarray(position_m, dtype=plan.dtype)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        position, notes = Guarding(plan.guard).run(raw)
        held = (notes & HELD) != 0
        depth, outside = clip(plan.range, position)
        notes |= np.where(outside, OUTSIDE, 0).astype(np.int32)
        starts = np.flatnonzero(notes & RESYNC)
        contact = position > 0 if plan.contact else np.ones(len(position), dtype=bool)
        model_n = np.zeros(len(raw), dtype=plan.dtype)
        derivative = derivatives(plan.frac, depth, starts)
        model_n[contact] = forest_force(plan.forest, derivative[contact].astype(np.float32))
        velocity = _velocity(plan, position, starts, velocity_mps, notes)
        tail = Tail(plan)
        force_n = tail.run(position, velocity, model_n, contact, held, notes)
    return Run(force_n=force_n, notes=notes)


def clip(config: RangeConfig, position: Reals) -> tuple[Reals, NDArray[np.bool_]]:
    """sp_range.h: clipped depth, and where it was too deep."""
    outside = position > config.greatest_m
    clipped = np.where(outside, config.greatest_m, position)
    return np.where(clipped < config.least_m, config.least_m, clipped), outside


def derivatives(config: FracConfig, depth: Reals, starts: NDArray[np.intp]) -> Reals:
    """sp_window.h and sp_frac.h: shape (n, orders). History before a start is that sample held."""
    n_orders = len(config.orders)
    result = np.zeros((len(depth), n_orders), dtype=depth.dtype)
    bounds = [0, *starts.tolist(), len(depth)]
    for begin, end in pairwise(bounds):
        if begin == end:
            continue
        # Before the first believable sample the window holds zeros.
        before = depth[begin] if begin in starts else depth.dtype.type(0)
        padded = np.concatenate([np.full(len(config.taps) - 1, before), depth[begin:end]])
        padded = padded.astype(depth.dtype)
        for i in range(n_orders):
            total = np.zeros(end - begin, dtype=depth.dtype)
            for k, tap in enumerate(config.taps[:, i]):
                first = len(config.taps) - 1 - k
                total += tap * padded[first : first + end - begin]
            result[begin:end, i] = total
    return result


def forest_leaves(table: ForestTable, features: NDArray[np.float32]) -> NDArray[np.int64]:
    """Rows of the leaves reached: shape (n, padded trees)."""
    leaves = np.empty((len(features), len(table.roots)), dtype=np.int64)
    left = (table.link >> SLOT_BITS).astype(np.int64)
    slot = (table.link & LEAF_SLOT).astype(np.int64)
    inner = slot != LEAF_SLOT
    n_columns = features.shape[1]
    flat = np.ascontiguousarray(features).ravel()
    for tree, root in enumerate(table.roots):
        at = np.full(len(features), root, dtype=np.int64)
        walking = np.arange(len(features)) if inner[root] else np.empty(0, dtype=np.int64)
        while len(walking):
            here = at[walking]
            feature = flat[walking * n_columns + slot[here]]
            here = left[here] + ~(feature <= table.value[here])
            at[walking] = here
            walking = walking[inner[here]]
        leaves[:, tree] = at
    return leaves


def forest_force(table: ForestTable, features: NDArray[np.float32]) -> Reals:
    """sp_forest.h: force of each feature vector, N, in the scene's type."""
    force = np.empty(len(features), dtype=type(table.quantum_n))
    value = table.value.astype(np.int32)
    for begin in range(0, len(features), _CHUNK):
        rows = slice(begin, begin + _CHUNK)
        total = value[forest_leaves(table, features[rows])].sum(axis=1, dtype=np.int32)
        force[rows] = total.astype(force.dtype) * table.quantum_n
    return force


def foaw(config: VelocityConfig, position: Reals, starts: NDArray[np.intp]) -> Reals:
    """sp_velocity.h over sp_window.h: shape (n,), m/s."""
    length = len(config.per_step)
    index = np.arange(len(position))
    since = np.zeros(len(position), dtype=np.intp)
    since[starts] = starts
    since = np.maximum.accumulate(since)
    started = np.zeros(len(position), dtype=bool)
    if len(starts):
        started[starts[0] :] = True

    def past(j: int) -> Reals:
        at = index - j
        inside = np.where(at >= since, position[np.maximum(at, 0)], position[since])
        before = np.where(at >= 0, position[np.maximum(at, 0)], position.dtype.type(0))
        return np.where(started, inside, before).astype(position.dtype)

    slope = least = greatest = np.zeros(len(position), dtype=position.dtype)
    open_ = np.ones(len(position), dtype=bool)
    for j in range(length):
        rise = position - past(j + 1)
        candidate = rise * config.per_step[j]
        low = (rise - config.band_m) * config.per_step[j]
        high = (rise + config.band_m) * config.per_step[j]
        if j == 0:
            slope, least, greatest = candidate, low, high
            continue
        open_ &= (candidate >= least) & (candidate <= greatest)
        slope = np.where(open_, candidate, slope)
        least = np.where(open_ & (low > least), low, least)
        greatest = np.where(open_ & (high < greatest), high, greatest)
    return slope


def _velocity(
    plan: Plan,
    position: Reals,
    starts: NDArray[np.intp],
    velocity_mps: Reals | None,
    notes: Notes,
) -> Reals:
    if plan.velocity is not None:
        return foaw(plan.velocity, position, starts)
    velocity = np.zeros(len(position), dtype=plan.dtype)
    if plan.needs_device_velocity and velocity_mps is not None:
        velocity = np.asarray(velocity_mps, dtype=plan.dtype)
        good = np.abs(velocity) * plan.output.dt_s <= plan.guard.jump_m
        notes |= np.where(good, 0, HELD).astype(np.int32)
        velocity = np.where(good, velocity, plan.dtype(0))
    return velocity
