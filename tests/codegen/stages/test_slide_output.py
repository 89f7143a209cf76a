"""What leaves of a slide: finite, within the limit, up no faster than the slew, however it turns.

An adversary slides to and fro over grids of any size and off them, loses samples, jumps along one
axis or to another place for good.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from codegen.stages.test_lateral import slid
from codegen.stages.test_sliding_energy import SPAN_M, placed, random_model
from support.small import scene

from springpot import ScenePlaces
from springpot.codegen.model.places import Places
from springpot.codegen.reference.lateral import run_lateral
from springpot.emission import Plan, make_plan
from springpot.native import built

CELLS = 8
LONGEST = 25  # ticks of a silence: some latch
JUMPS_M = (0.003, 0.05, 1.0, 1e9, np.inf)


def on_grid(step_m: float, friction: float, rate_hz: float, number: str) -> Plan:
    """A random material on a random map, with limits and account as they come."""
    model = random_model(3)
    passive = model.hammerstein
    rng = np.random.default_rng(10)
    size = (CELLS + 1, CELLS + 1, len(passive.places.slopes_n))
    amounts = rng.exponential(5.0, size) * (rng.uniform(size=size) < 0.6) + 0.01
    grid = Places(np.zeros(2), np.full(2, step_m), amounts / amounts.max(), passive.places.slopes_n)
    chosen = scene(number=number)
    return make_plan(
        placed(replace(passive, places=None), grid),
        replace(chosen, places=ScenePlaces("lateral", 8.0, friction),
                runtime=replace(chosen.runtime, rate_hz=rate_hz)),
    )  # fmt: skip


def adverse(seed: int, rate_hz: float, reach_m: float, ticks: int) -> np.ndarray:
    """x, y and depth, (n, 3), m."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(ticks) / rate_hz
    mps = rng.choice([0.1, 1.0])
    sides = [
        reach_m * (0.5 + 0.7 * np.sin(mps / reach_m * rng.uniform(1.0, 2.4) * time_s + phase))
        for phase in rng.uniform(0.0, 6.3, 2)
    ]
    depth_m = SPAN_M * (0.45 - 0.55 * np.cos(2 * np.pi * rng.uniform(2.0, 8.0) * time_s))
    position_m = np.column_stack([*sides, depth_m])
    for _ in range(6):
        begin = rng.integers(0, ticks)
        position_m[begin : begin + rng.integers(1, LONGEST)] = np.nan
    for _ in range(4):
        begin, axis = rng.integers(0, ticks), rng.integers(0, 3)
        position_m[begin : begin + rng.integers(1, 9), axis] += rng.choice(JUMPS_M)
    position_m[rng.integers(0, ticks) :, rng.integers(0, 2)] += 0.03
    return position_m


def growth_n(force_n: np.ndarray) -> np.ndarray:
    """How far each force is from what lies between 0 and the one before, (n - 1,), N."""
    before, after = force_n[:-1], force_n[1:]
    square = np.maximum(np.sum(before**2, axis=1), 1e-300)
    share = np.clip(np.sum(before * after, axis=1) / square, 0.0, 1.0)[:, None]
    found: np.ndarray = np.linalg.norm(after - share * before, axis=1)
    return found


@pytest.mark.parametrize(
    ("step_m", "friction", "rate_hz", "number"),
    [
        (5e-3, 0.3, 1000.0, "float32"),
        (5e-4, 5.0, 8000.0, "float64"),
        pytest.param(5e-4, 0.0, 1000.0, "float32", marks=pytest.mark.slow),
        pytest.param(5e-4, 5.0, 1000.0, "float32", marks=pytest.mark.slow),
        pytest.param(0.1, 5.0, 8000.0, "float32", marks=pytest.mark.slow),
        pytest.param(5e-3, 5.0, 100.0, "float64", marks=pytest.mark.slow),
    ],
)
def test_a_force_is_bounded_and_grows_no_faster_than_its_limit_whichever_way_it_turns(
    step_m: float, friction: float, rate_hz: float, number: Any
) -> None:
    plan = on_grid(step_m, friction, rate_hz, number)
    with built(plan) as library:
        for seed in range(12):
            position_m = adverse(seed, rate_hz, CELLS * step_m, 1200)
            force_n, notes = slid(library, position_m)
            if seed == 0:
                reference = run_lateral(plan, position_m)
                np.testing.assert_array_equal(force_n, reference.force_n)
                np.testing.assert_array_equal(notes, reference.notes)
            given_n = force_n.astype(np.float64)
            assert np.all(np.linalg.norm(given_n, axis=1) <= (1 + 1e-6) * plan.output.max_n)
            assert np.all(growth_n(given_n) <= (1 + 1e-5) * plan.output.slew_n)


def even(step_m: float, friction: float, rate_hz: float) -> Plan:
    """A map of one amount: its grid is nothing that a hand could feel."""
    plan = on_grid(step_m, friction, rate_hz, "float64")
    law = plan.model.hammerstein
    places = replace(law.places, amounts=np.full_like(law.places.amounts, 0.2))
    return make_plan(placed(replace(law, places=None), places), plan.scene)


def rubbed(rate_hz: float, mps: float) -> np.ndarray:
    """x, y and depth of a press, and of straight and oblique ways over and off a fine grid."""
    time_s = np.arange(0.0, 0.7, 1.0 / rate_hz)
    depth_m = np.interp(time_s, [0.0, 0.3, 0.6, 0.7], [-1e-4, 4e-3, 5e-3, -1e-4])
    way_m = mps * np.interp(time_s, [0.3, 0.33, 0.39, 0.6], [0.0, 0.03, -0.03, 0.0])
    position_m: np.ndarray = np.column_stack([2e-3 + way_m, 2e-3 + 0.7 * np.abs(way_m), depth_m])
    return position_m


@pytest.mark.parametrize("friction", [0.0, 0.3, 5.0])
@pytest.mark.parametrize("rate_hz", [100.0, 1000.0, 8000.0])
def test_the_grid_of_an_even_map_is_not_felt_at_any_speed(friction: float, rate_hz: float) -> None:
    coarse, mps = even(10.0, friction, rate_hz), 1.0
    position_m = rubbed(rate_hz, mps)
    with built(coarse) as library:
        expected_n, _ = slid(library, position_m)
    with built(even(5e-4, friction, rate_hz)) as library:
        force_n, _ = slid(library, position_m)
    assert np.abs(expected_n[:, :2]).max() > 0.05
    np.testing.assert_allclose(force_n, expected_n, atol=0.02 * np.abs(expected_n).max())


@pytest.mark.parametrize("friction", [0.3, 5.0])
def test_where_nothing_pushes_nothing_pulls_sideways(friction: float) -> None:
    """Dips of any size, fast and slow, also into a surface that has not yet come back."""
    plan, ticks = on_grid(5e-3, friction, 1000.0, "float64"), np.arange(600)
    slides = 0
    with built(plan) as library:
        for seed in range(100):
            rng = np.random.default_rng(seed)
            dips = np.sin(2 * np.pi * ticks / rng.uniform(40.0, 300.0))
            depth_m = rng.choice([1e-4, 1e-3, 4e-3]) * dips + rng.choice([-4e-4, 0.0, 2e-4])
            turns = np.sign(np.sin(ticks / rng.uniform(5.0, 60.0)))
            x_m = 0.02 + rng.uniform(0.0, 8e-4) * np.cumsum(turns)
            position_m = np.column_stack([x_m, np.full(len(ticks), 0.02), depth_m])
            force_n, _ = slid(library, position_m)
            pushes = force_n[:, 2] > 0
            assert not np.any(force_n[~pushes])
            slides += np.any(force_n[:, 0])
    assert slides > 50
