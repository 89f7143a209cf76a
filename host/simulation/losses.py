"""Cases of the closed loop in which samples stay away, at every phase of the strokes."""

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.coupling.linear_loop import Hand
from springpot.codegen.plan.plan import Plan
from springpot.host.simulation.hand_loop import Scenario
from springpot.host.simulation.scenarios import Case, Force, Motion, Workspace, pressing

TAKEN, LOST, LATE = 0, 1, 2  # sp_closed_loop_scenario.dropped
SPEEDS = {"": 1.0, "-fast": 4.0}  # times the trained speed
GOOD_PER_LOST = 7  # samples that come for one that does not; 6.4 make up for it (sp_silence.h)
APART_S = 0.03  # between losses, at least: a force may be wrong for 10 ms after each
_SECONDS, _CYCLES = 2.0, 1.5  # of a session, at least
_LONGEST_CYCLE_S = 20.0  # of pressing and letting go: an object recorded slower is pressed faster
_SHARE = 0.8  # of the trained depth
_MIN_STROKE_TICKS = 24
_SPACINGS = 50  # that are tried
# Lost, of so many; and whether a session ends at such a rate of samples.
_RATES = {"rate-90": (1, 10, False), "rate-50": (1, 2, True), "rate-10": (9, 10, True)}


def losing_cases(plan: Plan, force: Force, hand: Hand) -> list[tuple[Case, Case]]:
    """Each case, and the same without a loss. force: the model alone's."""
    space = Workspace.of(plan)
    longest = max(1, round(plan.watchdog_s / plan.dt_s) - 1)
    found = []
    for suffix, speed in SPEEDS.items():
        trained_ticks = 2.0 * _stroke_ticks(space, speed)
        cycle_ticks = min(trained_ticks, _LONGEST_CYCLE_S / plan.dt_s)
        motion = _strokes(space, 0.5 * cycle_ticks)
        seconds = max(_SECONDS, _CYCLES * cycle_ticks * plan.dt_s)
        beyond = suffix != "" or cycle_ticks < trained_ticks

        def press(motion: Motion = motion, seconds: float = seconds) -> Scenario:
            return pressing(space, motion, force, hand, seconds)

        def case(
            name: str, ends: bool = False, suffix: str = suffix, beyond: bool = beyond
        ) -> Case:
            return Case(name + suffix, press(), ends=ends, beyond=beyond)

        clean = case("clean")
        n = len(clean.scenario.dt_s)
        for name, ticks in (("lost-1", 1), ("lost-2", 2), ("lost-10", min(10, longest))):
            lossy = case(name)
            lossy.scenario.dropped[loss_ticks(n, cycle_ticks, ticks, plan.dt_s)] = LOST
            found.append((lossy, clean))
        late, nan = case("late"), case("nan-5")
        late.scenario.dropped[loss_ticks(n, cycle_ticks, 1, plan.dt_s)] = LATE
        nan.scenario.error_m[loss_ticks(n, cycle_ticks, min(5, longest), plan.dt_s)] = np.nan
        found += [(late, clean), (nan, clean)]
        for name, (lost, of, ends) in _RATES.items():
            lossy = case(name, ends)
            lossy.scenario.dropped[np.arange(n) % of < lost] = LOST
            found.append((lossy, clean))
    return found


def loss_ticks(n: int, cycle_ticks: float, ticks: int, dt_s: float) -> NDArray[np.int64]:
    """Ticks of losses of `ticks` each, evenly apart, from the first stroke's turn on.

    Less than a seventh of the ticks are lost, so that a session goes on. Of the shortest spacings
    that allow it, the one whose phases in the cycle of strokes leave the smallest gap.
    """
    least = ticks + max(GOOD_PER_LOST * ticks, round(APART_S / dt_s))
    first = int(0.5 * cycle_ticks)
    tried = np.unique(np.linspace(least, 1.5 * least, _SPACINGS).astype(np.int64))
    begins = [np.arange(first, n - least, spacing) for spacing in tried]
    best = min(begins, key=lambda at: phase_gap(at, cycle_ticks))
    return np.asarray((best[:, None] + np.arange(ticks)).ravel())


def phase_gap(begins: NDArray[np.int64], cycle_ticks: float) -> float:
    """Largest part of the cycle in which no loss begins."""
    phases = np.sort(begins / cycle_ticks % 1.0)
    return float(np.diff(phases, append=phases[0] + 1.0).max())


def _stroke_ticks(space: Workspace, speed: float) -> float:
    """Ticks of a stroke, in or out, whose top speed is so many times the trained one."""
    half_m = 0.5 * (space.at(_SHARE) - space.free_m)
    return max(np.pi * half_m / (speed * space.max_mps) / space.dt_s, _MIN_STROKE_TICKS)


def _strokes(space: Workspace, stroke_ticks: float) -> Motion:
    half_m = 0.5 * (space.at(_SHARE) - space.free_m)
    per_s = np.pi / (stroke_ticks * space.dt_s)

    def motion(t: Samples) -> Samples:
        return space.free_m + half_m * (1.0 - np.cos(per_s * t))

    return motion
