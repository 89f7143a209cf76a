"""Numpy reference of the emitted C: the same operations in the same order, bit for bit."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Flags, Reals
from springpot.codegen.notes import CLAMPED, HELD, LATCHED, LIMITED, OUTSIDE, RAMPED, RESYNC, Notes
from springpot.codegen.plan import Plan
from springpot.codegen.proxy_motion import (
    ContactTrace,
    VirtualCoupling,
    apply_onset_and_fade,
    simulate_proxy,
)
from springpot.codegen.stages.model_stages import clip_depth, compute_model_force
from springpot.codegen.stages.passive.placed import PlaceTicks
from springpot.codegen.stages.stage import Starts, smooth_average
from springpot.codegen.tool_motion import (
    Guarded,
    ToolMotion,
    fill_missed_ticks,
    run_guard,
    select_rows,
)
from springpot.codegen.types import Scalar


@dataclass(frozen=True, eq=False)
class Run:
    """Returns of the C for each tick: force_n, shape (n,), the scene's type; notes, (n,)."""

    force_n: Reals
    notes: Notes


def run_reference(
    plan: Plan,
    position_m: Reals,
    predicted_m: Reals | None = None,
    places: PlaceTicks = (),
) -> Run:
    """Run the plan on positions from a fresh state.

    position_m: shape (n,), any float type; rounded to the scene's type first.
    predicted_m: (n,), where the C's proxy was; it decides how long this takes, never the result.
    places: before which tick sp_place was called, and with what, m.
    """
    raw_m = np.asarray(position_m, dtype=plan.dtype)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        samples = run_guard(plan, raw_m)
        motion = fill_missed_ticks(plan, samples)
        starts = motion.starts
        contact = motion.position > 0 if plan.contact else np.ones(len(motion.position), dtype=bool)
        pressed = motion.position
        place_changes = _find_place_changes(plan, motion, contact, places)
        if plan.at_proxy:

            def at_proxy(first: int, proxy: Reals, begun: Starts, asked: Flags) -> Reals:
                since = [(max(row - first, 0), place_m) for row, place_m in place_changes]
                return compute_model_force(
                    plan, _compute_depths(plan, proxy)[0], begun, asked, since
                )

            predicted = predicted_m
            if predicted_m is not None:
                predicted = select_rows(predicted_m, motion.row, motion.missed)
            pressed = simulate_proxy(plan, ContactTrace(motion, contact), at_proxy, predicted)
        depths, outside = _compute_depths(plan, pressed)
        accepted = motion.row >= 0
        notes = np.where(samples.resync, RESYNC, 0).astype(np.int32)
        notes[accepted] |= np.where(outside[motion.row[accepted]], OUTSIDE, 0).astype(np.int32)
        model_n = compute_model_force(plan, depths, starts, contact, place_changes)
        output = OutputStage(plan)
        force_n = output.run(samples, motion, pressed, model_n, contact, notes)
    return Run(force_n=force_n, notes=notes)


def _find_place_changes(
    plan: Plan, motion: ToolMotion, contact: Flags, places: PlaceTicks
) -> PlaceTicks:
    """Find the rows from which a new site is felt: when the tool is off, or after a restart."""
    if plan.passive is None or plan.passive.placed is None:
        return ()
    change_rows = np.append(np.union1d(np.flatnonzero(~contact), motion.starts), len(contact))
    # What comes before a tick's own row are the ticks missed before it, which the same call makes.
    begin = 1 + np.maximum.accumulate(np.append(-1, motion.row))
    asked = [(int(begin[tick]), place_m) for tick, place_m in places]
    return plan.passive.placed.find_changes(
        asked, lambda row: int(change_rows[np.searchsorted(change_rows, row)])
    )


def _compute_depths(plan: Plan, pressed: Reals) -> tuple[dict[str, Reals], Flags]:
    """`penetration` and `clipped` of sp_step, each (n,), m, and where the depth was clipped."""
    minimum = plan.dtype(0) if plan.contact else plan.range.min_m
    penetration = np.where(pressed > minimum, pressed, minimum)
    clipped, outside = clip_depth(plan.range, penetration if plan.contact else pressed)
    return {"penetration": penetration, "clipped": clipped}, outside


class OutputStage:
    """Contact, coupling, smoothing and output: sp_contact.h to sp_output.h."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._couple = VirtualCoupling(plan.couple) if plan.couple is not None else None
        self._output = OutputLimiter(plan)
        self._smoothed = plan.dtype(0)

    def run(
        self, guarded: Guarded, followed: ToolMotion, pressed: Reals, model_n: Reals,
        contact: Flags, notes: Notes,
    ) -> Reals:  # fmt: skip
        """Return the rendered force of each tick, (n,), N: coupling, smoothing, limits, silences.

        Adds its notes to `notes`, (n,). Of the rows of `fill_missed_ticks`, (rows,): pressed, where
        the model looks, m, the model's force, N, and whether there is contact.
        """
        model_n = apply_onset_and_fade(self._plan, pressed, model_n)
        force_n = np.zeros(len(notes), dtype=model_n.dtype)
        for i, (ticks, latched) in enumerate(zip(guarded.ticks, guarded.latched, strict=True)):
            if not ticks:
                force_n[i], notes[i] = self._output.hold(latched, guarded.fall[i], guarded.share[i])
                continue
            row = followed.row[i]
            if notes[i] & RESYNC:
                self._forget()
                self._output.restart()
            for index in range(row - ticks + 1, row + 1):
                force = model_n.dtype.type(0)
                if contact[index]:
                    force = model_n[index]
                    if self._couple is not None:
                        x, v = followed.position[index], followed.velocity[index]
                        force = self._couple.force(x, v, force)
                    if (alpha := self._plan.smooth_alpha) is not None:
                        force = self._smoothed = smooth_average(alpha, self._smoothed, force)
                else:
                    self._forget()
                    self._output.release()
            force_n[i], note = self._output.force(latched, force)
            notes[i] |= note
        return force_n

    def _forget(self) -> None:
        if self._couple is not None:
            self._couple.proxy = None
        self._smoothed = self._plan.dtype(0)


class OutputLimiter:
    """Keep the force of the last call, and bound the next one by it."""

    def __init__(self, plan: Plan) -> None:
        self._config = plan.output
        self._real = plan.dtype
        self.last_force_n: Scalar = self._real(0)
        self._ramp: Scalar = self._real(0)

    def restart(self) -> None:
        """The ramp begins again."""
        self._ramp = self._real(0)

    def release(self) -> None:
        """No contact."""
        self._ramp = self._real(1)

    def hold(self, latched: Scalar, fall: Scalar, share: Scalar) -> tuple[Scalar, int]:
        """Return force, N, and notes of a tick without a good sample; fall: latched fraction."""
        self.last_force_n = share * self.last_force_n
        if latched:
            return self._fall(fall), LATCHED
        return self.last_force_n, HELD

    def force(self, latched: Scalar, force: Scalar) -> tuple[Scalar, int]:
        """Return force, N, and notes of a tick with a good sample: ramp, clamp and slew limit."""
        if latched:
            return self._fall(self._real(1)), LATCHED
        note = 0
        if self._ramp < 1:
            force = force * self._ramp
            self._ramp = self._ramp + self._config.ramp_per_tick * self._real(1)
            note |= RAMPED
        force, clamped = self._clamp(force)
        self.last_force_n, limited = self._limit_slew(force)
        note |= clamped | limited
        return self.last_force_n, note

    def _last_same_sign(self, force: Scalar) -> Scalar:
        given, zero = self.last_force_n, self._real(0)
        return max(given, zero) if force > 0 else min(given, zero)

    def _clamp(self, force: Scalar) -> tuple[Scalar, int]:
        min_n, max_n = self._config.min_n, self._config.max_n
        if min_n <= force <= max_n:
            return force, 0
        beyond = min_n if force < min_n else self._real(0)
        return (max_n if force > max_n else beyond), CLAMPED

    def _limit_slew(self, force: Scalar) -> tuple[Scalar, int]:
        slew = self._config.slew_n * self._real(1)
        before = self._last_same_sign(force)
        most, least = before + slew, before - slew
        if force > 0:
            return (most, LIMITED) if force > most else (force, 0)
        return (least, LIMITED) if force < least else (force, 0)

    def _fall(self, ticks: Scalar) -> Scalar:
        step = self._config.latch_fall_n * ticks
        down, up = self.last_force_n - step, self.last_force_n + step
        self.last_force_n = down if down > 0 else up if up < 0 else self._real(0)
        return self.last_force_n
