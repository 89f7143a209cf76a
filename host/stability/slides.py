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
from springpot.host.simulation.scenarios import RISE_S, Workspace, smooth
from springpot.host.simulation.slide_loop import SlideTrace, run_slide
from springpot.host.stability.vibration import Vibration, high_passed_rms, vibration_of

MORE_DELAY = (0, 1)  # samples, beyond the device's own
DEEPEST = 1.3  # of the trained depth
SHARES, HOLD_S = (0.3, 0.9), 7.0  # of the trained depth, on each place
SPEEDS_MPS, WAYS, DEPTH = (0.02, 0.08), 6, 0.5
ROUNDS, ROUND_S = 10, 1.0
RETURNED = 0.01  # of what the press stores
_AIR_S, _SETTLE_S = 0.3, 1.0
_FARTHER_M = 2e-3  # than a hand's spring is stretched by the greatest force
_NUDGE_N, _NUDGE_S = 0.5, 0.02


@dataclass(frozen=True, eq=False)
class SlideCase:
    """Where the tool shall be, (n, 3), m; ticks in which it holds; those at which rounds begin."""

    name: str
    path_m: Samples
    holds: tuple[slice, ...] = ()
    rounds: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class SlideOutcome:
    """One case with one hand. returned_j: of the worst round; stored_j: most that a press took."""

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
        """Whether a round gives energy."""
        return self.returned_j > RETURNED * self.stored_j

    @property
    def unbounded(self) -> bool:
        """Whether it is not to be held."""
        return not self.bounded or self.vibration.grows or self.gives

    def loud(self, quiet_mps: float) -> bool:
        """Whether it vibrates faster than that on a hold."""
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


def slide_cases(plan: Plan) -> list[SlideCase]:
    """Cases about the steepest edge of the map: between two nodes that differ most."""
    soft_m, stiff_m = _steepest_m(plan)
    space, middle_m = Workspace.of(plan), 0.5 * (soft_m + stiff_m)
    places_m = (soft_m, middle_m, stiff_m)
    return [_slides(space, soft_m, stiff_m), _edges(space, places_m), _orbit(space, middle_m,
            0.5 * float(np.linalg.norm(stiff_m - soft_m)))]  # fmt: skip


def _steepest_m(plan: Plan) -> tuple[Samples, Samples]:
    """The two neighbouring nodes that differ most, softer and stiffer, (2,), m."""
    assert plan.lateral is not None
    placed = plan.lateral.placed
    config = placed.config
    worth = placed.amounts.astype(np.float64) @ np.abs(placed.materials).sum(axis=1)
    step_m = 1.0 / np.array([config.per_step_x, config.per_step_y], dtype=np.float64)
    slopes = [np.abs(np.diff(worth, axis=k)) / step_m[k] for k in range(2)]
    axis = int(slopes[1].max() > slopes[0].max())
    node = np.array(np.unravel_index(np.argmax(slopes[axis]), slopes[axis].shape))
    nodes = [node, node + np.eye(2, dtype=int)[axis]]
    nodes.sort(key=lambda at: float(worth[tuple(at)]))
    first_m = np.array([config.first_x_m, config.first_y_m], dtype=np.float64)
    soft_m, stiff_m = (first_m + at * step_m for at in nodes)
    return soft_m, stiff_m


def _slides(space: Workspace, soft_m: Samples, stiff_m: Samples) -> SlideCase:
    """Slide to and fro over both nodes at each speed."""
    reach_m = 0.5 * (stiff_m - soft_m)
    ends_m = (soft_m - reach_m, stiff_m + reach_m)
    parts = [_press(space, ends_m[0], DEPTH, 0.1)]
    for speed_mps in SPEEDS_MPS:
        n = max(2, round(4.0 * float(np.linalg.norm(reach_m)) / speed_mps / space.dt_s))
        for way in range(WAYS):
            begin_m, end_m = ends_m if way % 2 == 0 else ends_m[::-1]
            share = np.linspace(0.0, 1.0, n)[:, None]
            parts.append(_at(begin_m + share * (end_m - begin_m), space.at(DEPTH)))
    parts.append(_release(space, parts[-1][-1]))
    return SlideCase("slide", np.concatenate(parts))


def _edges(space: Workspace, places_m: tuple[Samples, ...]) -> SlideCase:
    """Hold at depths of each place, off the object between them."""
    parts: list[Samples] = []
    holds = []
    stations = [(place_m, share) for place_m in places_m for share in SHARES]
    for place_m, share in stations:
        if parts:
            here_m, n = parts[-1][-1, :2], round(_AIR_S / space.dt_s)
            way = smooth(np.linspace(0.0, 1.0, n))[:, None]
            parts.append(_at(here_m + way * (place_m - here_m), space.free_m))
        parts.append(_press(space, place_m, share, HOLD_S))
        end = sum(map(len, parts))
        holds.append(slice(end - round((HOLD_S - _SETTLE_S) / space.dt_s), end))
        parts.append(_release(space, parts[-1][-1]))
    return SlideCase("edge", np.concatenate(parts), tuple(holds))


def _orbit(space: Workspace, middle_m: Samples, radius_m: float) -> SlideCase:
    """Go round at one depth."""
    per_round = round(ROUND_S / space.dt_s)
    turn = 2.0 * np.pi * np.arange(ROUNDS * per_round) / per_round
    circle_m = middle_m + radius_m * np.column_stack([np.cos(turn), np.sin(turn)])
    down = _press(space, circle_m[0], DEPTH, 0.5)
    round_m = _at(circle_m, space.at(DEPTH))
    path_m = np.concatenate([down, round_m, _release(space, round_m[-1])])
    rounds = tuple(len(down) + per_round * k for k in range(ROUNDS + 1))
    return SlideCase("orbit", path_m, rounds=rounds)


def _at(place_m: Samples, depth_m: float | Samples) -> Samples:
    n = len(place_m)
    return np.column_stack([place_m, np.broadcast_to(depth_m, n)])


def _press(space: Workspace, place_m: Samples, share: float, hold_s: float) -> Samples:
    """Go down at a place and stay."""
    n = round((RISE_S + hold_s) / space.dt_s)
    rise = smooth(np.arange(n) * space.dt_s / RISE_S)
    depth_m = space.free_m + (space.at(share) - space.free_m) * rise
    return _at(np.tile(place_m, (n, 1)), depth_m)


def _release(space: Workspace, at_m: Samples) -> Samples:
    n = round(RISE_S / space.dt_s)
    depth_m = at_m[2] + (space.free_m - at_m[2]) * smooth(np.linspace(0.0, 1.0, n))
    return _at(np.tile(at_m[:2], (n, 1)), depth_m)


def _outcome(
    plan: Plan, library: SceneLibrary, case: SlideCase, hand: Hand, later: int
) -> SlideOutcome:
    device = plan.loop_device.later(later)
    intended_m = _intended_m(library, case, hand)
    trace = run_slide(library, Operator(hand.name, device), plan.dt_s, intended_m)
    still = [trace.velocity_mps[part, k] for part in case.holds for k in range(3)]
    work_j = np.append(0.0, trace.work_j)
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
        stored_j=float(work_j.max()),
        vibration=vibration_of(still, plan.dt_s),
    )


def _intended_m(library: SceneLibrary, case: SlideCase, hand: Hand) -> Samples:
    """Where the hand has to want to be, (n, 3), so that the tool is pressed as deep as it shall."""
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
    """Whether force, depth and distance from the path are."""
    max_n = float(plan.output.max_n)
    length_n = np.linalg.norm(trace.force_n, axis=1)
    off_m = np.linalg.norm((trace.position_m - case.path_m)[:, :2], axis=1)
    allowed = bool(np.all(length_n <= (1.0 + 1e-6) * max_n))
    near = float(off_m.max()) <= max_n / hand.stiffness_npm + _FARTHER_M
    space = Workspace.of(plan)
    return allowed and near and float(trace.position_m[:, 2].max()) <= space.at(DEEPEST)
