"""Recovery, numbers and scales: the force is right or safe whatever comes in."""

import dataclasses
import os

import numpy as np
import pytest
from support.paths import TESTS
from support.small import DEPTH_M, DT_S, fitted, press, scene

from springpot import Model
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import TrainedRange
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.native.c_library import load_c
from springpot.codegen.reference import run_reference
from springpot.codegen.scene import Coupling
from springpot.host.native.scene_library import SceneLibrary, build_and_load
from springpot.host.simulation.hand_loop import HAND_SUBSTEPS, Operator, held_tool
from springpot.host.simulation.objects import HAND_NAMES
from springpot.runtime_c.paths import PORT_TESTBENCH, SIM

# `make soak` asks for 24 simulated hours and 1e7 samples.
SOAK = bool(os.environ.get("SPRINGPOT_SOAK"))
PRESS_S = 24 * 3600.0 if SOAK else 600.0
DRIFT_TICKS = 10_000_000 if SOAK else 200_000
KINDS = ("rf-fd", "rbf-fd", "rbf-pv", "hammerstein")
# Of the peak force: how far float32 may be from float64 (docs/explanation/overview.md).
FLOAT32_SHARES = {
    "rf-fd": 1e-6, "hammerstein": 3e-6, "springpot": 1e-4, "rbf-pv": 2e-3, "rbf-fd": 5e-3,
}  # fmt: skip


def pressed(
    library: SceneLibrary, operator: Operator, ticks: int, dt_s: float, reach_m: float
) -> dict[str, float]:
    """Random presses; the members of random_presses."""
    here = TESTS / "support" / "c" / "random_presses.c"
    headers = [SIM / "sim.h", PORT_TESTBENCH / "sp_closed_loop.h", here.with_suffix(".h")]
    port = load_c(headers, [here, *sorted(SIM.glob("*.c"))], library.real)
    state = library.new_state()
    step, own = port.pointer(library.address("step")), port.pointer(state.address)
    scene = port.ffi.new("sp_closed_loop_scene *", {"step": step, "state": own})
    found = port.ffi.new("random_presses *")
    tool = held_tool(port, operator, HAND_SUBSTEPS, start_m=-0.001)
    assert port.c.press_at_random(scene, tool, ticks, dt_s, reach_m, operator.seed, found) >= 0
    return {name: getattr(found, name) for name, _ in port.ffi.typeof("random_presses").fields}


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mode", ["off", "proxy"])
def test_the_force_is_right_again_within_the_stated_ticks(kind: str, mode: str) -> None:
    """A burst of everything, then a clean motion: as a run that never saw the burst."""
    plan = make_plan(fitted(kind), scene(mode=mode))
    rng = np.random.default_rng(1)
    clean = np.concatenate([press(2.0), press(1.0), press(2.0, 0.5 * DEPTH_M, 4)])
    dirty = clean.copy()
    begin, end = 600, 618  # shorter than the watchdog waits
    dirty[begin:end] = rng.choice([np.nan, np.inf, -np.inf, 1e30, 1e-42, 0.05], end - begin)
    library = build_and_load(plan)
    right_n, _ = library.new_state().run(clean)
    found_n, _ = library.new_state().run(dirty)
    assert np.all(np.isfinite(found_n))
    back = end + plan.recovery_ticks
    assert back < len(clean) - 500
    np.testing.assert_allclose(found_n[back:], right_n[back:], atol=0.02 * right_n.max())


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "share"), list(FLOAT32_SHARES.items()))
def test_float32_stays_beside_float64(kind: str, share: float) -> None:
    """Long motion in both, and no drift.

    Where a tie decides, at one tick in twenty at most, the forces may be those of neighbouring
    leaves or windows.
    """
    model = fitted(kind)
    # The motion stays inside, where a surface that recovers changes nothing.
    model = dataclasses.replace(
        model, hammerstein=dataclasses.replace(model.hammerstein, recovers=False)
    )
    peak_n = model.trained.max_n
    hz, amplitude_m = np.array([0.31, 0.83, 2.7, 6.1]), 0.13 * DEPTH_M
    phases = np.random.default_rng(2).uniform(0, 6, 4)
    plans = [make_plan(model, scene(number=n), accept_unsafe=True) for n in ("float32", "float64")]
    chunk, errors = min(100_000, DRIFT_TICKS // 4), []
    single, double = build_and_load(plans[0]), build_and_load(plans[1])
    one, other = single.new_state(), double.new_state()
    for begin in range(0, DRIFT_TICKS, chunk):
        time_s = np.arange(begin, begin + chunk)[:, None] * DT_S
        wave = np.sin(2 * np.pi * hz * time_s + phases).sum(axis=1)
        motion = (0.45 * DEPTH_M + amplitude_m * wave).astype(np.float32)
        difference = np.abs(one.run(motion)[0] - other.run(motion.astype(np.float64))[0])
        most_n = np.quantile(difference, 0.95)
        assert most_n <= share * peak_n, begin
        errors.append(float(np.sqrt(np.mean(difference[difference <= most_n] ** 2))))
    tenth = max(1, len(errors) // 10)
    assert np.mean(errors[-tenth:]) < 3.0 * np.mean(errors[:tenth]) + 1e-7 * peak_n


@pytest.mark.parametrize("stiffness_npm", [10.0, 1e3, 1e5])
@pytest.mark.parametrize("depth_m", [1e-6, 1e-3, 1.0])
@pytest.mark.parametrize("dt_s", [1.25e-4, 1e-3, 1e-2])
def test_scales_of_a_micrometre_to_a_metre(
    stiffness_npm: float, depth_m: float, dt_s: float
) -> None:
    """A spring of any size: forces from 10 uN on are exact to float32, up to a scene's 10 kN."""
    peak_n = stiffness_npm * depth_m
    spring = Hammerstein(
        origin_m=0.0, span_m=depth_m, elastic_n=np.array([peak_n]),
        tau_s=np.array([20 * dt_s]), branch_n=np.array([[0.5 * peak_n]]),
        radius_m=np.zeros(0), stop_n=np.zeros((0, 1)), bias_n=0.0,
    )  # fmt: skip
    trained = TrainedRange(0.0, depth_m, 0.02 * depth_m / dt_s, 0.0, 1.5 * peak_n)
    model = Model("hammerstein", "x", dt_s, "surface", trained, None, None, spring, True)
    motion = 0.5 * depth_m * (1 - np.cos(np.arange(2000) * 2 * np.pi / 500))
    forces = []
    for number in ("float32", "float64"):
        options = scene(number=number)
        guard = dataclasses.replace(options.guard, max_force_n=min(1e4, 2 * peak_n))
        plan = make_plan(model, dataclasses.replace(options, guard=guard))
        forces.append(run_reference(plan, motion).force_n.astype(np.float64))
    np.testing.assert_allclose(forces[0], forces[1], atol=2e-5 * peak_n)
    assert forces[1].max() > 0.9 * min(peak_n, 1e4) and forces[1].max() <= min(2.0 * peak_n, 1e4)


@pytest.mark.few(1)
@pytest.mark.parametrize("hand", HAND_NAMES)
@pytest.mark.parametrize("mode", ["off", "auto-stiff"])
def test_hours_of_pressing_give_no_energy_and_do_not_drift(hand: str, mode: str) -> None:
    """The bound, stated before the run: a force held for a tick lags half a tick behind the motion.

    Over a press in and out to the maximum depth, at the maximum speed, that is at most
    2 x 1/2 K (v dt) x depth of energy, with K the stiffness felt; twice that with the sensors.
    """

    model, chosen = fitted("hammerstein"), scene()
    if mode == "auto-stiff":
        model = model.stiffened(10.0)
        chosen = dataclasses.replace(chosen, coupling=Coupling())
    plan = make_plan(model, chosen)
    depth_m = float(plan.range.max_m)
    reach_m = depth_m + 8.0 / {"mid": 400.0, "firm": 5000.0, "light": 50.0}[hand]
    max_mps = 1.5 * reach_m / 0.1  # a stroke of 0.1 s
    bound_j = 2.0 * plan.coupling.felt_npm * max_mps * plan.dt_s * 1.3 * reach_m
    library, ticks = build_and_load(plan), round(PRESS_S / plan.dt_s)
    found = pressed(library, Operator(hand), ticks, plan.dt_s, reach_m)
    assert found["not_finite"] == 0 and found["latched"] == 0
    assert found["presses"] > 0.1 * PRESS_S and found["max_returned_j"] <= bound_j
    assert found["max_taken_j"] > (1e-4 if mode == "auto-stiff" else 1e-3)
    assert found["last_n"] == pytest.approx(found["first_n"], rel=0.05 if SOAK else 0.25)
