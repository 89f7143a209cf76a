"""A plan: its defaults, what cannot be done, and what comes beyond the trained depth."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from support.c.same_bits import require_same_bits
from support.small import DEPTH_M, fitted, model_file, passive_model, scene, small_model

from springpot import Scene
from springpot.codegen.errors import UnsafeError, UsageError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.notes import OUTSIDE
from springpot.codegen.proxy_motion import apply_onset_and_fade
from springpot.codegen.scene import Coupling, Guard, Runtime
from springpot.host.emission.emission import emit
from springpot.host.native.scene_library import SceneLibrary
from springpot.trainer.models.passive.growth import Growth, extrapolate_curves


def pressed(folder: Path, kind: str, outside: str) -> tuple[np.ndarray, np.ndarray, int]:
    """Depth, force and notes of a slow press to 1.3 x the trained depth and back."""
    model = fitted(kind, smooth_s=0.025)
    chosen = dataclasses.replace(
        scene(number="float64"), guard=Guard(outside=outside, max_force_n=1000.0)
    )
    emit(chosen, model_file(folder, model), folder / "c")
    down = np.linspace(0.0, 1.3 * DEPTH_M, 2000)
    motion = np.concatenate([down, down[::-1]])
    force_n, notes = SceneLibrary(folder / "c").new_state().run(motion)
    return motion, force_n, notes


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["rf-fd", "rbf-fd", "hammerstein"])
def test_force_goes_on_rising_beyond_the_trained_depth(tmp_path: Path, kind: str) -> None:
    motion, force_n, notes = pressed(tmp_path, kind, "fallback")
    assert notes & OUTSIDE
    border = int(np.searchsorted(motion[:2000], small_model().trained.max_m))
    steps = np.abs(np.diff(force_n[border - 3 : border + 4]))
    assert steps.max() < 0.05 * force_n[border]  # no jump at the border
    beyond = force_n[border + 5 : 2000]
    # The window fills with the clipped depth: a forest relaxes through it leaf by leaf.
    leaf_n = 0.001 * force_n[border] if kind == "rf-fd" else 0.0
    assert np.diff(beyond).min() > -leaf_n and beyond[-1] > 1.2 * beyond[0]


@pytest.mark.slow
def test_hold_stays_at_the_greatest_trained_depth(tmp_path: Path) -> None:
    motion, force_n, _ = pressed(tmp_path, "hammerstein", "hold")
    border = int(np.searchsorted(motion[:2000], small_model().trained.max_m))
    assert np.ptp(force_n[border + 5 : 2000]) < 0.1 * force_n[border]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["hammerstein", "rf-fd"])
def test_excess_takes_energy(tmp_path: Path, kind: str) -> None:
    motion, force_n, _ = pressed(tmp_path, kind, "fallback")
    outside = motion >= small_model().trained.max_m
    worked_j = np.trapezoid(force_n[outside], motion[outside])
    assert worked_j > -1e-9


def test_stiffness_beyond_the_force_that_leaves_is_not_felt() -> None:
    weak = dataclasses.replace(scene(), guard=Guard(max_force_n=0.2 * small_model().trained.max_n))
    felt, all_of_it = (make_plan(small_model(), its).stiffness_npm for its in (weak, scene()))
    assert felt < 0.8 * all_of_it


def test_an_object_that_stiffens_beyond_the_trained_depth_is_as_stiff_as_there() -> None:
    model, wide = passive_model(), dataclasses.replace(scene(), guard=Guard(max_force_n=1000.0))
    bent_n, found_npm = np.linspace(0.1, 9.0, len(model.hammerstein.elastic_n)), []
    flat = dataclasses.replace(model.hammerstein, elastic_n=bent_n, span_m=model.trained.max_m)
    for law in (flat, extrapolate_curves(flat, Growth(np.eye(4)[1], foretold=True))):
        plan = make_plan(dataclasses.replace(model, hammerstein=law), wide)
        found_npm.append(plan.stiffness_npm)
    assert found_npm[1] > 1.1 * found_npm[0]


def test_a_model_without_a_passive_part_holds_and_says_so() -> None:
    without = dataclasses.replace(small_model(), hammerstein=None)
    assert make_plan(without, scene()).outside.startswith("hold: the model has no passive part")


@pytest.mark.slow
def test_zero_ends_the_force_without_a_step_and_comes_back(tmp_path: Path) -> None:
    motion, force_n, notes = pressed(tmp_path, "hammerstein", "zero")
    assert notes & OUTSIDE
    trained_m = small_model().trained.max_m
    border, gone = (int(np.searchsorted(motion[:2000], s * trained_m)) for s in (1.0, 1.1))
    assert np.abs(np.diff(force_n)).max() < 0.05 * force_n[border]
    assert np.all(force_n[gone + 1 : len(motion) - gone - 1] == 0.0)
    assert force_n[-border] > 0.5 * force_n[border]


SCENE = Scene(schema=1, name="x", model="x")


def changed(**sections: object) -> Scene:
    return dataclasses.replace(SCENE, **sections)


def test_defaults_come_from_the_model() -> None:
    plan, trained = make_plan(small_model(), SCENE), small_model().trained
    assert plan.output.max_n == np.float32(1.2 * trained.max_n)
    assert plan.watchdog_s == np.float32(0.02)
    assert plan.onset_per_m == pytest.approx(1 / (0.01 * DEPTH_M), rel=1e-2)
    assert plan.guard.max_step_m >= np.float32(1e-3) and plan.coupling.why.startswith("off: auto")
    assert plan.outside.startswith("fallback: ")


def test_a_model_that_never_leaves_the_object_has_no_contact() -> None:
    model = dataclasses.replace(small_model(), contact="always")
    plan = make_plan(model, SCENE)
    assert plan.onset_per_m is None and "contact and onset" in [item.what for item in plan.left_out]
    assert make_plan(model, changed(guard=Guard(contact="surface"))).onset_per_m is not None


def test_what_cannot_be_done_is_refused() -> None:
    with pytest.raises(UsageError, match=r"runtime\.rate_hz = 500"):
        make_plan(small_model(), changed(runtime=Runtime(rate_hz=500)))
    unit_error = changed(coupling=Coupling(mode="tool", damping_nspm=2e4))
    with pytest.raises(UnsafeError, match="20 N s/m"):
        make_plan(small_model(), unit_error)
    assert make_plan(small_model(), unit_error, accept_unsafe=True).accept_unsafe


def test_a_force_fades_on_both_sides_of_the_trained_depth_behind_a_proxy_too() -> None:
    """Of an object that the tool never leaves: the C and its reference, bit for bit."""
    model = passive_model()
    trained = dataclasses.replace(model.trained, min_m=0.4 * DEPTH_M)
    chosen = dataclasses.replace(
        scene(mode="proxy"), guard=Guard(contact="always", outside="zero", max_force_n=50.0)
    )
    plan = make_plan(dataclasses.replace(model, trained=trained), chosen, accept_unsafe=True)
    motion = 0.5 * DEPTH_M - 0.5 * DEPTH_M * np.sin(np.linspace(0.0, 12.0, 2000))
    require_same_bits(plan, motion)
    pressed = np.array([0.1, 0.41, 0.7]).astype(np.float32) * np.float32(DEPTH_M)
    faded_n = apply_onset_and_fade(plan, pressed, np.ones(3, np.float32))
    assert faded_n[0] == 0.0 and faded_n[1] == faded_n[2] == 1.0
