"""Cases of the closed loop: what a hand does, and what goes wrong meanwhile."""

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.coupling.linear_loop import Hand
from springpot.codegen.plan.plan import Plan
from springpot.host.simulation.hand_loop import Scenario
from springpot.host.simulation.scenarios import (
    RISE_S,
    Case,
    Force,
    Motion,
    Workspace,
    holding,
    pressing,
    pushing,
    still_ticks,
    striking,
    tapping,
)

HOLDS = tuple(0.05 + 0.105 * i for i in range(11))  # of the trained depth: 5 to 110 %
STIFF_HOLDS = (0.2, 0.5, 0.8)
HOLD_S, STIFF_HOLD_S = 12.0, 1.5
NUDGE_N, NUDGE_S = 0.5, 0.02  # at the beginning of each long hold: what rings, begins to
GLITCH_M = 0.005
JITTER, DROPPED = 0.3, 0.1


def stiff_case(plan: Plan, force: Force, hand: Hand) -> Case:
    """Hold at three depths of an object made stiffer."""
    space = Workspace.of(plan)
    motion, seconds = holding(space, STIFF_HOLDS, STIFF_HOLD_S)
    still = still_ticks(space, len(STIFF_HOLDS), STIFF_HOLD_S)
    scenario = pressing(space, motion, force, hand, seconds)
    return Case("stiff", scenario, still, quiet=True, stiffer=True)


def held_case(space: Workspace, force: Force, hand: Hand) -> Case:
    """Hold at eleven depths, and nudge the tool as each one begins."""
    motion, seconds = holding(space, HOLDS, HOLD_S)
    scenario = pressing(space, motion, force, hand, seconds)
    time_s = np.cumsum(scenario.dt_s) % (RISE_S + HOLD_S)
    nudged = (time_s > RISE_S) & (time_s <= RISE_S + NUDGE_S)
    scenario.intended_m[nudged] += NUDGE_N / hand.stiffness_npm
    return Case("hold", scenario, still_ticks(space, len(HOLDS), HOLD_S), quiet=True)


def cases(plan: Plan, force: Force, hand: Hand) -> list[Case]:
    """All cases but `stiff`, which holds another scene. force: the model alone's."""
    space = Workspace.of(plan)

    def press(motion: Motion, seconds: float, jitter: float = 0.0) -> Scenario:
        return pressing(space, motion, force, hand, seconds, jitter)

    tap = tapping(space, 4.0, 0.6)
    single, seconds = holding(space, (0.5,), 2.6)
    longer, minute = holding(space, (0.6,), 60.0)
    glitches = press(single, seconds)
    at = np.arange(round(1.0 / space.dt_s), len(glitches.dt_s), max(1, round(0.25 / space.dt_s)))
    glitches.error_m[at] = GLITCH_M * np.where(np.arange(len(at)) % 2, -1.0, 1.0)
    lost = press(single, seconds)
    lost.error_m[_bursts(plan, at)] = np.nan
    drops = press(tap, 3.0)
    drops.dropped[:] = np.random.default_rng(2).uniform(size=len(drops.dropped)) < DROPPED
    return [
        held_case(space, force, hand),
        Case("tap-4hz", press(tap, 3.0)),
        Case("tap-8hz", press(tapping(space, 8.0, 0.4), 3.0)),
        Case("fast", press(striking(space), 3.0)),
        Case("deep", pushing(space)),
        Case("jitter", press(tap, 3.0, JITTER)),
        Case("drops", drops),
        Case("long-hold", press(longer, minute), still_ticks(space, 1, 60.0), quiet=True),
        Case("glitch", glitches, still_ticks(space, 1, 2.6)),
        Case("nan", lost, still_ticks(space, 1, 2.6)),
    ]


def _bursts(plan: Plan, at: NDArray[np.intp]) -> NDArray[np.intp]:
    """Ticks of bursts, each longer than the last, all shorter than the watchdog waits."""
    longest = max(1, round(plan.watchdog_s / plan.dt_s) - 2)
    lengths = np.unique(np.linspace(1, longest, len(at)).astype(int))
    found = np.concatenate(
        [begin + np.arange(n) for begin, n in zip(at, lengths, strict=False)]
    )  # fmt: skip
    return np.asarray(found[found < round(3.0 / plan.dt_s)])
