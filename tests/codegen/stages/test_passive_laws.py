"""Rates by depth, flow, damage, a surface that recovers, hours: C, reference and trainer."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from support import small
from support.c.same_bits import require_same_bits

from springpot import Model
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.formulas import evaluate_curves, integrate_slopes, locate_on_curve
from springpot.codegen.model.passive import Damage, Memory, Start
from springpot.codegen.plan import list_headers
from springpot.codegen.reference import run_reference
from springpot.codegen.stages.passive.beside import bound_damage_slopes_n
from springpot.codegen.stages.passive.maxwell import group_branches
from springpot.codegen.stages.stage import SceneTicks
from springpot.host.native.scene_library import build_and_load
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.passive.passive_force import simulate_passive
from springpot.trainer.models.predict import predict_n

CURVE_N = np.linspace(0.5, 3.0, 9)
LAWS: dict[str, dict[str, Any]] = {
    "all": {"n_by_depth": 2, "rate_ratio": 16.0, "flow": small.flow(0.6), "recovers": True,
            "damage": small.damage(CURVE_N)},
    "rates": {"n_by_depth": 2, "rate_ratio": 16.0},
    "inverse": {"n_by_depth": 3, "rate_ratio": 1 / 16, "recovers": True},
    "flow": {"flow": small.flow(0.6)},
    "damage": {"damage": small.damage(CURVE_N)},
}  # fmt: skip


@cache
def model_of(kind: str, law: str, slow: bool = False) -> Model:
    fitted = small.small_model() if kind == "rf-fd" else small.passive_model()
    passive = fitted.hammerstein
    tau_s = np.array([0.01, 0.2, 2.0, 4e3 if slow else 0.05])  # above 1e5 ticks
    branch_n = np.linspace(0.1, 0.4, 4)[:, None] * CURVE_N
    stop_n = np.zeros((len(passive.radius_m), 9))
    changed = replace(
        passive, elastic_n=CURVE_N, tau_s=tau_s, branch_n=branch_n, stop_n=stop_n,
        recovers=False, n_by_depth=0, flow=None, damage=None,
    )  # fmt: skip
    changed = replace(changed, **LAWS[law])
    return replace(fitted, hammerstein=changed)


@pytest.mark.few(1)
@pytest.mark.parametrize("number", ["float32", "float64"])
@pytest.mark.parametrize("kind", ["hammerstein", "rf-fd"])
@pytest.mark.parametrize("slow", [True, False])
@pytest.mark.parametrize("law", LAWS)
def test_same_bits_as_the_reference(law: str, slow: bool, kind: str, number: str) -> None:
    position_m = np.concatenate([1.4 * small.press(2.0), small.press(3.0), np.full(200, 0.004)])
    position_m[300] = np.nan
    plan = make_plan(model_of(kind, law, slow), small.scene(number=number), accept_unsafe=True)
    require_same_bits(plan, position_m)


@pytest.mark.parametrize("slow", [False, True])
@pytest.mark.parametrize("law", LAWS)
def test_the_emitted_force_is_the_fitted_one(law: str, slow: bool) -> None:
    model = model_of("hammerstein", law, slow)
    plan = make_plan(model, small.scene(number="float64"), accept_unsafe=True)
    position_m = 0.9 * small.press(1.0)  # below the limit of the force
    force_n = run_reference(plan, position_m).force_n
    wanted_n = small.passive_force_n(model.hammerstein, position_m, small.DT_S, surface=True)
    contact = position_m > 0.02 * position_m.max()  # above it the onset fades the force in
    assert np.abs(force_n - wanted_n)[contact].max() < 1e-6 * wanted_n.max()


@pytest.mark.parametrize("number", ["float32", "float64"])
def test_what_is_remembered_at_the_start_is_in_the_c_whatever_the_order(number: str) -> None:
    """The memory of a slow branch is there too, and each curve of damage has its own."""
    model, forces_n = model_of("hammerstein", "all", slow=True), []
    law, deepest = model.hammerstein, np.array([0.9, 0.1, 0.3, 0.7])
    for order in ([0, 1, 2, 3], [0, 2, 1, 3]):
        damage = Damage(
            *(getattr(law.damage, its)[order] for its in ("heal_s", "power", "curve_n"))
        )
        branch_n, flow, play = np.array([0.5, 0.4, 0.3, 0.9]), np.array([0.1, 0.2]), law.radius_m
        memory = Memory(branch_n, flow, deepest[order], 0.1 + 0.0 * play, 0.3, 1.0)
        begun = replace(law, damage=damage, end_memory=memory, continues=True)
        plan = make_plan(replace(model, hammerstein=begun), small.scene(number=number), True)
        require_same_bits(plan, small.press(2.0))
        forces_n.append(run_reference(plan, small.press(2.0)).force_n)
    np.testing.assert_allclose(*forces_n, rtol=1e-5)


def state_after(model: Model, depth_m: np.ndarray) -> Model:
    """The model that continues after a motion, with a stop beside its law."""
    surface = model.contact == "surface"
    law = replace(
        model.hammerstein,
        radius_m=np.array([0.2 * small.DEPTH_M]),
        stop_n=CURVE_N[None],
        recovers=surface,
    )
    memory = simulate_passive(law, DepthMotion(depth_m, (0,), (0,)), small.DT_S, surface)[2]
    return replace(model, hammerstein=replace(law, end_memory=memory, continues=True))


@pytest.mark.parametrize("number", ["float32", "float64"])
@pytest.mark.parametrize("end", [1.0, 0.3, 0.0])
@pytest.mark.parametrize("contact", ["surface", "always"])
def test_a_start_that_continues_is_in_the_c(contact: str, end: float, number: str) -> None:
    """From where training ended, from afar, and after jumps that restart the history."""
    fitted = replace(model_of("hammerstein", "all", slow=True), contact=contact)
    end_m = end * small.DEPTH_M
    model = state_after(fitted, np.append(small.press(2.0), np.linspace(0.0, end_m, 300)))
    plan = make_plan(model, small.scene(number=number), True)
    assert (
        plan.stiffness_npm == make_plan(model.with_start("rested"), plan.scene, True).stiffness_npm
    )
    for begin_m in (end_m, 0.0, 0.6 * small.DEPTH_M, end_m + 1e-5, small.DEPTH_M):
        way_m = np.linspace(begin_m, 0.0, 200)
        position_m = np.concatenate([way_m, small.press(2.0), np.full(100, np.nan), way_m])
        require_same_bits(plan, position_m)


def test_without_a_surface_a_motion_from_afar_begins_at_rest() -> None:
    """From there the object would pull at the tool for a tick; near there it goes on."""
    fitted = replace(model_of("hammerstein", "all"), contact="always")
    model = state_after(fitted, small.press(2.0)[:250])  # ends pressed
    near_m, far_m = (np.full(200, share * small.DEPTH_M) for share in (1.0, 0.2))
    for position_m, continues in ((near_m, True), (far_m, False)):
        recording = small.recording("x", position_m)
        rested_n, started_n = (
            predict_n(model.with_start(start), recording) for start in ("rested", "continues")
        )
        assert model.continues_training(position_m) is continues
        assert np.array_equal(rested_n, started_n) is not continues
        plan = make_plan(model, small.scene(number="float64"), True)
        emitted_n = run_reference(plan, position_m).force_n[-1]
        assert emitted_n == pytest.approx(started_n[-1], rel=1e-6)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("start", ["rested", "continues"])
def test_no_hand_at_the_surface_is_pushed(start: Start, law: str) -> None:
    """Training that ended pressed, with or without a surface that recovers."""
    model = state_after(model_of("hammerstein", law, slow=True), small.press(2.0)[:250])
    for recovers in (True, False):
        passive = replace(model.hammerstein, recovers=recovers)
        started = replace(model, hammerstein=passive).with_start(start)
        assert np.abs(predict_n(started, small.recording("x", np.zeros(2000)))).max() < 1e-12
        plan = make_plan(started, small.scene(), True)
        assert not run_reference(plan, np.zeros(2000)).force_n.any()


@pytest.mark.parametrize("law", ["all", "damage", "flow"])
def test_no_piece_is_stiffer_than_the_surface_that_recovers_takes_it_for(law: str) -> None:
    model = model_of("hammerstein", law)
    passive = replace(model.hammerstein, recovers=True)
    nodes_m = passive.origin_m + passive.span_m * np.linspace(0.0, 1.0, passive.nodes)
    plan = make_plan(replace(model, hammerstein=passive), small.scene(number="float64"), True)
    rises_n = np.diff(small.passive_force_n(passive, nodes_m, small.DT_S, surface=True))
    assert np.all(rises_n <= plan.passive.surface.max_slope_n[:-1]) and rises_n.min() > 0.0


@pytest.mark.parametrize(("law", "share"), [("rates", 2e-3), ("inverse", 2e-3), ("all", 5e-3)])
def test_half_the_time_step_gives_nearly_the_same_force(law: str, share: float) -> None:
    passive = model_of("hammerstein", law).hammerstein
    fine_m = np.interp(np.arange(0, 1000, 0.5), np.arange(1000), small.press(1.0))
    coarse_n = small.passive_force_n(passive, small.press(1.0), small.DT_S, surface=True)
    fine_n = small.passive_force_n(passive, fine_m, small.DT_S / 2, surface=True)[::2]
    assert np.abs(coarse_n - fine_n).max() < share * coarse_n.max()


@pytest.mark.parametrize("power", [1, 3])
def test_a_straight_curve_of_damage_is_bound_by_its_steepest(power: int) -> None:
    straight = Damage(np.zeros(1), np.array([power]), np.ones((1, 9)))  # v (v/M)^power, at v = M
    np.testing.assert_allclose(bound_damage_slopes_n(straight), 1.0 + power)


def test_curves_are_straight_beyond_the_last_node() -> None:
    u = np.linspace(0.8, 1.5, 71)
    values = evaluate_curves(
        integrate_slopes(np.linspace(1.0, 2.0, 9)[None]), locate_on_curve(u, 9)
    )
    bends = np.diff(values[:, 0], 2)
    np.testing.assert_allclose(bends[u[1:-1] < 0.995], 1e-4)
    np.testing.assert_allclose(bends[u[1:-1] > 1.005], 0.0, atol=1e-12)


TICKS = (4e6, 2.4e7)


@cache
def slow_model(*ticks: float) -> Model:
    """A fitted model with these time constants, after a fast one."""
    model = small.passive_model()
    tau_s = np.array([ticks[0] * small.DT_S, 0.05, *(t * small.DT_S for t in ticks[1:])])
    branch_n = np.full((len(tau_s), len(model.hammerstein.elastic_n)), 0.2)
    return replace(model, hammerstein=replace(model.hammerstein, tau_s=tau_s, branch_n=branch_n))


@pytest.mark.few(1)
@pytest.mark.parametrize("ticks", TICKS)
def test_hours_of_relaxation_are_those_of_float64(ticks: float) -> None:
    model = slow_model(ticks, ticks)
    held_m = np.concatenate([small.press(1.0)[:500], np.full(400_000, small.press(1.0)[499])])
    drops_n = []
    for number in ("float32", "float64"):
        library = build_and_load(make_plan(model, small.scene(number=number), accept_unsafe=True))
        force_n = library.new_state().run(held_m)[0]
        drops_n.append(float(force_n[5000]) - float(force_n[-1]))
    assert drops_n[1] > 5e-3 and abs(drops_n[0] / drops_n[1] - 1) < 2e-3


@pytest.mark.parametrize(("ratio", "double"), [(3.0, False), (16.0, True), (1 / 16, True)])
def test_what_is_slow_at_one_depth_alone_is_kept_in_double(ratio: float, double: bool) -> None:
    passive = replace(slow_model(0.5e5).hammerstein, n_by_depth=2, rate_ratio=ratio)
    steps = group_branches(passive, SceneTicks(small.DT_S, np.float32))[0]
    assert any(step.double for step in steps) is double


@pytest.mark.slow
def test_only_slow_branches_bring_doubles() -> None:
    names = {
        limit: set(list_headers(make_plan(slow_model(limit), small.scene(), accept_unsafe=True)))
        for limit in (0.99e5, 1.01e5)
    }
    assert names[1.01e5] - names[0.99e5] == {"sp_slow_poles.h"}
