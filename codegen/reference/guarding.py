"""The reference of the guard: which samples are taken, and how long there was none."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.plan.plan import Plan
from springpot.codegen.stages.stage import SMALLEST

SILENCE_WORTH = 0.15625  # SP_SILENCE_WORTH


@dataclass(frozen=True, eq=False)
class Guarded:
    """Samples of a run as the guard takes them, (n,) each.

    position: m. ticks: since the sample taken before; 0 where none is taken. share: of the held
    force that is felt then. silent: ticks without
    one before it. resync: the history restarts at it. latched: the watchdog has fallen;
    fall: for so much of a tick without a sample.
    """

    position: Reals
    ticks: NDArray[np.int64]
    share: Reals
    silent: Reals
    resync: NDArray[np.bool_]
    latched: NDArray[np.bool_]
    fall: Reals


def guarded(plan: Plan, raw: Reals, believed: NDArray[np.bool_]) -> Guarded:
    """sp_guard.h and sp_silence.h over a run from a fresh state.

    raw: (n,), m. believed: (n,), whether the device's own velocity is.
    """
    config, silence, real = plan.guard, plan.silence, raw.dtype.type
    raw = np.where(np.abs(raw) < real(SMALLEST), real(0), raw)
    n = len(raw)
    position, share = raw.copy(), np.ones(n, dtype=raw.dtype)
    ticks = np.zeros(n, dtype=np.int64)
    resync, latches = np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
    fall = np.zeros(n, dtype=raw.dtype)
    good = suspect = silent = lost = real(0)
    agreeing = 0
    started = latched = False
    tick = silence.dt_s * silence.per_dt
    worth = real(SILENCE_WORTH) * silence.dt_s
    plausible = (raw >= config.min_m) & (raw <= config.max_m)
    before = np.zeros(n, dtype=raw.dtype)
    for i, x in enumerate(raw):
        before[i] = silent * silence.per_dt
        elapsed = (silent + silence.dt_s) * silence.per_dt
        since = 1 + (int(elapsed - real(0.5)) if elapsed >= 1.5 else 0)
        if believed[i] and not plausible[i]:
            agreeing = 0
        elif believed[i] and started and abs(x - good) > config.jump_m * real(since):
            agrees = agreeing and abs(x - suspect) <= config.jump_m
            agreeing = agreeing + 1 if agrees else 1
            suspect = x
            if agreeing >= config.resync_ticks:
                agreeing = 0
                resync[i], ticks[i], good = True, 1, x
        elif believed[i]:
            agreeing = 0
            resync[i] = not started
            ticks[i], good, started = 1 if not started else since, x, True
        if not ticks[i] and plan.contact and plausible[i]:
            part = x / good if x < good else real(1)
            share[i] = min(part, real(1)) if x > 0 else real(0)
        if ticks[i]:
            silent = real(0)
            lost = lost - worth if lost > 0 else lost
        elif latched:
            fall[i] = tick
        else:
            silent = silent + silence.dt_s
            lost = (lost if lost > 0 else real(0)) + silence.dt_s
            latched = not lost <= silence.watchdog_s
            beyond = (lost - silence.watchdog_s) * silence.per_dt
            if latched:
                fall[i], silent = min(real(int(beyond) + 1), tick), real(0)
        latches[i] = latched
        position[i] = good
    return Guarded(position, ticks, share, before, resync, latches, fall)
