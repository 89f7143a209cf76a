"""Cases of the closed loop in which samples stay away, at the fastest part of every stroke."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.coupling.linear_loop import Hand
from springpot.codegen.plan.plan import Plan
from springpot.host.simulation.hand_loop import Scenario
from springpot.host.simulation.scenarios import Case, Force, Workspace, pressing

TAKEN, LOST, LATE = 0, 1, 2  # sp_closed_loop_scenario.dropped
SPEEDS = {"": 1.0, "-fast": 4.0}  # times the trained speed
_SECONDS = 1.5
_SHARE = 0.8  # of the trained depth
_MIN_STROKE_TICKS = 24
# Lost, of so many; and whether a session goes on at such a rate of samples.
_RATES = {"rate-90": (1, 10, True), "rate-50": (1, 2, False), "rate-10": (9, 10, False)}


def losing_cases(plan: Plan, force: Force, hand: Hand) -> list[tuple[Case, Case]]:
    """Each case, and the same without a loss. force: the model alone's."""
    space = Workspace.of(plan)
    longest = max(1, round(plan.watchdog_s / plan.dt_s) - 1)
    found = []
    for suffix, speed in SPEEDS.items():
        stroke_ticks = _stroke_ticks(space, speed)
        motion = _strokes(space, stroke_ticks)

        def press(motion: Callable[[Samples], Samples] = motion) -> Scenario:
            return pressing(space, motion, force, hand, _SECONDS)

        def case(name: str, judged: bool = True, suffix: str = suffix) -> Case:
            return Case(name + suffix, press(), judged=judged, beyond=suffix != "")

        clean = case("clean")
        n = len(clean.scenario.dt_s)
        middles = np.arange(2.5 * stroke_ticks, n - stroke_ticks, stroke_ticks).astype(int)
        for name, ticks in (("lost-1", 1), ("lost-2", 2), ("lost-10", min(10, longest))):
            lossy = case(name)
            lossy.scenario.dropped[_around(middles, ticks)] = LOST
            found.append((lossy, clean))
        late, nan = case("late"), case("nan-5")
        late.scenario.dropped[middles] = LATE
        nan.scenario.error_m[_around(middles, min(5, longest))] = np.nan
        found += [(late, clean), (nan, clean)]
        for name, (lost, of, judged) in _RATES.items():
            lossy = case(name, judged)
            lossy.scenario.dropped[np.arange(n) % of < lost] = LOST
            found.append((lossy, clean))
    return found


def _stroke_ticks(space: Workspace, speed: float) -> float:
    """Ticks of a stroke, in or out, whose top speed is so many times the trained one."""
    half_m = 0.5 * (space.at(_SHARE) - space.free_m)
    return max(np.pi * half_m / (speed * space.max_mps) / space.dt_s, _MIN_STROKE_TICKS)


def _strokes(space: Workspace, stroke_ticks: float) -> Callable[[Samples], Samples]:
    half_m = 0.5 * (space.at(_SHARE) - space.free_m)
    per_s = np.pi / (stroke_ticks * space.dt_s)
    return lambda t: space.free_m + half_m * (1.0 - np.cos(per_s * t))


def _around(middles: NDArray[np.int64], ticks: int) -> NDArray[np.int64]:
    return (middles[:, None] - ticks // 2 + np.arange(ticks)).ravel()
