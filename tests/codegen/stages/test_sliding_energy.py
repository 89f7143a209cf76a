"""An adversary slides on maps through the emitted C: no motion may give energy back.

A motion begins and ends off the object, and may leave it and come back elsewhere between. Work is
the trapezoid sum of float64 forces along x, y and depth. Across an edge of the grid's cells the
lateral force jumps: the motion is slow there, so that a step of the sum is short.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from support.c.sliding import Fault, SlidingC, sliding
from support.small import DT_S, passive_model, scene

from springpot import Model, ScenePlaces
from springpot.codegen.model.places import Places
from springpot.emission import Plan, make_plan
from springpot.modelling import Hammerstein

BOUND = 1e-5
SPAN_M, STEP_M, CELLS = 0.012, 0.01, 3
WAVES, LEG_TICKS = 6, 250
# Nodes of a curve, branches, those of a rate by depth, stops, materials.
SHAPES = ((9, 3, 1, 1, 2), (13, 4, 4, 0, 3), (1, 2, 0, 2, 1), (9, 1, 1, 0, 2))
Shape = tuple[int, int, int, int, int]


def random_model(seed: int, shape: Shape = SHAPES[0]) -> Model:
    """Any mixture that is not negative."""
    nodes, branches, deep, stops, materials = shape
    rng = np.random.default_rng(seed)

    def weights(*size: int) -> np.ndarray:
        return rng.exponential(5.0, size) * (rng.uniform(size=size) < 0.6)

    passive = Hammerstein(
        origin_m=0.0, span_m=SPAN_M, elastic_n=np.ones(nodes),
        tau_s=10.0 ** rng.uniform(-2.5, 1.0, branches), branch_n=np.ones((branches, nodes)),
        radius_m=rng.uniform(0.01, 0.6, stops) * SPAN_M, stop_n=np.ones((stops, nodes)),
        bias_n=0.0, n_by_depth=deep, rate_ratio=float(16.0 ** rng.uniform(-1.0, 1.0)),
    )  # fmt: skip
    slopes_n = np.stack([
        np.concatenate([weights(nodes), weights(branches * nodes) + 0.1, weights(stops * nodes)])
        for _ in range(materials)
    ])  # fmt: skip
    amounts = weights(CELLS + 1, CELLS + 1, materials) + 0.01
    return placed(passive, Places(np.zeros(2), np.full(2, STEP_M), amounts, slopes_n))


def placed(passive: Hammerstein, places: Places) -> Model:
    bounded = replace(passive.with_slopes(places.most_n), places=places)
    return replace(passive_model(), hammerstein=bounded)


def plan_of(model: Model) -> Plan:
    """The model as it is: no limit, no onset to speak of."""
    chosen = scene(number="float64")
    guard = replace(chosen.guard, max_force_n=1e4, onset_mm=1e-4)
    return make_plan(model, replace(chosen, places=ScenePlaces("lateral", 8.0), guard=guard))


def random_motion(seed: int, presses: int = 3, legs: int = 6) -> np.ndarray:
    """x, y and depth, (n, 3), m: presses while the tool goes from cell to cell over their edges."""
    rng = np.random.default_rng(seed)
    cell = rng.integers(0, CELLS, 2)
    corners = [cell + rng.uniform(0, 1, 2)]
    for _ in range(legs * presses - 1):
        ways = [(k, d) for k in (0, 1) for d in (-1, 1) if 0 <= cell[k] + d < CELLS]
        k, d = ways[rng.integers(len(ways))]
        corner = cell + rng.uniform(0, 1, 2)
        corner[k] = cell[k] + (d > 0)
        corners.append(corner)
        cell[k] += d
    corners.append(cell + rng.uniform(0, 1, 2))
    t = np.arange(LEG_TICKS) / LEG_TICKS
    smooth = (t * t * (3.0 - 2.0 * t))[:, None]
    way = [a + (b - a) * smooth for a, b in pairwise(corners)]
    t = np.arange(legs * LEG_TICKS) / (legs * LEG_TICKS)
    depths = []
    for _ in range(presses):
        turns = 2 * np.pi * np.arange(1, WAVES + 1)[:, None] * t
        cosines, sines = rng.normal(0.0, 0.4, (2, WAVES, 1))
        waves = (cosines * np.cos(turns) + sines * np.sin(turns)).sum(axis=0)
        size, deep = rng.choice([0.1, 0.3, 1.0]), rng.uniform(0.2, 0.8)
        depth = size * np.sin(np.pi * t) ** 2 * (waves + deep)
        # Soft at the surface, and below 0 where it is off the object.
        depths.append(0.5 * (depth + np.sqrt(depth**2 + 4e-4)) - 0.01)
    depth_m = SPAN_M * np.append(np.concatenate(depths), 0.0)
    return np.column_stack([STEP_M * np.concatenate([*way, corners[-1][None]]), depth_m])


def min_work(position_m: np.ndarray, force_n: np.ndarray) -> float:
    """Least work until any tick off the object, over peak force x depth."""
    ways_m, means_n = np.diff(position_m, axis=0), 0.5 * (force_n[1:] + force_n[:-1])
    # The force along the depth pushes out of the object, against its way.
    work_j = np.cumsum((ways_m * means_n) @ np.array([-1.0, -1.0, 1.0]))
    peak_n = np.linalg.norm(force_n, axis=1).max()
    return float(work_j[position_m[1:, 2] <= 0].min() / (peak_n * position_m[:, 2].max()))


def least(built: SlidingC, seeds: Sequence[int], shape: Shape = SHAPES[0]) -> float:
    """The least over models and motions."""
    found = []
    for seed in seeds:
        built.take(plan_of(random_model(seed, shape)))
        position_m = random_motion(seed)
        found.append(min_work(position_m, built.force_n(position_m)))
    return min(found)


MANY = [pytest.param(shape, range(1000, 1250), marks=pytest.mark.slow) for shape in SHAPES]


@pytest.mark.parametrize(("shape", "seeds"), [(SHAPES[0], range(20)), *MANY])
def test_no_slide_on_a_random_map_gives_energy_back(shape: Shape, seeds: range) -> None:
    with sliding(plan_of(random_model(0, shape))) as built:
        assert least(built, seeds, shape) > -BOUND


PLANTED: dict[str, Sequence[Fault]] = {
    "a lateral force of the wrong sign": [("felt_n[0] -= here", "felt_n[0] += here")],
    "no lateral force": [("here.by_x * stored_j", "(sp_real)0"),
                         ("here.by_y * stored_j", "(sp_real)0")],
    "what branches hold left out": [("- lost;", "- sp_stored_area(its, curve, n, place);")],
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("fault", PLANTED)
def test_the_adversary_finds_a_planted_fault(fault: str) -> None:
    with sliding(plan_of(random_model(0)), PLANTED[fault]) as built:
        assert least(built, range(40)) < -100 * BOUND


@pytest.mark.slow
def test_the_adversary_finds_an_amount_below_0() -> None:
    law = random_model(0).hammerstein
    amounts = law.places.amounts.copy()
    amounts[1:3, 1:3, 0] = -0.5 * amounts.max()  # of one material: the other one pushes on
    amounts[:, :, 1] = amounts.max()
    wrong = replace(law, places=replace(law.places, amounts=amounts))
    with sliding(plan_of(random_model(0))) as built:
        built.take(plan_of(replace(random_model(0), hammerstein=wrong)))
        slides = [random_motion(seed) for seed in range(40)]
        assert min(min_work(each, built.force_n(each)) for each in slides) < -100 * BOUND


FAR = ("const int crosses = (at[0] > m_per_cell) != (state->lateral.at_m[0] > m_per_cell);\n"
       "    const sp_real share = sp_lateral_move(")  # fmt: skip
FAR = FAR.replace("m_per_cell", "(sp_real)0.005")
FORGETS = """for (uint32_t i = 0; crosses && i < passive.n_branches; i++) {
            state->lateral_held[r * passive.n_branches + i] = lateral_branch[i];
        }
        const sp_real *held ="""
UNPAID = [(f"felt_n[{k}] -= config->stiffness_npm * drawn_m[{k}];", "") for k in (0, 1)]
UNPAID += [("+ config->drag_npm);", ");"), (" - config->drag_npm * drawn_m[k]", "")]


def require_found(amounts: np.ndarray, branch_n: float, position_m: np.ndarray,
                  faults: Sequence[Fault]) -> None:  # fmt: skip
    """Assert that a motion on a map, of a spring and a branch, is passive, and with faults not."""
    curve = np.ones(9)
    passive = Hammerstein(
        origin_m=0.0, span_m=SPAN_M, elastic_n=curve, tau_s=np.array([0.5]),
        branch_n=branch_n * curve[None], radius_m=np.zeros(0), stop_n=np.zeros((0, 9)), bias_n=0.0,
    )  # fmt: skip
    places = Places(np.zeros(2), np.full(2, STEP_M), amounts, passive.slopes_n[None])
    works = []
    for planted in ([], faults):
        with sliding(plan_of(placed(passive, places)), planted) as built:
            works.append(min_work(position_m, built.force_n(position_m)))
    assert works[0] > -BOUND
    assert works[1] < -100 * BOUND


@pytest.mark.slow
def test_fresh_ground_is_paid_for() -> None:
    """Pressed slowly, rubbed to and fro, faster and faster in ever smaller ways, and let go."""
    ticks_s = np.arange(0.0, 22.1, DT_S)
    depth = np.interp(ticks_s, [0.0, 20.0, 22.0, 22.05, 22.1], [0.0, 0.8, 0.8, -0.01, -0.01])
    rubs_s = np.clip(ticks_s - 20.0, 0.0, 2.0)
    rub = np.exp(-0.5 * rubs_s) * np.sin(2 * np.pi * (3.0 + 5.0 * rubs_s**2) * rubs_s)
    position_m = np.column_stack([STEP_M * (0.5 + 0.45 * rub), STEP_M * (0.5 + 0.4 * rub),
                                  SPAN_M * depth])  # fmt: skip
    require_found(np.ones((2, 2, 1)), 8.0, position_m, UNPAID)


STAYS = "const int stays ="
GOES = """for (uint32_t k = 0; k < 2 && !touches; k++) {
        const sp_real per_m = k == 0 ? map->per_step_x : map->per_step_y;
        (void)sp_anchor_along(&state->at[k], &state->cell[k],
                              k == 0 ? map->nodes_x : map->nodes_y,
                              (at[k] - last->at_m[k]) * per_m);
    }
    """
MOVES, RESTS = (
    "const sp_real share = sp_lateral_move(&state->lateral, at, ",
    "        restart3(state, at);\n    }\n    const",
)
# Seconds and depth of each way: the tool slides, from soft to stiff, in the one that is None.
Ways = Sequence[tuple[float, float | None]]
DIRECTED: dict[str, tuple[Sequence[Fault], Ways]] = {
    "through the dent, where the surface comes back": (
        [(STAYS, GOES + STAYS)],
        [(0.3, 0.8), (2.0, 0.8), (0.05, 0.5), (0.05, None), (20.0, -0.01)],
    ),
    "off the object, and back into the dent": (
        [(RESTS, RESTS.replace("restart3(state", "sp_anchor_rest(&place_map, &state->anchor"))],
        [(0.3, 0.8), (2.0, 0.8), (0.05, -0.01), (0.05, None), (0.05, 0.4), (20.0, -0.01)],
    ),
    "pressed, while what branches hold is made new": (
        [(MOVES, FAR + MOVES.removeprefix("const sp_real share = sp_lateral_move(")),
         ("const sp_real *held =", FORGETS)],
        [(20.0, 0.8), (0.05, None), (0.05, -0.01)],
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("motion", DIRECTED)
def test_no_memory_is_worth_more_elsewhere(motion: str) -> None:
    faults, ways = DIRECTED[motion]
    stiffer = 1.0 if "made new" in motion else 50.0
    depths, xs = [0.0], [0.0]
    for _, depth in ways:
        xs.append(1.0 if depth is None else xs[-1])
        depths.append(depths[-1] if depth is None else depth)
    corners_s = np.cumsum([0.0, *(seconds for seconds, _ in ways)])
    ticks_s = np.arange(0.0, corners_s[-1] + DT_S, DT_S)
    x, depth = (np.interp(ticks_s, corners_s, its) for its in (xs, depths))
    position_m = np.column_stack([STEP_M * x, np.zeros_like(x), SPAN_M * depth])
    require_found(np.array([[[1.0], [1.0]], [[stiffer], [stiffer]]]), 2.0, position_m, faults)
