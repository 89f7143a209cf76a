"""Numpy reference of the emitted C: the same operations in the same order, bit for bit."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.configs import RangeConfig
from springpot.codegen.plan import Plan
from springpot.codegen.reference_tick import HELD, OUTSIDE, RESYNC, Guarding, Tail
from springpot.codegen.stages.stage import Starts

Reals = NDArray[Any]
Notes = NDArray[np.int32]


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
        model_n = model_force(plan, depth, starts, contact)
        velocity = _velocity(plan, position, starts, velocity_mps, notes)
        force_n = Tail(plan).run(position, velocity, model_n, contact, held, notes)
    return Run(force_n=force_n, notes=notes)


def model_force(plan: Plan, depth: Reals, starts: Starts, contact: NDArray[np.bool_]) -> Reals:
    """Force of the model's stages, N; 0 where there is no contact."""
    force_n = np.zeros(len(depth), dtype=plan.dtype)
    if plan.features is not None and plan.regressor is not None:
        features = plan.features.reference(depth, starts)
        force_n[contact] = plan.regressor.reference(features[contact])
    if plan.passive is not None:
        passive_n = plan.passive.reference(depth, starts)
        force_n = passive_n if plan.regressor is None else passive_n + force_n
    return np.where(contact, force_n, plan.dtype(0))


def clip(config: RangeConfig, position: Reals) -> tuple[Reals, NDArray[np.bool_]]:
    """sp_range.h: clipped depth, and where it was too deep."""
    outside = position > config.greatest_m
    clipped = np.where(outside, config.greatest_m, position)
    return np.where(clipped < config.least_m, config.least_m, clipped), outside


def _velocity(
    plan: Plan, position: Reals, starts: Starts, velocity_mps: Reals | None, notes: Notes
) -> Reals:
    if plan.velocity is not None:
        return plan.velocity.reference(position, starts)
    velocity = np.zeros(len(position), dtype=plan.dtype)
    if plan.needs_device_velocity and velocity_mps is not None:
        velocity = np.asarray(velocity_mps, dtype=plan.dtype)
        good = np.abs(velocity) * plan.output.dt_s <= plan.guard.jump_m
        notes |= np.where(good, 0, HELD).astype(np.int32)
        velocity = np.where(good, velocity, plan.dtype(0))
    return velocity
