"""Friction of a tool that slides: bits of C and reference, the cone, drift, and energy."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from codegen.stages.test_lateral import SLIDING as FREE, at_depth, slid
from codegen.stages.test_placed import placed
from codegen.stages.test_sliding_energy import (
    BOUND,
    SHAPES,
    SPAN_M,
    STEP_M,
    Shape,
    least,
    placed as on_map,
    plan_of as bare,
    random_model,
)
from support.c.sliding import Fault, sliding
from support.small import DEPTH_M, DT_S

from springpot import Model, ScenePlaces, UsageError
from springpot.codegen.model.places import Places
from springpot.emission import Plan, literal, make_plan
from springpot.modelling import Hammerstein
from springpot.native import built

MU = 0.4
FRICTIONS = (0.0, 0.3, 1.0)


def sticking(plan: Plan, friction: float = MU) -> Plan:
    """The same scene with friction."""
    places = replace(plan.scene.places, friction=friction)
    return make_plan(plan.model, replace(plan.scene, places=places))


def rough(model: Model, friction: float = MU) -> Plan:
    """The model as it is, without limits."""
    return sticking(bare(model), friction)


@cache
def even() -> Plan:
    """A map of one amount, of a spring alone."""
    curve = np.ones(9)
    passive = Hammerstein(
        origin_m=0.0, span_m=SPAN_M, elastic_n=8.0 * curve, tau_s=np.array([0.1]),
        branch_n=1e-9 * curve[None], radius_m=np.zeros(0), stop_n=np.zeros((0, 9)), bias_n=0.0,
    )  # fmt: skip
    grid = Places(np.zeros(2), np.full(2, STEP_M), np.ones((4, 4, 1)), passive.slopes_n[None])
    return rough(on_map(passive, grid))


def pressed(way_m: np.ndarray, depth_m: float = 0.5 * DEPTH_M) -> np.ndarray:
    """Positions of a press on the middle of the map, and then of a way along x at that depth."""
    down = np.linspace(-1e-4, depth_m, 200)
    x_m = np.concatenate([np.zeros(len(down)), way_m])
    return at_depth(np.append(down, np.full(len(way_m), depth_m)), 1.5 * STEP_M + x_m, 1.6 * STEP_M)


def test_the_force_sideways_is_a_spring_within_the_cone_and_the_cone_beyond() -> None:
    lateral = even().lateral
    way_m = np.linspace(0.0, 6e-3, 600)
    with built(even()) as library:
        force_n, _ = slid(library, pressed(way_m))
    force_n = force_n[-len(way_m) :]
    cone_n = MU * force_n[:, 2]
    spring_n = lateral.anchor.stick_npm * way_m
    np.testing.assert_allclose(-force_n[:, 0], np.minimum(spring_n, cone_n), atol=0.02)
    assert (spring_n < 0.9 * cone_n).sum() > 20 < (spring_n > 1.1 * cone_n).sum()
    assert not np.any(force_n[:, 1])


def test_a_tool_that_rests_does_not_drift_and_one_that_goes_back_within_the_cone_is_back() -> None:
    still_s = 60.0
    short_m = 4e-4 * np.sin(np.linspace(0.0, np.pi, 200))
    slipped_m = np.linspace(0.0, 4e-3, 400)
    rest_m = np.full(round(still_s / DT_S), 4e-3)
    with built(even()) as library:
        back_n, _ = slid(library, pressed(short_m))
        rests_n, _ = slid(library, pressed(np.concatenate([slipped_m, rest_m])))
    assert abs(back_n[-1, 0]) < 1e-9
    assert back_n[:, 0].min() < -0.1
    assert len(np.unique(rests_n[-len(rest_m) + 2000 :, 0])) == 1
    assert rests_n[-1, 0] < -0.5


def test_a_release_forgets_the_spring() -> None:
    there, away = np.linspace(0.0, 1e-3, 100), np.full(20, -1e-4)
    first = pressed(there)
    gone = at_depth(away, first[-1, 0], first[-1, 1])
    down = at_depth(np.linspace(0.0, 0.5 * DEPTH_M, 100), first[-1, 0], first[-1, 1])
    with built(even()) as library:
        force_n, _ = slid(library, np.concatenate([first, gone, down]))
    assert force_n[len(first) - 1, 0] < -0.1
    assert not np.any(force_n[len(first) + 1 :, :2])


def test_friction_is_refused_where_nothing_slides() -> None:
    with pytest.raises(UsageError, match="lateral"):
        make_plan(placed("plain", 1), replace(FREE, places=ScenePlaces(friction=0.3)))


MANY = [pytest.param(shape, range(1000, 1085), marks=pytest.mark.slow) for shape in SHAPES]


@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize(("shape", "seeds"), [(SHAPES[0], range(10)), *MANY])
def test_no_slide_on_a_random_map_gives_energy_back(
    shape: Shape, seeds: range, friction: float
) -> None:
    with sliding(rough(random_model(0, shape), friction)) as emitted:
        assert least(emitted, seeds, shape) > -BOUND


PULLED = "sp_anchor_pulled(map, config, state, amounts, stored_j, drawn_m);"
PLANTED: dict[str, Sequence[Fault]] = {
    "the object's pull the wrong way": [("+ state->object_n[k]", "- state->object_n[k]")],
    "the object's pull left out": [("+ state->object_n[k]", "")],
    "a way of more than twice": [("m_per_n = share", "m_per_n = (sp_real)2.5 * share")],
    "over the edge of a cell": [("*at = edge;", "*at = to;"),
                                ("*at = edge - (sp_real)1;", "*at = to;"),
                                (PULLED, "(void)amounts, (void)stored_j, (void)drawn_m;")],
    "the object's force added": [("felt_n[k] = -config", "felt_n[k] = felt_n[k] - config")],
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("fault", [None, *PLANTED])
def test_the_adversary_finds_a_planted_fault(fault: str | None) -> None:
    """Behind a stiff spring, which takes little by itself."""
    plan = rough(random_model(0), 0.0)
    stiff = (literal(plan.lateral.anchor.stick_npm), literal(np.float64(2e4)))
    with sliding(plan, [stiff, *(PLANTED[fault] if fault else [])]) as emitted:
        found = least(emitted, range(40))
    assert found < -100 * BOUND if fault else found > -BOUND
