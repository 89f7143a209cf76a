"""Numpy reference of sp_step3: a tool of three axes on a map, tick by tick, bit for bit."""

from typing import Any

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.plan.limits import GuardConfig
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.guarding import SILENCE_WORTH
from springpot.codegen.reference.lateral_motion import LateralMotion
from springpot.codegen.reference.lateral_output import Output3
from springpot.codegen.reference.notes import HELD, OUTSIDE, RESYNC
from springpot.codegen.reference.run import Run
from springpot.codegen.stages.model_force import clip
from springpot.codegen.stages.stage import flushed


def run_lateral(plan: Plan, position_m: Reals) -> Run:
    """Run sp_step3 on positions, (n, 3): x, y, depth, m, from a fresh state.

    The forces are (n, 3), N, of the scene's type.
    """
    loop = _Loop(plan)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        found = [loop.step(at) for at in np.asarray(position_m, dtype=plan.dtype)]
    forces, notes = zip(*found, strict=True)
    return Run(np.array(forces, dtype=plan.dtype), np.array(notes, dtype=np.int32))


class _Axis:
    """sp_guard_position of one axis."""

    def __init__(self, config: GuardConfig, real: type[Any]) -> None:
        self._config, self._real = config, real
        self._good: Any = real(0)
        self._suspect: Any = real(0)
        self._agreeing, self._started = 0, False

    def plausible(self, x: Any) -> bool:
        """Tell whether a tool may be at these positions."""
        return bool(self._config.min_m <= x <= self._config.max_m)

    def position(self, x: Any, ticks: Any) -> tuple[Any, int]:
        """Position that is believed, m, and notes."""
        x = flushed(x)
        if not self.plausible(x):
            self._agreeing = 0
            return self._good, HELD
        if not self._started:
            self._started, self._good = True, x
            return x, RESYNC
        if abs(x - self._good) <= self._config.jump_m * ticks:
            self._agreeing, self._good = 0, x
            return x, 0
        agrees = self._agreeing and abs(x - self._suspect) <= self._config.jump_m
        self._agreeing, self._suspect = self._agreeing + 1 if agrees else 1, x
        if self._agreeing < self._config.resync_ticks:
            return self._good, HELD
        self._agreeing, self._good = 0, x
        return x, RESYNC

    def within(self, x: Any) -> Any:
        """sp_guard_within."""
        return max(min(x, self._config.max_m), self._config.min_m)


class _Loop:
    """sp_step3: which sample is taken, the ticks up to it, what leaves."""

    def __init__(self, plan: Plan) -> None:
        assert plan.lateral is not None
        self._plan, self._real = plan, plan.dtype
        guards = (plan.lateral_guard, plan.lateral_guard, plan.guard)
        self._axes = [_Axis(config, plan.dtype) for config in guards]
        self._motion = LateralMotion(plan.lateral, plan.dtype)
        zero = self._real(0)
        self._output = Output3(plan)
        self._silent, self._missed, self._latched, self._began = zero, zero, False, False

    def step(self, raw: Reals) -> tuple[list[Any], int]:
        """Force, N, and notes."""
        silence, left = self._plan.silence, 0
        if self._silent > 0:
            ticks = (self._silent + silence.dt_s) * silence.per_dt
            left = int(ticks - self._real(0.5)) if ticks >= 1.5 else 0
        ticks = self._real(left + 1)
        taken = [axis.position(x, ticks) for axis, x in zip(self._axes, raw, strict=True)]
        at, notes = [x for x, _ in taken], 0
        for _, note in taken:
            notes |= note
        self._began |= bool(notes & RESYNC)
        if notes & HELD:
            given_n, notes = self._held(flushed(raw[2]))
            return self._output.vector(given_n), notes
        self._heard()
        if self._began:
            notes |= RESYNC
            self._began, left = False, 0
            self._motion.rest(at)
            self._output.restart()
        before = self._output.vector(self._output.given)
        if left:
            self._make_up(at, ticks, left)
        length_n, note = self._tick(at)
        self._output.came_from(before, self._latched)
        given_n, more = self._output.force(self._latched, left > 0, length_n)
        return self._output.vector(given_n), notes | note | more

    def _make_up(self, at: list[Any], ticks: Any, left: int) -> None:
        steps = [(x - was) / ticks for x, was in zip(at, self._motion.at, strict=True)]
        for k in range(left, 0, -1):
            ways = [x - self._real(k) * step for x, step in zip(at, steps, strict=True)]
            self._tick([axis.within(x) for axis, x in zip(self._axes, ways, strict=True)])

    def _tick(self, at: list[Any]) -> tuple[Any, int]:
        """tick3: length of the model's force, N, and notes."""
        zero = self._real(0)
        inside = at[2] > 0
        outside = clip(self._plan.range, np.array([at[2] if inside else zero]))[1][0]
        felt, touches, on_grid = self._motion.tick(at)
        note = OUTSIDE if outside or (inside and not on_grid) else 0
        if not inside:
            self._output.free()
        if not touches:
            return zero, note
        share = at[2] * self._plan.per_onset
        return self._output.turn([n * share if share < 1 else n for n in felt]), note

    def _heard(self) -> None:
        self._silent = self._real(0)
        if self._missed > 0:
            self._missed = self._missed - self._real(SILENCE_WORTH) * self._plan.silence.dt_s

    def _held(self, depth: Any) -> tuple[Any, int]:
        """hold3 of one tick: its length, N, and notes."""
        silence, fall, real = self._plan.silence, self._real(0), self._real
        passed = silence.dt_s * silence.per_dt
        if self._latched:
            fall = passed
        else:
            self._silent = self._silent + silence.dt_s
            self._missed = (self._missed if self._missed > 0 else real(0)) + silence.dt_s
            self._latched = not self._missed <= silence.watchdog_s
            if self._latched:
                beyond = (self._missed - silence.watchdog_s) * silence.per_dt
                fall, self._silent = min(real(int(beyond) + 1), passed), real(0)
        good, share = self._motion.at[2], real(1)
        if self._axes[2].plausible(depth):
            part = depth / good if depth < good else real(1)
            share = min(part, real(1)) if depth > 0 else real(0)
        return self._output.hold(self._latched, fall, share)
