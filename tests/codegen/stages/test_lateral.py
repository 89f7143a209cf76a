"""The lateral force: bits of C and reference, where the place is, what is refused and left out.

That it gives no energy: test_sliding_energy.py.
"""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from codegen.stages.test_placed import placed, with_places
from support.small import DEPTH_M, passive_model, press, scene, wandering

from springpot import Coupling, Guard, Model, ScenePlaces, Smoothing, UsageError
from springpot.codegen.emit.files import emit_files
from springpot.codegen.reference.lateral import run_lateral
from springpot.codegen.reference.notes import CLAMPED, HELD, LATCHED, OUTSIDE, RESYNC
from springpot.emission import Plan, make_plan, state_bytes
from springpot.native import SceneLibrary, built

SLIDING = replace(scene(number="float64"), places=ScenePlaces("lateral", 8.0))
MIDDLE_M = (0.005, 0.0)
STEP_M = (0.01, 0.02)  # of the grid of `placed`
# In float32 the second is kept in double.
SLOW: dict[str, Any] = {"tau_s": np.array([0.01, 50.0, 2.0]), "n_by_depth": 1, "rate_ratio": 16.0}


@cache
def plan_of(number: str = "float64", friction: float = 0.0) -> Plan:
    places = replace(SLIDING.places, friction=friction)
    return make_plan(slow(), replace(SLIDING, runtime=scene(number=number).runtime, places=places))


def slow() -> Model:
    model = placed("plain", 2)
    return replace(model, hammerstein=replace(model.hammerstein, **SLOW))


def slid(library: SceneLibrary, position_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Forces, (n, 3), and notes, from a fresh state."""
    state = library.new_state()
    forces, notes = zip(*(state.step3(at) for at in position_m), strict=True)
    return np.array(forces, dtype=library.dtype), np.array(notes)


def at_depth(depth_m: np.ndarray, x_m: Any = MIDDLE_M[0], y_m: Any = MIDDLE_M[1]) -> np.ndarray:
    """Positions, (n, 3)."""
    return np.column_stack(np.broadcast_arrays(x_m, y_m, depth_m))


@pytest.mark.parametrize("number", ["float32", "float64"])
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_same_bits_as_the_reference(number: str, friction: float) -> None:
    plan = plan_of(number, friction)
    depth_m = np.concatenate([1.2 * press(6.0), wandering(3)[:100], press(6.0), np.zeros(5)])
    turn = 12.0 * np.arange(len(depth_m)) / len(depth_m)
    position_m = at_depth(depth_m, 0.01 + 0.015 * np.sin(turn), 0.012 * np.cos(turn))
    position_m[270:, 0] += 0.3
    position_m[100:103, 1] = np.nan
    position_m[150] = 5e3
    position_m = np.concatenate([position_m, np.full((40, 3), np.nan), position_m[-3:]])
    with built(plan) as library:
        assert library.selftest() == 0
        assert library.state_bytes == state_bytes(plan)
        force_n, notes = slid(library, position_m)
    reference = run_lateral(plan, position_m)
    np.testing.assert_array_equal(force_n, reference.force_n)
    np.testing.assert_array_equal(notes, reference.notes)
    assert np.bitwise_or.reduce(notes) & (HELD | RESYNC | OUTSIDE | LATCHED) >= 39
    assert np.ptp(force_n, axis=0).min() > 0.1


def test_without_the_key_nothing_of_it_is_emitted() -> None:
    for model in (passive_model(), placed("plain", 2)):
        text = " ".join(emit_files(make_plan(model, scene())).values())
        assert not {"lateral", "step3", "idle3", "sp_stored", "golden_slid"} & set(text.split())
        assert "lateral" not in text.replace("lateral force", "")
        assert ("sp_place" in text) == (model is not passive_model())
    with built(make_plan(passive_model(), scene())) as library:
        with pytest.raises(UsageError, match="lateral"):
            library.new_state().step3(np.array([0.0, 0.0, DEPTH_M]))
        with pytest.raises(UsageError, match="map"):
            library.new_state().place((0.0, 0.0))


@cache
def even() -> Plan:
    """A map of one amount, of a material with a slow branch."""
    model = placed("plain", 1)
    places = replace(model.hammerstein.places, amounts=np.ones((3, 2, 1)))
    law = replace(with_places(model.hammerstein, places), recovers=True)
    return make_plan(replace(model, hammerstein=law), SLIDING)


def test_pressed_straight_into_a_map_of_one_amount_it_is_one_place() -> None:
    depth_m = press(2.0)
    with built(even()) as library:
        force_n, _ = slid(library, at_depth(depth_m))
        held_n, _ = library.new_state().run(depth_m)
    assert not np.any(force_n[:, :2])
    np.testing.assert_allclose(force_n[:, 2], held_n, atol=1e-12 * held_n.max())


def test_fresh_ground_is_stiffer_and_drags() -> None:
    depth_m = np.concatenate([press(2.0)[:250], np.full(3000, DEPTH_M)])
    x_m = np.concatenate([np.zeros(2250), np.linspace(0.0, 0.015, 1000)])
    with built(even()) as library:
        stays, _ = slid(library, at_depth(depth_m, 0.002))
        slides, _ = slid(library, at_depth(depth_m, 0.002 + x_m))
    assert slides[-1, 2] > 1.05 * stays[-1, 2]
    assert slides[-1, 0] < -0.01 * slides[-1, 2]
    assert abs(slides[-1, 1]) < 1e-9


def test_beyond_the_map_its_edge_is_felt_and_no_lateral_force() -> None:
    with built(plan_of()) as library:
        force_n, notes = slid(library, at_depth(press(2.0), -0.001, 0.02))
        edge_n, _ = slid(library, at_depth(press(2.0), 0.0, 0.01))
    pressed = slice(50, 450)
    assert not np.any(force_n[:, :2])
    np.testing.assert_allclose(force_n[pressed, 2], edge_n[pressed, 2], rtol=0.1)
    assert np.all(notes[pressed] & OUTSIDE)


def test_a_dent_is_met_again_where_it_is_and_not_elsewhere() -> None:
    away = np.full(20, -1e-4)
    pressed, pause = press(2.0), np.linspace(0.0, 1.0, len(away))
    again = slice(len(pressed) + len(away), None)
    found = []
    for steps, before in ((0.1, pressed), (0.5, pressed), (0.5, np.full(len(pressed), -1e-4))):
        ways = np.concatenate([np.zeros(len(pressed)), pause, np.ones(len(pressed))])
        depth_m = np.concatenate([before, away, pressed])
        position_m = at_depth(depth_m, MIDDLE_M[0] - steps * STEP_M[0] * ways)
        with built(plan_of()) as library:
            found.append(slid(library, position_m)[0][again])
    near, far, fresh = found
    np.testing.assert_array_equal(far, fresh)
    touched = [int(np.argmax(force_n[:, 2] > 0)) for force_n in (near, fresh)]
    assert touched[0] > touched[1] + 5


def test_limits_are_of_the_length_of_the_force() -> None:
    guard = replace(SLIDING.guard, max_force_n=0.5)
    plan = make_plan(slow(), replace(SLIDING, guard=guard))
    with built(plan) as library:
        force_n, notes = slid(library, at_depth(press(2.0)))
    length_n = np.linalg.norm(force_n, axis=1)
    assert length_n.max() == pytest.approx(0.5, rel=1e-12)
    assert np.any(notes & CLAMPED)


def test_silence_in_three_axes_ends_as_in_one() -> None:
    plan = plan_of()
    with built(plan) as library:
        state = library.new_state()
        before = [state.step3(at)[0] for at in at_depth(press(2.0)[:200])][-1]
        held, notes = state.idle3(plan.dt_s)
        assert (held, notes) == (before, HELD)
        assert state.idle3(1.0) == ((0.0, 0.0, 0.0), LATCHED)
        with pytest.raises(UsageError, match="dt_s"):
            state.idle3(float("nan"))


@pytest.mark.parametrize(
    ("changed", "word"),
    [
        ({"coupling": Coupling(mode="proxy")}, "coupling"),
        ({"smoothing": Smoothing(0.01)}, "smoothing"),
        ({"places": ScenePlaces("lateral")}, "tip_radius_mm"),
        ({"guard": Guard(outside="zero")}, "outside"),
        ({"guard": Guard(contact="always")}, "surface"),
    ],
)
def test_a_scene_that_has_no_three_axes_is_refused(changed: dict[str, Any], word: str) -> None:
    with pytest.raises(UsageError, match=word):
        make_plan(slow(), replace(SLIDING, **changed))


def test_a_model_of_which_it_is_not_known_what_it_has_stored_is_refused() -> None:
    for model, word in ((passive_model(), "map"), (placed("all", 2), "damage")):
        with pytest.raises(UsageError, match=word):
            make_plan(model, SLIDING)
