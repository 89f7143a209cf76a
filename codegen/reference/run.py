"""Numpy reference of the emitted C: the same operations in the same order, bit for bit."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.followed import Followed, at_rows, followed
from springpot.codegen.reference.guarding import guarded
from springpot.codegen.reference.notes import OUTSIDE, RESYNC, Notes
from springpot.codegen.reference.proxy import ContactTrace, proxy_motion
from springpot.codegen.reference.tick import OutputStage
from springpot.codegen.stages.model_force import clip, model_force
from springpot.codegen.stages.passive.placed import Taken
from springpot.codegen.stages.stage import Starts


@dataclass(frozen=True, eq=False)
class Run:
    """Returns of the C for each tick: force_n, shape (n,), the scene's type; notes, (n,)."""

    force_n: Reals
    notes: Notes


def run_reference(
    plan: Plan,
    position_m: Reals,
    velocity_mps: Reals | None = None,
    predicted_m: Reals | None = None,
    places: Taken = (),
) -> Run:
    """Run the plan on positions (and device velocities) from a fresh state.

    position_m, velocity_mps: shape (n,), any float type; rounded to the scene's type first.
    predicted_m: (n,), where the C's proxy was; it decides how long this takes, never the result.
    places: before which tick sp_place was called, and with what, m.
    """
    raw = np.asarray(position_m, dtype=plan.dtype)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        device, believed = _device_velocity(plan, velocity_mps, len(raw))
        samples = guarded(plan, raw, believed)
        motion = followed(plan, samples, device)
        starts = motion.starts
        contact = motion.position > 0 if plan.contact else np.ones(len(motion.position), dtype=bool)
        pressed = motion.position
        taken = _taken(plan, motion, contact, places)
        if plan.at_proxy:

            def at_proxy(
                first: int, proxy: Reals, begun: Starts, asked: NDArray[np.bool_]
            ) -> Reals:
                since = [(max(row - first, 0), place_m) for row, place_m in taken]
                return model_force(plan, _depths(plan, proxy)[0], begun, asked, since)

            predicted = predicted_m
            if predicted_m is not None:
                predicted = at_rows(predicted_m, motion.row, motion.missed)
            pressed = proxy_motion(plan, ContactTrace(motion, contact), at_proxy, predicted)
        depths, outside = _depths(plan, pressed)
        heard = motion.row >= 0
        notes = np.where(samples.resync, RESYNC, 0).astype(np.int32)
        notes[heard] |= np.where(outside[motion.row[heard]], OUTSIDE, 0).astype(np.int32)
        model_n = model_force(plan, depths, starts, contact, taken)
        output = OutputStage(plan)
        force_n = output.run(samples, motion, pressed, model_n, contact, notes)
    return Run(force_n=force_n, notes=notes)


def _taken(plan: Plan, motion: Followed, contact: NDArray[np.bool_], places: Taken) -> Taken:
    """Rows in which a place is taken: once the tool is off the object, or the history restarts."""
    if plan.passive is None or plan.passive.placed is None:
        return ()
    open_rows = np.append(np.union1d(np.flatnonzero(~contact), motion.starts), len(contact))
    # What comes before a tick's own row are the ticks missed before it, which the same call makes.
    begin = 1 + np.maximum.accumulate(np.append(-1, motion.row))
    asked = [(int(begin[tick]), place_m) for tick, place_m in places]
    return plan.passive.placed.taken(
        asked, lambda row: int(open_rows[np.searchsorted(open_rows, row)])
    )


def _depths(plan: Plan, pressed: Reals) -> tuple[dict[str, Reals], NDArray[np.bool_]]:
    """`penetration` and `clipped` of sp_step, each (n,), m, and where the depth was clipped."""
    minimum = plan.dtype(0) if plan.contact else plan.range.min_m
    penetration = np.where(pressed > minimum, pressed, minimum)
    clipped, outside = clip(plan.range, penetration if plan.contact else pressed)
    return {"penetration": penetration, "clipped": clipped}, outside


def _device_velocity(
    plan: Plan, velocity_mps: Reals | None, length: int
) -> tuple[Reals, NDArray[np.bool_]]:
    """The device's velocities, (n,), m/s, and where sp_guard_velocity.h believes them."""
    if not plan.needs_device_velocity or velocity_mps is None:
        return np.zeros(length, dtype=plan.dtype), np.ones(length, dtype=bool)
    velocity: Reals = np.asarray(velocity_mps, dtype=plan.dtype)
    return velocity, np.abs(velocity) <= plan.max_mps
