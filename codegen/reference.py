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
        velocity, bad = _device_velocity(plan, velocity_mps, len(raw))
        notes |= np.where(bad, HELD, 0).astype(np.int32)
        held = (notes & HELD) != 0
        starts = np.flatnonzero(notes & RESYNC)
        started = np.arange(len(raw)) >= (starts[0] if len(starts) else len(raw))
        contact = position > 0 if plan.contact else started
        least = plan.dtype(0) if plan.contact else plan.range.least_m
        deep = np.where(position > least, position, least)
        depth, outside = clip(plan.range, deep if plan.contact else position)
        notes |= np.where(outside, OUTSIDE, 0).astype(np.int32)
        model_n = model_force(plan, {"deep": deep, "depth": depth}, starts, contact)
        if plan.velocity is not None:
            velocity = plan.velocity.reference(position, starts)
        force_n = Tail(plan).run(position, velocity, model_n, contact, held, notes)
    return Run(force_n=force_n, notes=notes)


def model_force(
    plan: Plan, motion: dict[str, Reals], starts: Starts, contact: NDArray[np.bool_]
) -> Reals:
    """Force of the model's stages, N; 0 where there is no contact. motion: "deep" and "depth"."""
    terms: list[Reals] = []
    if plan.passive is not None:
        terms.append(plan.passive.reference(motion[plan.passive.follows], starts))
    if plan.features is not None and plan.regressor is not None:
        model_n = np.zeros(len(contact), dtype=plan.dtype)
        features = plan.features.reference(motion["depth"], starts)
        model_n[contact] = plan.regressor.reference(features[contact])
        terms.append(model_n)
    if plan.excess is not None:
        deep, trained = (stage.reference(motion[stage.follows], starts) for stage in plan.excess)
        terms.append(deep - trained)
    force_n = terms[0]
    for term in terms[1:]:
        force_n = force_n + term
    return np.where(contact, force_n, plan.dtype(0))


def clip(config: RangeConfig, depth: Reals) -> tuple[Reals, NDArray[np.bool_]]:
    """sp_range.h: clipped depth, and where it was outside."""
    deep, shallow = depth > config.greatest_m, depth < config.least_m
    clipped = np.where(deep, config.greatest_m, np.where(shallow, config.least_m, depth))
    return clipped.astype(depth.dtype), deep | shallow


def _device_velocity(
    plan: Plan, velocity_mps: Reals | None, length: int
) -> tuple[Reals, NDArray[np.bool_]]:
    """sp_guard_velocity.h: believable velocities, and where the last good one served."""
    if not plan.needs_device_velocity or velocity_mps is None:
        return np.zeros(length, dtype=plan.dtype), np.zeros(length, dtype=bool)
    velocity = np.asarray(velocity_mps, dtype=plan.dtype)
    good = np.abs(velocity) <= plan.greatest_mps
    last = np.maximum.accumulate(np.where(good, np.arange(length), -1))
    kept = np.where(last >= 0, velocity[last], plan.dtype(0))
    return kept.astype(plan.dtype), ~good
