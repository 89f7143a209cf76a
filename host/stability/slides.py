"""A hand of three axes slides on a map, holds on its flanks, and goes round: the closed loop."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from itertools import pairwise

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.coupling.linear_loop import HAND_MODELS, Hand
from springpot.codegen.plan.plan import Plan
from springpot.codegen.progress import at_step
from springpot.codegen.short_repr import short_repr
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.simulation.hand_loop import Operator
from springpot.host.simulation.scenarios import Workspace
from springpot.host.simulation.slide_cases import SlideCase, slide_cases
from springpot.host.simulation.slide_loop import SlideTrace, run_slide
from springpot.host.stability.closed_loop import DEEPEST, MORE_DELAY
from springpot.host.stability.vibration import Vibration, high_passed_rms, vibration_of

RETURNED = 0.01  # of what the press stores
_FARTHER_M = 2e-3  # than a hand's spring is stretched by the greatest force


@dataclass(frozen=True, eq=False)
class SlideOutcome:
    """One case with one hand. returned_j: of the worst round; stored_j: what the press took."""

    case: str
    hand: str
    delay_samples: int
    bounded: bool
    max_depth_m: float
    max_force_n: float
    hf_speed_mps: float
    returned_j: float
    stored_j: float
    late: bool = False
    vibration: Vibration = field(default_factory=Vibration)
    __repr__ = short_repr

    def as_dict(self) -> dict[str, object]:
        found = asdict(self)
        del found["late"], found["vibration"]
        return {**found, **asdict(self.vibration), "grows": self.vibration.grows}

    @property
    def gives(self) -> bool:
        """Tell whether a round gives energy."""
        return self.returned_j > RETURNED * self.stored_j

    @property
    def unbounded(self) -> bool:
        """Tell whether a hand must not hold the device in this case."""
        return not self.bounded or self.vibration.grows or self.gives

    def loud(self, quiet_mps: float) -> bool:
        """Tell whether it vibrates faster than that on a hold."""
        return max(self.hf_speed_mps, self.vibration.lf_speed_mps or 0.0) > quiet_mps


def run_slides(plan: Plan, library: SceneLibrary) -> Iterator[SlideOutcome]:
    """Every case with every hand and delay, of a scene that slides; nothing of another."""
    if plan.lateral is None:
        return
    steps = len(HAND_MODELS) * len(MORE_DELAY)
    for number, hand in enumerate(HAND_MODELS):
        for later in MORE_DELAY:
            at_step(f"slides, {hand.name} hand", number * len(MORE_DELAY) + later, steps)
            for case in slide_cases(plan):
                yield _outcome(plan, library, case, hand, later)


def _outcome(
    plan: Plan, library: SceneLibrary, case: SlideCase, hand: Hand, later: int
) -> SlideOutcome:
    device = plan.loop_device.later(later)
    intended_m = _intended_m(library, case, hand)
    trace = run_slide(library, Operator(hand.name, device), plan.dt_s, intended_m, case.lost)
    still = [trace.velocity_mps[part, k] for part in case.holds for k in range(3)]
    # What the device's friction takes counts as paid: it takes what a late force gives.
    braked_j = device.viscous_nspm * plan.dt_s * np.sum(trace.velocity_mps**2, axis=1)
    work_j = np.append(0.0, trace.work_j + np.cumsum(braked_j[:-1]))
    per_round_j = np.diff(work_j[list(case.rounds)]) if case.rounds else np.zeros(1)
    return SlideOutcome(
        case=case.name,
        hand=hand.name,
        delay_samples=device.delay_samples,
        late=later > 0,
        bounded=_bounded(plan, trace, case, hand),
        max_depth_m=float(trace.position_m[:, 2].max()),
        max_force_n=float(np.linalg.norm(trace.force_n, axis=1).max()),
        hf_speed_mps=max((high_passed_rms(mps, plan.dt_s) for mps in still), default=0.0),
        returned_j=max(0.0, -float(per_round_j.min())),
        stored_j=float(work_j[case.rounds[0]] if case.rounds else work_j.max()),
        vibration=vibration_of(still, plan.dt_s),
    )


def _intended_m(library: SceneLibrary, case: SlideCase, hand: Hand) -> Samples:
    """Add to a path, (n, 3), m, what stretches the hand's spring by the force of the depth."""
    intended_m = case.path_m.copy()
    depth_m = case.path_m[:, 2]
    presses = np.flatnonzero(np.diff((depth_m > 0.0).astype(int)) == 1)
    for begin, end in pairwise([*presses.tolist(), len(depth_m)]):
        state = library.new_state()
        state.place((case.path_m[begin, 0], case.path_m[begin, 1]))
        force_n, _ = state.run(depth_m[begin:end])
        intended_m[begin:end, 2] += force_n / hand.stiffness_npm
    return intended_m


def _bounded(plan: Plan, trace: SlideTrace, case: SlideCase, hand: Hand) -> bool:
    """Tell whether force, depth and distance from the path stay within their bounds."""
    max_n = float(plan.output.max_n)
    length_n = np.linalg.norm(trace.force_n, axis=1)
    off_m = np.linalg.norm((trace.position_m - case.path_m)[:, :2], axis=1)
    allowed = bool(np.all(length_n <= (1.0 + 1e-6) * max_n))
    near = float(off_m.max()) <= max_n / hand.stiffness_npm + _FARTHER_M
    space = Workspace.of(plan)
    return allowed and near and float(trace.position_m[:, 2].max()) <= space.at(DEEPEST)
