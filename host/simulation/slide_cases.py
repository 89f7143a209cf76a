"""Cases of three axes: slides over the steepest edge of a map, holds, rounds, lost samples."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.plan.plan import Plan
from springpot.codegen.short_repr import short_repr
from springpot.host.simulation.cases import loss_ticks
from springpot.host.simulation.scenarios import RISE_S, Workspace, smooth

_SHARES, _HOLD_S = (0.3, 0.9), 7.0  # of the trained depth, on each place
_SPEEDS_MPS, _WAYS, _DEPTH = (0.02, 0.08), 6, 0.5
_ROUNDS, _ROUND_S = 10, 1.0
_LOST = 10  # ticks of a silence
_APART = 2  # steps of the grid, which has twice as many nodes along an axis as sites
_AIR_S, _SETTLE_S = 0.3, 1.0
_NUDGE_M, _NUDGE_S = 5e-4, 0.02  # along x, as a hold begins: what rings, begins to


@dataclass(frozen=True, eq=False)
class SlideCase:
    """Name a path of the tool, (n, 3), m, the ticks of its holds, and those that begin rounds.

    lost: ticks that get no sample.
    """

    name: str
    path_m: Samples
    holds: tuple[slice, ...] = ()
    rounds: tuple[int, ...] = ()
    lost: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    __repr__ = short_repr


def slide_cases(plan: Plan) -> list[SlideCase]:
    """Cases about the steepest edge of the map: between two sites that differ most."""
    soft_m, stiff_m = _steepest_m(plan)
    space, middle_m = Workspace.of(plan), 0.5 * (soft_m + stiff_m)
    places_m = (soft_m, middle_m, stiff_m)
    radius_m = 0.5 * float(np.linalg.norm(stiff_m - soft_m))
    orbit = _orbit(space, middle_m, radius_m)
    per_round, longest = round(_ROUND_S / space.dt_s), round(plan.watchdog_s / plan.dt_s) - 1
    lost = loss_ticks(len(orbit.path_m), per_round, max(1, min(_LOST, longest)), space.dt_s)
    return [
        _slides(space, soft_m, stiff_m),
        _edges(space, places_m),
        orbit,
        replace(orbit, name="orbit-lost", lost=lost),
    ]


def _steepest_m(plan: Plan) -> tuple[Samples, Samples]:
    """The two nodes, a site's distance apart, that differ most, softer and stiffer, (2,), m."""
    assert plan.lateral is not None
    placed = plan.lateral.placed
    config = placed.config
    worth = placed.amounts.astype(np.float64) @ np.abs(placed.materials).sum(axis=1)
    step_m = 1.0 / np.array([config.per_step_x, config.per_step_y], dtype=np.float64)
    apart = np.minimum(_APART, np.array(worth.shape) - 1)
    slopes = [_rises(worth, k, int(apart[k])) / (apart[k] * step_m[k]) for k in range(2)]
    axis = int(slopes[1].max() > slopes[0].max())
    node = np.array(np.unravel_index(np.argmax(slopes[axis]), slopes[axis].shape))
    nodes = [node, node + apart * np.eye(2, dtype=int)[axis]]
    nodes.sort(key=lambda at: float(worth[tuple(at)]))
    first_m = np.array([config.first_x_m, config.first_y_m], dtype=np.float64)
    soft_m, stiff_m = (first_m + at * step_m for at in nodes)
    return soft_m, stiff_m


def _rises(worth: Samples, axis: int, apart: int) -> Samples:
    """How much nodes that lie so many steps apart along an axis differ."""
    along = np.moveaxis(worth, axis, 0)
    rises: Samples = np.moveaxis(np.abs(along[apart:] - along[:-apart]), 0, axis)
    return rises


def _slides(space: Workspace, soft_m: Samples, stiff_m: Samples) -> SlideCase:
    """Slide to and fro over both nodes at each speed."""
    reach_m = 0.5 * (stiff_m - soft_m)
    ends_m = (soft_m - reach_m, stiff_m + reach_m)
    parts = [_press(space, ends_m[0], _DEPTH, 0.1)]
    for speed_mps in _SPEEDS_MPS:
        n = max(2, round(4.0 * float(np.linalg.norm(reach_m)) / speed_mps / space.dt_s))
        for way in range(_WAYS):
            begin_m, end_m = ends_m if way % 2 == 0 else ends_m[::-1]
            share = np.linspace(0.0, 1.0, n)[:, None]
            parts.append(_at(begin_m + share * (end_m - begin_m), space.at(_DEPTH)))
    parts.append(_release(space, parts[-1][-1]))
    return SlideCase("slide", np.concatenate(parts))


def _edges(space: Workspace, places_m: tuple[Samples, ...]) -> SlideCase:
    """Hold at depths of each place, off the object between them."""
    parts: list[Samples] = []
    holds = []
    stations = [(place_m, share) for place_m in places_m for share in _SHARES]
    for place_m, share in stations:
        if parts:
            here_m, n = parts[-1][-1, :2], round(_AIR_S / space.dt_s)
            way = smooth(np.linspace(0.0, 1.0, n))[:, None]
            parts.append(_at(here_m + way * (place_m - here_m), space.free_m))
        parts.append(_press(space, place_m, share, _HOLD_S))
        begin, nudge = round(RISE_S / space.dt_s), round(_NUDGE_S / space.dt_s)
        parts[-1][begin : begin + nudge, 0] += _NUDGE_M
        end = sum(map(len, parts))
        holds.append(slice(end - round((_HOLD_S - _SETTLE_S) / space.dt_s), end))
        parts.append(_release(space, parts[-1][-1]))
    return SlideCase("edge", np.concatenate(parts), tuple(holds))


def _orbit(space: Workspace, middle_m: Samples, radius_m: float) -> SlideCase:
    """Go round at one depth."""
    per_round = round(_ROUND_S / space.dt_s)
    turn = 2.0 * np.pi * np.arange(_ROUNDS * per_round) / per_round
    circle_m = middle_m + radius_m * np.column_stack([np.cos(turn), np.sin(turn)])
    down = _press(space, circle_m[0], _DEPTH, 0.5)
    round_m = _at(circle_m, space.at(_DEPTH))
    path_m = np.concatenate([down, round_m, _release(space, round_m[-1])])
    rounds = tuple(len(down) + per_round * k for k in range(_ROUNDS + 1))
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
