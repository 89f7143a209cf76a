"""A map of places: bits of C and reference, what is emitted, and that no energy is gained."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from support.c.same_bits import checked_library
from support.small import damage, flow, passive_model, press, scene, wandering

from springpot import Model, Recording
from springpot.codegen.emit.golden import differentiate
from springpot.codegen.errors import DataError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model_file import model_bytes
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.model.places import Places, interpolate_amounts
from springpot.codegen.plan import state_bytes
from springpot.codegen.reference import run_reference
from springpot.host.native.scene_library import SceneLibrary, build_and_load
from springpot.trainer.models.predict import predict_n

SOFT, STIFF = (0.0, -0.01), (0.01, 0.01)
CURVE_N = np.linspace(0.5, 3.0, 9)
RICH: dict[str, Any] = {
    "n_by_depth": 1, "rate_ratio": 16.0, "flow": flow(0.6), "damage": damage(CURVE_N),
    "recovers": True,
}  # fmt: skip
LAWS: dict[str, dict[str, Any]] = {"plain": {}, "all": RICH}


@cache
def placed(law: str = "plain", materials: int = 2, seed: int = 0) -> Model:
    """Model of 3 x 2 nodes with random amounts."""
    fitted, rng = passive_model(), np.random.default_rng(seed)
    tau_s = np.array([0.01, 0.2, 2.0])
    passive = replace(
        fitted.hammerstein, elastic_n=CURVE_N, tau_s=tau_s, recovers=False,
        branch_n=np.linspace(0.1, 0.4, 3)[:, None] * CURVE_N,
        radius_m=np.array([2e-4]), stop_n=0.1 * CURVE_N[None], flow=None, damage=None, n_by_depth=0,
    )  # fmt: skip
    passive = replace(passive, **LAWS[law])
    slopes_n = passive.slopes_n * rng.uniform(0.2, 1.0, (materials, passive.slopes_n.size))
    amounts = rng.uniform(0.2, 2.0, (3, 2, materials))
    places = Places(np.array([0.0, -0.01]), np.array([0.01, 0.02]), amounts, slopes_n)
    return replace(fitted, hammerstein=with_places(passive, places))


def with_places(passive: Hammerstein, places: Places) -> Hammerstein:
    return replace(passive.with_slopes(places.most_n), places=places)


def of_place(passive: Hammerstein, place_m: tuple[float, float]) -> Hammerstein:
    places = passive.places
    amount = interpolate_amounts(
        places.amounts, places.first_m, 1.0 / places.step_m, np.array(place_m)
    )
    return passive.with_slopes(amount @ places.slopes_n)


def called(
    library: SceneLibrary, position: np.ndarray, velocity: np.ndarray, places: list[Any]
) -> tuple[np.ndarray, np.ndarray]:
    """Forces and notes of ticks, with sp_place before some of them."""
    state, at = library.new_state(), dict(places)
    found = []
    for tick, (x, v) in enumerate(zip(position, velocity, strict=True)):
        if tick in at:
            state.place(at[tick])
        found.append(state.step(float(x), float(v)))
    forces, notes = zip(*found, strict=True)
    return np.array(forces, dtype=position.dtype), np.array(notes)


@pytest.mark.few(1)
@pytest.mark.parametrize("number", ["float32", "float64"])
@pytest.mark.parametrize(
    ("law", "materials", "mode"), [("plain", 1, "off"), ("all", 3, "off"), ("plain", 2, "proxy")]
)
def test_same_bits_as_the_reference(law: str, materials: int, mode: str, number: str) -> None:
    plan = make_plan(placed(law, materials), scene(number=number, mode=mode), accept_unsafe=True)
    position = np.concatenate([1.2 * press(4.0), wandering(3)[:400], *[press(8.0)] * 12])
    position[130:134] = np.nan
    position = position.astype(plan.dtype)
    velocity, rng = differentiate(position, plan.dt_s), np.random.default_rng(1)
    ticks = [100, 300, *range(640, len(position) - 125, 125)]  # most of them just before a press
    corners = [*map(tuple, rng.uniform(-0.02, 0.03, (12, 2)).tolist()), (0.02, 0.01), (9.0, 9.0)]
    places, library = list(zip(ticks, corners, strict=True)), checked_library(plan)
    assert library.state_bytes == state_bytes(plan)
    force_n, notes = called(library, position, velocity, places)
    reference = run_reference(plan, position, places=places)
    np.testing.assert_array_equal(force_n, reference.force_n)
    np.testing.assert_array_equal(notes, reference.notes)
    alone = run_reference(plan, position)
    assert np.any(alone.force_n != reference.force_n)


@pytest.mark.parametrize("there", [STIFF, (STIFF[0], SOFT[1]), (SOFT[0], STIFF[1])])
def test_a_place_is_taken_once_the_tool_is_off_the_object(there: tuple[float, float]) -> None:
    plan = make_plan(placed(), scene(number="float64"))
    again = np.concatenate([np.zeros(20), press(1.0)])
    position, library = np.concatenate([press(1.0), again]), build_and_load(plan)
    velocity = differentiate(position, plan.dt_s)
    before, _ = called(library, position, velocity, [(0, SOFT)])
    later, _ = called(library, position, velocity, [(0, SOFT), (len(press(1.0)) // 2, there)])
    fresh, _ = called(library, again, differentiate(again, plan.dt_s), [(0, there)])
    half = len(press(1.0))
    np.testing.assert_array_equal(later[:half], before[:half])
    np.testing.assert_array_equal(later[half:], fresh)


def test_a_reset_keeps_the_place() -> None:
    plan = make_plan(placed(), scene(number="float64"))
    position, library = np.concatenate([np.zeros(20), press(1.0)]), build_and_load(plan)
    fresh, _ = called(library, position, differentiate(position, plan.dt_s), [(0, SOFT)])
    state = library.new_state()
    state.place(SOFT)
    state.run(position[:200], np.zeros(200))
    state.reset()
    np.testing.assert_array_equal(state.run(position, np.zeros(len(position)))[0], fresh)


def test_the_emitted_force_is_that_of_the_place() -> None:
    model = placed("all", 2)
    model = replace(model, hammerstein=replace(model.hammerstein, recovers=False))
    here, position = (0.013, 0.002), press(2.0)
    one_place = replace(model, hammerstein=of_place(model.hammerstein, here))
    forces = [
        run_reference(make_plan(each, scene(number="float64")), position, places=places).force_n
        for each, places in ((model, [(0, here)]), (one_place, []))
    ]
    np.testing.assert_allclose(forces[0], forces[1], atol=1e-12 * forces[1].max())


def test_a_prediction_at_a_place_is_the_emitted_force() -> None:
    model, here, position = placed("all", 2), (0.013, 0.002), 1.3 * press(2.0)
    plan = make_plan(model, scene(number="float64"))
    emitted_n = plan.passive.reference(position, np.array([0]), [(0, here)])
    recording = Recording(
        "pad", position, np.zeros(len(position)), plan.dt_s, place_x_m=here[0], place_y_m=here[1]
    )
    predicted_n = predict_n(model, recording)
    assert position.max() > 1.2 * model.trained.max_m
    np.testing.assert_allclose(predicted_n, emitted_n, atol=1e-12 * emitted_n.max())


def test_limits_and_coupling_are_those_of_the_stiffest_place() -> None:
    model = placed()
    place_m = model.hammerstein.places.stiffest_m
    stiffest = replace(model, hammerstein=of_place(model.hammerstein, place_m))
    assert make_plan(model, scene()).stiffness_npm >= make_plan(stiffest, scene()).stiffness_npm


@pytest.mark.parametrize(
    ("field", "value"),
    [("amounts", -np.ones((3, 2, 2))), ("step_m", np.array([0.0, 1.0])),
     ("amounts", 9.0 * np.ones((3, 2, 2))), ("amounts", np.ones((1, 2, 2)))],
)  # fmt: skip
def test_a_map_that_would_not_be_passive_is_no_model(field: str, value: np.ndarray) -> None:
    law = placed().hammerstein
    one_n = law.slopes_n * np.where(np.arange(law.slopes_n.size) == 2, 0.9, 1.0)
    for wrong in (
        replace(law, places=replace(law.places, **{field: value})),
        replace(law.with_slopes(one_n), places=law.places),
    ):
        with pytest.raises(DataError, match="places"):
            model_bytes(replace(placed(), hammerstein=wrong))


def min_work(model: Model, position: np.ndarray, taken: list[Any]) -> float:
    """Least work until any tick off the object, over peak force x depth."""
    passive = make_plan(model, scene(number="float64")).passive
    force_n = passive.reference(np.maximum(position, 0.0), np.array([0]), taken)
    force_n = np.where(position > 0, force_n, 0.0)
    work_j = np.cumsum(0.5 * (force_n[1:] + force_n[:-1]) * np.diff(position))
    return float(work_j[position[1:] <= 0].min() / (force_n.max() * position.max()))


def min_work_of(seed: int) -> float:
    """Least work of presses at random places of a random map."""
    rng = np.random.default_rng(seed)
    model = placed(("plain", "all")[seed % 2], 1 + seed % 3, seed)
    legs = [[*rng.uniform(0, model.trained.max_m, 2).tolist(), 0.0, -1e-4] for _ in range(6)]
    corners = np.array([0.0, *(x for leg in legs for x in leg)])
    ways = np.arange(60 * (len(corners) - 1)) / 60
    position = np.interp(ways, np.arange(len(corners)), corners)
    free = rng.choice(np.flatnonzero(position <= 0)[1:], 6, replace=False).tolist()
    places = map(tuple, rng.uniform(-0.01, 0.03, (6, 2)).tolist())
    return min_work(model, position, [(0, (0.0, 0.0)), *zip(free, places, strict=True)])


HUNDREDS = [range(k, k + 200) for k in range(1000, 2000, 200)]


@pytest.mark.few(1, 3)
@pytest.mark.parametrize("seeds", [range(20), *HUNDREDS])
def test_no_press_at_any_places_gives_energy_back(seeds: range) -> None:
    assert min(map(min_work_of, seeds)) > -1e-5


def test_a_place_that_changed_in_contact_would_give_energy_back() -> None:
    model, amounts = placed(), np.full((3, 2, 2), 0.2)
    amounts[2, 1] = 2.0
    harder = with_places(model.hammerstein, replace(model.hammerstein.places, amounts=amounts))
    position = np.concatenate([press(1.0), [-1e-4, -1e-4]])
    taken = [(0, (0.0, -0.01)), (int(np.argmax(position)), (0.02, 0.01))]
    assert min_work(replace(model, hammerstein=harder), position, taken) < -1e-2
