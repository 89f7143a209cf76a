"""The reference of what every stage sees: a row for each tick, those without a sample too."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.guarding import Guarded
from springpot.codegen.stages.stage import Starts


@dataclass(frozen=True, eq=False)
class Followed:
    """The tool's way through a run.

    (rows,): position, m; velocity, m/s; missed: no sample came. row: (n,), of each tick's sample,
    -1 where none was taken. starts: rows of restarts.
    """

    position: Reals
    velocity: Reals
    missed: NDArray[np.bool_]
    row: NDArray[np.int64]
    starts: Starts


def followed(plan: Plan, samples: Guarded, device_mps: Reals) -> Followed:
    """Before each sample a row for every tick missed, along an even way.

    With the estimated velocity of a coupling: at a constant acceleration from the velocity before.
    device_mps: (n,), the device's own velocity.
    """
    taken = np.flatnonzero(samples.ticks)
    ticks = samples.ticks[taken]
    rows = np.cumsum(ticks) - 1
    total = int(ticks.sum())
    position = np.zeros(total, dtype=samples.position.dtype)
    missed = np.ones(total, dtype=bool)
    position[rows] = samples.position[taken]
    missed[rows] = False
    row = np.full(len(samples.ticks), -1)
    row[taken] = rows
    starts = rows[samples.resync[taken]]
    if plan.velocity is not None:
        velocity = _estimated(plan, position, rows, ticks, starts)
    else:
        for k in np.flatnonzero(ticks > 1):
            _fill(plan, position, rows[k], ticks[k], None)
        velocity = at_rows(device_mps, row, missed)
    return Followed(position, velocity, missed, row, starts)


def at_rows(of_ticks: Reals, row: NDArray[np.int64], missed: NDArray[np.bool_]) -> Reals:
    """Values of ticks, (n,), at the rows of their samples and of the ticks missed before."""
    taken = np.flatnonzero(row >= 0)
    return of_ticks[taken[np.cumsum(~missed) - ~missed]]


def _estimated(
    plan: Plan, position: Reals, rows: NDArray[np.int64], ticks: NDArray[np.int64], starts: Starts
) -> Reals:
    """Fill the rows that were missed; velocity of the tool at every row, m/s."""
    assert plan.velocity is not None
    real = position.dtype.type
    velocity = np.zeros_like(position)
    restarts = set(starts.tolist())
    last, before = real(0), real(0)
    for end, since in zip(rows.tolist(), ticks.tolist(), strict=True):
        if since > 1:
            _fill(plan, position, end, since, last * plan.silence.dt_s)
        elif end in restarts:
            last, before = real(0), position[end]
        for i in range(end - since + 1, end + 1):
            last = plan.velocity.next(last, before, position[i])
            velocity[i], before = last, position[i]
    return velocity


def _fill(plan: Plan, position: Reals, end: int, since: int, begin: Reals | None) -> None:
    """Rows missed before the sample at row `end`; begin: the step, m, that the tool came with."""
    real = position.dtype.type
    step = (position[end] - position[end - since]) / real(since)
    left = np.arange(since - 1, 0, -1).astype(real)
    if begin is not None:
        step = step + (step - begin) / real(since) * (real(since) - left)
    way = position[end] - left * step
    position[end - since + 1 : end] = np.clip(way, plan.guard.min_m, plan.guard.max_m)
