"""Numpy reference of the emitted C: the same operations in the same order, bit for bit."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.proxy import ContactTrace, proxy_motion
from springpot.codegen.reference.tick import HELD, OUTSIDE, RESYNC, Guarding, Notes, OutputStage
from springpot.codegen.stages.model_force import clip, model_force
from springpot.codegen.stages.stage import Starts


@dataclass(frozen=True, eq=False)
class Run:
    """What the C returns for each tick: force_n, shape (n,), the scene's type; notes, (n,)."""

    force_n: Reals
    notes: Notes


def run_reference(
    plan: Plan,
    position_m: Reals,
    velocity_mps: Reals | None = None,
    predicted_m: Reals | None = None,
) -> Run:
    """Run the plan on positions (and device velocities) from a fresh state.

    position_m, velocity_mps: shape (n,), any float type; rounded to the scene's type first.
    predicted_m: (n,), where the C's proxy was; it decides how long this takes, never the result.
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
        if plan.velocity is not None:
            velocity = plan.velocity.reference(position, starts)
        pressed = position
        if plan.at_proxy:

            def at_proxy(motion: Reals, begun: Starts, asked: NDArray[np.bool_]) -> Reals:
                return model_force(plan, _depths(plan, motion)[0], begun, asked)

            trace = ContactTrace(position, velocity, contact, starts)
            pressed = proxy_motion(plan, trace, at_proxy, predicted_m)
        motion, outside = _depths(plan, pressed)
        notes |= np.where(outside, OUTSIDE, 0).astype(np.int32)
        model_n = model_force(plan, motion, starts, contact)
        output = OutputStage(plan)
        force_n = output.run(position, velocity, pressed, model_n, contact, held, notes)
    return Run(force_n=force_n, notes=notes)


def _depths(plan: Plan, pressed: Reals) -> tuple[dict[str, Reals], NDArray[np.bool_]]:
    """`penetration` and `clipped` of sp_step, each (n,), m, and where the depth was clipped."""
    minimum = plan.dtype(0) if plan.contact else plan.range.min_m
    penetration = np.where(pressed > minimum, pressed, minimum)
    clipped, outside = clip(plan.range, penetration if plan.contact else pressed)
    return {"penetration": penetration, "clipped": clipped}, outside


def _device_velocity(
    plan: Plan, velocity_mps: Reals | None, length: int
) -> tuple[Reals, NDArray[np.bool_]]:
    """sp_guard_velocity.h: believable velocities, (n,), m/s, and where the last one is held."""
    if not plan.needs_device_velocity or velocity_mps is None:
        return np.zeros(length, dtype=plan.dtype), np.zeros(length, dtype=bool)
    velocity = np.asarray(velocity_mps, dtype=plan.dtype)
    good = np.abs(velocity) <= plan.max_mps
    last = np.maximum.accumulate(np.where(good, np.arange(length), -1))
    kept = np.where(last >= 0, velocity[last], plan.dtype(0))
    return kept.astype(plan.dtype), ~good
