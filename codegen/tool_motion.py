"""Reference of the samples that every stage sees: as the guard takes them, a row for each tick."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Flags, Reals
from springpot.codegen.model.formulas import SMALLEST
from springpot.codegen.plan import Plan
from springpot.codegen.stages.stage import Starts

SILENCE_PAYBACK, SILENCE_MAX_DEBT = 0.15625, 5.0  # SP_SILENCE_PAYBACK, SP_SILENCE_MAX_DEBT


@dataclass(frozen=True, eq=False)
class Guarded:
    """Samples of a run as the guard takes them, (n,) each.

    position: m. ticks: since the last accepted sample; 0 where none is accepted. share: of the held
    force that is felt then. resync: the history restarts at it. latched: the watchdog has fallen;
    fall: for so much of a tick without a sample.
    """

    position: Reals
    ticks: NDArray[np.int64]
    share: Reals
    resync: Flags
    latched: Flags
    fall: Reals


def run_guard(plan: Plan, raw: Reals) -> Guarded:
    """sp_guard.h and sp_silence.h over a run from a fresh state.

    raw: (n,), m.
    """
    config, silence, real = plan.guard, plan.silence, raw.dtype.type
    raw = np.where(np.abs(raw) < real(SMALLEST), real(0), raw)
    n = len(raw)
    position, share = raw.copy(), np.ones(n, dtype=raw.dtype)
    ticks = np.zeros(n, dtype=np.int64)
    resync, latches = np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
    fall = np.zeros(n, dtype=raw.dtype)
    last_good_m = suspect_m = silent_s = lost_s = real(0)
    agreeing = 0
    started = latched = False
    tick = silence.dt_s * silence.rate_hz
    worth = real(SILENCE_PAYBACK) * silence.dt_s
    plausible = (raw >= config.min_m) & (raw <= config.max_m)
    for i, x in enumerate(raw):
        elapsed = (silent_s + silence.dt_s) * silence.rate_hz
        since = 1 + (int(elapsed - real(0.5)) if elapsed >= 1.5 else 0)
        if not plausible[i]:
            agreeing = 0
        elif (
            started
            and abs(x - last_good_m) > config.max_step_m * real(since)
            and not (x <= config.air_m and last_good_m <= config.air_m)
        ):
            agrees = agreeing and abs(x - suspect_m) <= config.max_step_m
            agreeing = agreeing + 1 if agrees else 1
            suspect_m = x
            if agreeing >= config.resync_ticks:
                agreeing = 0
                resync[i], ticks[i], last_good_m = True, 1, x
        else:
            agreeing = 0
            resync[i] = not started
            ticks[i], last_good_m, started = 1 if not started else since, x, True
        # A lone outlier is a read error, such as a 0 at depth: it does not lower the force.
        if not ticks[i] and plan.contact and plausible[i] and silent_s > 0:
            remaining = x / last_good_m if x < last_good_m else real(1)
            share[i] = min(remaining, real(1)) if x > 0 else real(0)
        if ticks[i]:
            silent_s = real(0)
            lost_s = lost_s - worth if lost_s > 0 else lost_s
        elif latched:
            fall[i] = tick
        else:
            silent_s = silent_s + silence.dt_s
            lost_s = (lost_s if lost_s > 0 else real(0)) + silence.dt_s
            max_lost_s = real(SILENCE_MAX_DEBT) * silence.watchdog_s
            latched = not (silent_s <= silence.watchdog_s and lost_s <= max_lost_s)
            overrun_s = max(silent_s - silence.watchdog_s, lost_s - max_lost_s)
            beyond = overrun_s * silence.rate_hz
            if latched:
                fall[i], silent_s = min(real(int(beyond) + 1), tick), real(0)
        latches[i] = latched
        position[i] = last_good_m
    return Guarded(position, ticks, share, resync, latches, fall)


@dataclass(frozen=True, eq=False)
class ToolMotion:
    """The tool's way through a run.

    (rows,): position, m; velocity, m/s; missed: no sample came. row: (n,), of each tick's sample,
    -1 where none was accepted. starts: rows of restarts.
    """

    position: Reals
    velocity: Reals
    missed: Flags
    row: NDArray[np.int64]
    starts: Starts


def fill_missed_ticks(plan: Plan, samples: Guarded) -> ToolMotion:
    """Put a row before each sample for every tick that was missed, along an even way.

    The C makes the missed ticks up so, to keep the model's time. With the estimated velocity of a
    coupling: at a constant acceleration from the velocity before.
    """
    accepted = np.flatnonzero(samples.ticks)
    ticks = samples.ticks[accepted]
    rows = np.cumsum(ticks) - 1
    total = int(ticks.sum())
    position = np.zeros(total, dtype=samples.position.dtype)
    missed = np.ones(total, dtype=bool)
    position[rows] = samples.position[accepted]
    missed[rows] = False
    row = np.full(len(samples.ticks), -1)
    row[accepted] = rows
    starts = rows[samples.resync[accepted]]
    if plan.velocity is not None:
        velocity = _estimate_velocity(plan, position, rows, ticks, starts)
    else:
        for k in np.flatnonzero(ticks > 1):
            _fill_gap(plan, position, rows[k], ticks[k], None)
        velocity = np.zeros_like(position)
    return ToolMotion(position, velocity, missed, row, starts)


def select_rows(of_ticks: Reals, row: NDArray[np.int64], missed: Flags) -> Reals:
    """Return values of ticks, (n,), at the rows of their samples and of the ticks missed before."""
    accepted = np.flatnonzero(row >= 0)
    return of_ticks[accepted[np.cumsum(~missed) - ~missed]]


def _estimate_velocity(
    plan: Plan, position: Reals, rows: NDArray[np.int64], ticks: NDArray[np.int64], starts: Starts
) -> Reals:
    """Return the tool's velocity at every row, m/s, and fill the rows that were missed."""
    assert plan.velocity is not None
    real = position.dtype.type
    velocity = np.zeros_like(position)
    restarts = set(starts.tolist())
    last, before = real(0), real(0)
    for end, since in zip(rows.tolist(), ticks.tolist(), strict=True):
        if since > 1:
            _fill_gap(plan, position, end, since, last * plan.silence.dt_s)
        elif end in restarts:
            last, before = real(0), position[end]
        for i in range(end - since + 1, end + 1):
            last = plan.velocity.next(last, before, position[i])
            velocity[i], before = last, position[i]
    return velocity


def _fill_gap(plan: Plan, position: Reals, end: int, since: int, begin: Reals | None) -> None:
    """Fill the rows missed before the sample at row `end`; begin: the tool's step there, m."""
    real = position.dtype.type
    step = (position[end] - position[end - since]) / real(since)
    ticks_left = np.arange(since - 1, 0, -1).astype(real)
    if begin is not None:
        assert plan.velocity is not None  # which alone has a step to begin with
        bend = (step - begin) / (real(since) + plan.velocity.lag)
        step = step + bend * (real(since) - ticks_left)
    path_m = position[end] - ticks_left * step
    position[end - since + 1 : end] = np.clip(path_m, plan.guard.min_m, plan.guard.max_m)
