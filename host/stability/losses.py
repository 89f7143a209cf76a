"""Effect of lost samples on the force: kick, recovery time, energy given back."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from springpot.codegen import notes
from springpot.codegen.arrays import Flags, Samples, runs
from springpot.codegen.plan import Plan
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.simulation.cases import LATE, TAKEN
from springpot.host.simulation.hand_loop import Scenario, Trace
from springpot.host.simulation.scenarios import Workspace

RECOVERY_S, OVERSHOOT_S = 0.010, 0.005  # after samples are back: within the error; never above it
ERROR_N, ERROR_OF_PEAK = 0.5, 0.05
# A force that is held while the hand turns gives energy: 4 % of a press for a silence of 19 ms at
# the worst phase. The hand's own damping takes that.
RETURNED_OF_STORED = 0.05
MAX_WATCHDOG_TIMEOUTS = 25.0  # times the watchdog's, where too few samples come from the beginning
_ROUNDING_N = 1e-4
_TOUCH = 0.05  # of the trained depth: contact beyond doubt


@dataclass(frozen=True)
class SampleLossEffects:
    """Beside the same strokes without a loss (clean_...).

    growth_n: of |force| in a tick, beyond the slew of each sample that came; above 0 it is a kick.
    error_n: the greatest from RIGHT_S after samples are back, against the same scene that loses
    none, on the same motion, this tick or the one before or after, for an object may let go of the
    tool a tick later; above_n: how far above that from NOT_ABOVE_S on; allowed_n: of both.
    returned_j: energy that a press gave back beyond what it took, and what the device's friction
    takes; stored_j: the most that a press without a loss took.
    """

    growth_n: float
    error_n: float
    above_n: float
    allowed_n: float
    returned_j: float
    clean_returned_j: float
    stored_j: float

    @property
    def faults(self) -> tuple[str, ...]:
        """Properties that do not hold, in words."""
        returned_j = self.returned_j - max(self.clean_returned_j, 0.0)
        conditions = {
            "lost samples are felt as a kick": self.growth_n > _ROUNDING_N,
            "the force stays wrong after lost samples": self.error_n > self.allowed_n
            or self.above_n > self.allowed_n,
            "lost samples give the hand energy": returned_j > RETURNED_OF_STORED * self.stored_j,
        }
        return tuple(words for words, holds in conditions.items() if holds)


def compare_with_lossless(
    plan: Plan, library: SceneLibrary, scenario: Scenario, trace: Trace, clean: Trace
) -> SampleLossEffects:
    """Compare strokes with lost samples with the same strokes without: force, energy, recovery."""
    # The force of the same scene, with every sample of that motion.
    seen_m = np.where(np.isfinite(trace.seen_m), trace.seen_m, trace.position_m)
    whole_n = library.new_state().run(seen_m, trace.seen_mps)[0].astype(np.float64)
    least_n, most_n = _within_a_tick(whole_n)
    error_n = np.maximum(least_n - trace.force_n, trace.force_n - most_n)
    above_n = np.abs(trace.force_n) - _within_a_tick(np.abs(whole_n))[1]
    # Samples that have come one after the other, this one too; many before the first loss.
    good = _accepted(scenario)
    at = np.arange(len(good))
    good_s = plan.dt_s * (at - np.maximum.accumulate(np.where(good, -len(good), at)))
    late = good_s >= RECOVERY_S - 0.5 * plan.dt_s
    later = good_s >= OVERSHOOT_S - 0.5 * plan.dt_s
    peak_n = float(np.abs(whole_n).max(initial=0.0))
    returned, clean_returned = (list(_presses_j(plan, item)) for item in (trace, clean))
    return SampleLossEffects(
        growth_n=_growth_n(plan, scenario, trace),
        error_n=float(error_n[late].max(initial=0.0)),
        above_n=float(above_n[later].max(initial=0.0)),
        allowed_n=max(ERROR_N, ERROR_OF_PEAK * peak_n),
        returned_j=max((-given for given, _ in returned), default=0.0),
        clean_returned_j=max((-given for given, _ in clean_returned), default=0.0),
        stored_j=max((work_j for _, work_j in clean_returned), default=0.0),
    )


def latched_s(plan: Plan, trace: Trace) -> float | None:
    """Return the time at which the scene latched, s; None if it did not."""
    latched = np.flatnonzero(trace.notes & notes.LATCHED)
    return float(latched[0]) * plan.dt_s if len(latched) else None


def ended(plan: Plan, trace: Trace) -> bool:
    """Return True if the scene latched in time, and the force fell to zero and stayed there."""
    begin_s = latched_s(plan, trace)
    if begin_s is None or begin_s > MAX_WATCHDOG_TIMEOUTS * plan.watchdog_s:
        return False
    fallen = round((begin_s + RECOVERY_S) / plan.dt_s) + 1
    return fallen < len(trace.force_n) and not trace.force_n[fallen:].any()


def _accepted(scenario: Scenario) -> Flags:
    return np.asarray((scenario.dropped == TAKEN) & np.isfinite(scenario.error_m))


def longest_silence_ticks(scenario: Scenario) -> int:
    """Return ticks of the longest time without a good sample."""
    accepted = np.concatenate([[True], _accepted(scenario), [True]])
    return int(np.diff(np.flatnonzero(accepted)).max()) - 1


def _growth_n(plan: Plan, scenario: Scenario, trace: Trace) -> float:
    """Return how far the force grew beyond its limit: a slew for each sample, 0 without one."""
    dropped = scenario.dropped
    came = _accepted(scenario).astype(np.int64)
    came[1:] += (dropped[:-1] == LATE) & (dropped[1:] == TAKEN)
    size_n = np.abs(trace.force_n)
    return float((np.diff(size_n, prepend=0.0) - float(plan.output.slew_n) * came).max())


def _within_a_tick(force_n: Samples) -> tuple[Samples, Samples]:
    """The least and the greatest force of each tick, the one before and the one after it, N."""
    around_n = sliding_window_view(np.pad(force_n, 1, mode="edge"), 3)
    return around_n.min(axis=1), around_n.max(axis=1)


def _presses_j(plan: Plan, trace: Trace) -> Iterator[tuple[float, float]]:
    """Return the energy that each press took in all, and the most that it held at a time, J.

    A press lasts from the surface to the surface; where there is none, from turn to turn outside.
    """
    moved_m = np.diff(trace.position_m)
    friction_j = plan.loop_device.viscous_nspm * moved_m**2 / plan.dt_s
    work_j = trace.force_n[:-1] * moved_m + friction_j
    space = Workspace.of(plan)
    edge_m = space.base_m if plan.contact else space.base_m + 2.0 * _TOUCH * space.span_m
    for begin, end in runs(trace.position_m[:-1] > edge_m):
        work_in_j = np.cumsum(work_j[begin:end])
        yield float(work_in_j.min()), float(work_in_j.max())
