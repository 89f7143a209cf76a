"""Cases of the closed loop: what a hand does, and what goes wrong meanwhile.

Sample-loss cases lose samples at every phase of a stroke.
"""

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.coupling.linear_loop import Hand
from springpot.codegen.plan import Plan
from springpot.host.simulation.hand_loop import Scenario
from springpot.host.simulation.scenarios import (
    RISE_S,
    Case,
    Force,
    Motion,
    Workspace,
    hold_motion,
    press_scenario,
    push_scenario,
    settled_hold_ticks,
    strike_motion,
    tap_motion,
)

TAKEN, LOST, LATE = 0, 1, 2  # sp_closed_loop_scenario.dropped
SPEEDS = {"": 1.0, "-fast": 4.0}  # times the trained speed
# Good samples for each lost one: 6.4 pay back its debt (sp_silence.h), so no such case latches.
GOOD_TICKS_PER_LOST = 7
MIN_LOSS_SPACING_S = 0.03  # the force may be wrong for 10 ms after a loss, and then has to settle
_SECONDS, _CYCLES = 2.0, 1.5  # minimum length of a session
_LONGEST_CYCLE_S = 20.0  # of a stroke: an object that was recorded slower is pressed faster
_SHARE = 0.8  # depth of a stroke, as a fraction of the trained one
_MIN_STROKE_TICKS = 24
_SPACINGS = 50  # spacings of losses that are tried, to reach every phase
# Lost samples, of how many; and whether the watchdog has to latch at that rate.
_RATES = {"rate-90": (1, 10, False), "rate-50": (1, 2, True), "rate-10": (9, 10, True)}
HOLDS = tuple(0.05 + 0.105 * i for i in range(11))  # of the trained depth: 5 to 110 %
STIFF_HOLDS = (0.2, 0.5, 0.8)
HOLD_S, STIFF_HOLD_S = 12.0, 1.5
SHORT_HOLD_S = 3.0  # for `emit`: an unstable loop has grown to its limit cycle by then
NUDGE_N, NUDGE_S = 0.5, 0.02  # begins every long hold, so that an unstable loop starts to swing
GLITCH_M = 0.005
JITTER, DROPPED = 0.3, 0.1


def sample_loss_cases(plan: Plan, force: Force, hand: Hand) -> list[tuple[Case, Case]]:
    """Return each case, and the same without a loss. force: the scene's on a motion."""
    pairs: list[tuple[Case, Case]] = []
    for suffix, speed in SPEEDS.items():
        clean, *losing = _loss_cases_at_speed(plan, force, hand, suffix, speed)
        pairs += [(lossy, clean) for lossy in losing]
    return pairs


def _loss_cases_at_speed(
    plan: Plan, force: Force, hand: Hand, suffix: str, speed: float
) -> list[Case]:
    """Return the case without a loss, then those that lose samples of the same strokes."""
    space = Workspace.of(plan)
    longest = max(1, round(plan.watchdog_s / plan.dt_s) - 1)
    half_m = 0.5 * (space.at(_SHARE) - space.free_m)
    stroke_s = np.pi * half_m / (speed * space.max_mps)  # at that top speed
    trained_ticks = 2.0 * max(stroke_s / space.dt_s, _MIN_STROKE_TICKS)
    cycle_ticks = min(trained_ticks, _LONGEST_CYCLE_S / plan.dt_s)
    per_s = np.pi / (0.5 * cycle_ticks * space.dt_s)

    def motion(t: Samples) -> Samples:
        return space.free_m + half_m * (1.0 - np.cos(per_s * t))

    seconds = max(_SECONDS, _CYCLES * cycle_ticks * plan.dt_s)
    beyond = suffix != "" or cycle_ticks < trained_ticks
    loss_cases: list[Case] = []

    def case(name: str, ends: bool = False) -> Scenario:
        scenario = press_scenario(space, motion, force, hand, seconds)
        loss_cases.append(
            Case(name + suffix, scenario, must_latch=ends, faster_than_trained=beyond)
        )
        return scenario

    n = len(case("clean").dt_s)
    for name, ticks in (("lost-1", 1), ("lost-2", 2), ("lost-10", min(10, longest))):
        case(name).dropped[loss_ticks(n, cycle_ticks, ticks, plan.dt_s)] = LOST
    case("late").dropped[loss_ticks(n, cycle_ticks, 1, plan.dt_s)] = LATE
    case("nan-5").error_m[loss_ticks(n, cycle_ticks, min(5, longest), plan.dt_s)] = np.nan
    for name, (lost, of, ends) in _RATES.items():
        case(name, ends).dropped[np.arange(n) % of < lost] = LOST
    return loss_cases


def loss_ticks(n: int, cycle_ticks: float, ticks: int, dt_s: float) -> NDArray[np.int64]:
    """Return ticks of losses of `ticks` each, evenly apart, from the first stroke's turn on.

    Less than a seventh of the ticks are lost, so that a session goes on. Of the shortest spacings
    that allow it, the one with phases in the cycle of strokes that leave the smallest gap.
    """
    least = ticks + max(GOOD_TICKS_PER_LOST * ticks, round(MIN_LOSS_SPACING_S / dt_s))
    first = int(0.5 * cycle_ticks)
    tried = np.unique(np.linspace(least, 1.5 * least, _SPACINGS).astype(np.int64))
    begins = [np.arange(first, n - least, spacing) for spacing in tried]
    best = min(begins, key=lambda at: largest_phase_gap(at, cycle_ticks))
    return np.asarray((best[:, None] + np.arange(ticks)).ravel())


def largest_phase_gap(begins: NDArray[np.int64], cycle_ticks: float) -> float:
    """Largest part of the cycle in which no loss begins."""
    phases = np.sort(begins / cycle_ticks % 1.0)
    return float(np.diff(phases, append=phases[0] + 1.0).max())


def stiff_case(plan: Plan, force: Force, hand: Hand) -> Case:
    """Hold at three depths of an object made stiffer."""
    space = Workspace.of(plan)
    motion, seconds = hold_motion(space, STIFF_HOLDS, STIFF_HOLD_S)
    still = settled_hold_ticks(space, len(STIFF_HOLDS), STIFF_HOLD_S)
    scenario = press_scenario(space, motion, force, hand, seconds)
    return Case("stiff", scenario, still, must_be_quiet=True, on_stiffer_object=True)


def hold_case(space: Workspace, force: Force, hand: Hand, hold_s: float = HOLD_S) -> Case:
    """Hold at eleven depths, and nudge the tool as each one begins."""
    motion, seconds = hold_motion(space, HOLDS, hold_s)
    scenario = press_scenario(space, motion, force, hand, seconds)
    time_s = np.cumsum(scenario.dt_s) % (RISE_S + hold_s)
    nudged = (time_s > RISE_S) & (time_s <= RISE_S + NUDGE_S)
    scenario.intended_m[nudged] += NUDGE_N / hand.stiffness_npm
    return Case("hold", scenario, settled_hold_ticks(space, len(HOLDS), hold_s), must_be_quiet=True)


def cases(plan: Plan, force: Force, hand: Hand) -> list[Case]:
    """Return all cases but `stiff`, which holds another scene. force: the scene's on a motion."""
    space = Workspace.of(plan)

    def press(motion: Motion, seconds: float, jitter: float = 0.0) -> Scenario:
        return press_scenario(space, motion, force, hand, seconds, jitter)

    tap = tap_motion(space, 4.0, 0.6)
    single, seconds = hold_motion(space, (0.5,), 2.6)
    longer, minute = hold_motion(space, (0.6,), 60.0)
    glitches = press(single, seconds)
    at = np.arange(round(1.0 / space.dt_s), len(glitches.dt_s), max(1, round(0.25 / space.dt_s)))
    glitches.error_m[at] = GLITCH_M * np.where(np.arange(len(at)) % 2, -1.0, 1.0)
    lost = press(single, seconds)
    # Bursts, each longer than the last, all shorter than the watchdog waits.
    longest = max(1, round(plan.watchdog_s / plan.dt_s) - 2)
    lengths = np.unique(np.linspace(1, longest, len(at)).astype(int))
    for begin, length in zip(at.tolist(), lengths.tolist(), strict=False):
        lost.error_m[begin : min(begin + length, round(3.0 / plan.dt_s))] = np.nan
    drops = press(tap, 3.0)
    drops.dropped[:] = np.random.default_rng(2).uniform(size=len(drops.dropped)) < DROPPED
    return [
        hold_case(space, force, hand),
        Case("tap-4hz", press(tap, 3.0)),
        Case("tap-8hz", press(tap_motion(space, 8.0, 0.4), 3.0)),
        Case("fast", press(strike_motion(space), 3.0)),
        Case("deep", push_scenario(space)),
        Case("jitter", press(tap, 3.0, JITTER)),
        Case("drops", drops),
        Case(
            "long-hold",
            press(longer, minute),
            settled_hold_ticks(space, 1, 60.0),
            must_be_quiet=True,
        ),
        Case("glitch", glitches, settled_hold_ticks(space, 1, 2.6)),
        Case("nan", lost, settled_hold_ticks(space, 1, 2.6)),
    ]
