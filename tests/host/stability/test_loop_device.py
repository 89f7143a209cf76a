"""The scene's own device in the checks: the linear loop's limit is where the C's loop rings."""

import math
from typing import Any

import numpy as np
import pytest
from truth import SimulatedHand

from springpot import Model, Scene, SpringpotError
from springpot.codegen.coupling.linear_loop import HAND_MODELS, Hand
from springpot.codegen.coupling.loop_device import ASSUMED_DEVICE, LoopDevice, build_loop_device
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import TrainedRange
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.plan import Plan
from springpot.codegen.scene import Coupling, Device, Runtime
from springpot.host.native.scene_library import build_and_load
from springpot.host.simulation.hand_loop import HandLoop, Operator, Scenario
from springpot.host.simulation.scenarios import Workspace, minimum_jerk_rise, press_scenario
from springpot.host.stability.check import stability
from springpot.host.stability.linear import scene_loop

SPAN_M = 0.02
RISEN_S, KICK_S, END_S = 0.3, 0.6, 3.0
WITHIN = 1.15
# An encoder fine enough for its steps not to ring by themselves.
DEVICES = (
    (1000.0, Device(resolution_um=1.0)),
    (1000.0, Device(mass_kg=0.05, viscous_nspm=0.5, resolution_um=1.0)),
    (4000.0, Device(mass_kg=0.05, viscous_nspm=0.5, delay_s=0.001, resolution_um=1.0)),
    (1000.0, Device(mass_kg=1.0, viscous_nspm=8.0, delay_s=0.005, resolution_um=1.0)),
    (4000.0, Device(mass_kg=0.2, viscous_nspm=2.0, delay_s=0.0025, resolution_um=1.0)),
    (1000.0, Device(mass_kg=0.2, viscous_nspm=8.0, delay_s=0.0013, resolution_um=1.0)),
    (4000.0, Device(mass_kg=1.0, viscous_nspm=0.5, delay_s=0.005, resolution_um=1.0)),
)
OFF, TOOL = Coupling(mode="off"), Coupling("tool", 4000.0, 10.0, 0.05)
# With each device a hand; all of them with all, and a coupling, among the slow tests.
CHOSEN = [(at, HAND_MODELS[at % 3], OFF) for at in range(len(DEVICES))]
OTHERS = [(at, hand, OFF) for at in range(len(DEVICES)) for hand in HAND_MODELS
          if (at, hand, OFF) not in CHOSEN]  # fmt: skip
OTHERS += [(at, HAND_MODELS[0], TOOL) for at in (0, 1, 4)]


def elastic_plan(
    stiffness_npm: float, rate_hz: float, device: Device, coupling: Coupling = OFF
) -> Plan:
    """A linear spring in a scene with that device."""
    max_n = stiffness_npm * SPAN_M
    spring = Hammerstein(
        origin_m=0.0, span_m=SPAN_M, elastic_n=np.array([max_n]), tau_s=np.zeros(0),
        branch_n=np.zeros((0, 1)), radius_m=np.zeros(0), stop_n=np.zeros((0, 1)), bias_n=0.0,
    )  # fmt: skip
    trained = TrainedRange(0.0, SPAN_M, 2.0, 0.0, max_n)
    model = Model("hammerstein", "spring", 1.0 / rate_hz, "surface", trained, None, None, spring,
                  True)  # fmt: skip
    return make_plan(
        model,
        Scene(schema=1, name="spring", model="x", runtime=Runtime(rate_hz, "float64"),
              coupling=coupling, device=device),
        accept_unsafe=True,
    )  # fmt: skip


def rings(plan: Plan, hand: Hand) -> bool:
    """Whether the speed grows after the hand pushed for 2 ms, in the C's closed loop."""
    time_s = np.arange(round(END_S / plan.dt_s)) * plan.dt_s
    at_m = 0.5 * SPAN_M
    held_n = plan.stiffness_npm * at_m
    intended_m = (at_m + held_n / hand.stiffness_npm) * minimum_jerk_rise(time_s / RISEN_S)
    kicked = (time_s >= KICK_S) & (time_s < KICK_S + 0.002)
    intended_m[kicked] += 0.08 * held_n / hand.stiffness_npm
    n = len(time_s)
    scenario = Scenario(np.full(n, plan.dt_s), intended_m, np.full(n, np.nan), np.zeros(n),
                        np.zeros(n, dtype=np.uint8))  # fmt: skip
    trace = HandLoop(build_and_load(plan)).run(scenario, Operator(hand.name, plan.loop_device))
    speed_mps = np.abs(trace.velocity_mps)
    first = speed_mps[(time_s > KICK_S + 0.1) & (time_s < KICK_S + 0.8)].max()
    return bool(speed_mps[time_s > END_S - 0.7].max() > first)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("at", "hand", "coupling"),
    [*CHOSEN, *(pytest.param(*item, marks=pytest.mark.slow) for item in OTHERS)],
)
def test_the_loop_of_the_c_rings_from_the_predicted_stiffness_on(
    at: int, hand: Hand, coupling: Coupling
) -> None:
    rate_hz, device = DEVICES[at]

    def plan(stiffness_npm: float) -> Plan:
        return elastic_plan(stiffness_npm, rate_hz, device, coupling)

    limit_npm = scene_loop(plan(1000.0), hand).max_stiffness_npm()
    assert 150.0 < limit_npm < 1e5 and not rings(plan(limit_npm / WITHIN), hand)
    assert rings(plan(limit_npm * WITHIN), hand)


@pytest.mark.parametrize(
    ("delay_s", "rate_hz", "ticks"),
    [(0.0, 1000.0, 0), (1e-9, 1000.0, 0), (1e-5, 1000.0, 1), (0.001, 1000.0, 1), (0.003, 1e4, 30),
     (0.0013, 1000.0, 2), (0.007, 4000.0, 28), (0.02, 8000.0, 160)],
)  # fmt: skip
def test_a_delay_is_rounded_up_to_ticks(delay_s: float, rate_hz: float, ticks: int) -> None:
    assert build_loop_device(Device(delay_s=delay_s), 1.0 / rate_hz).delay_samples == ticks


def test_auto_couples_for_the_scenes_device() -> None:
    """A light device without friction stands less: the same object needs a softer proxy."""
    auto = Coupling()
    plans = [
        elastic_plan(stiffness_npm, 1000.0, device, auto)
        for stiffness_npm in (4000.0, 40_000.0)
        for device in (Device(), Device(mass_kg=0.05, viscous_nspm=0.5, delay_s=0.001))
    ]
    modes = [plan.coupling.coupling.mode for plan in plans]
    assert modes == ["off", "proxy", "proxy", "proxy"]
    assert plans[3].coupling.felt_npm < plans[2].coupling.felt_npm


def held(device: LoopDevice, intended_m: float, force_n: float, ticks: int) -> list[float]:
    """Positions of a mid hand at 1 kHz that intends to be at intended_m, without noise."""
    hand = SimulatedHand("mid", device=device)
    return [hand.step(1e-3, intended_m, force_n)[0] for _ in range(ticks)]


def test_dry_friction_holds_what_does_not_overcome_it() -> None:
    sticky = LoopDevice(coulomb_n=2.0)
    assert max(held(sticky, 1.99 / 400.0, 0.0, 2000)) == 0.0
    assert held(sticky, 0.0, -1.99, 2000)[-1] == 0.0
    assert held(sticky, 2.02 / 400.0, 0.0, 2000)[-1] > 0.0


def test_dry_friction_lets_a_hand_rest_within_its_band() -> None:
    end_m = held(LoopDevice(coulomb_n=2.0), 0.02, 0.0, 4000)
    assert end_m[-1] == end_m[-500]  # at rest, not creeping
    assert abs(end_m[-1] - 0.02) <= 2.0 / 400.0 and abs(end_m[-1] - 0.02) > 1e-4
    free_m = held(ASSUMED_DEVICE, 0.02, 0.0, 4000)
    assert free_m[-1] == pytest.approx(0.02, abs=1e-6)


def test_mass_and_friction_are_those_of_the_device() -> None:
    """Free swing: the spring's frequency and decay of hand and device together."""
    for device in (LoopDevice(0.05, 0.5), LoopDevice(1.0, 8.0), LoopDevice(0.01, 900.0)):
        mass_kg, damping_nspm = 0.25 + device.mass_kg, 6.0 + device.viscous_nspm
        pole = np.roots([mass_kg, damping_nspm, 400.0])
        time_s = 1e-3 * np.arange(1, 301)
        weights = np.linalg.solve(np.array([[1.0, 1.0], pole]), np.array([-0.01, 0.0]))
        truth_m = 0.01 + np.real(np.exp(np.outer(time_s, pole)) @ weights)
        hand = SimulatedHand("mid", device=device)
        hand.step(1e-12, 0.01, 0.0)  # the hand's intention jumps, the tool has not moved yet
        found_m = [hand.step(1e-3, 0.01, 0.0)[0] for _ in time_s]
        np.testing.assert_allclose(found_m, truth_m, atol=2e-5)


def test_a_force_acts_so_many_ticks_late() -> None:
    for late in (0, 1, 5, 160):
        hand = SimulatedHand("mid", device=LoopDevice(delay_samples=late))
        moved = [hand.step(1e-3, 0.0, 1.0)[0] != 0.0 for _ in range(170)]
        assert moved.index(True) == late


@pytest.mark.parametrize(
    "device",
    [LoopDevice(mass_kg=0.0), LoopDevice(viscous_nspm=-1.0), LoopDevice(coulomb_n=math.nan),
     LoopDevice(resolution_um=0.0), LoopDevice(delay_samples=177)],
)  # fmt: skip
def test_an_impossible_device_is_refused_by_the_c(device: LoopDevice) -> None:
    with pytest.raises(SpringpotError, match="status -2"):
        SimulatedHand(device=device)


@pytest.mark.slow
def test_the_closed_loop_has_the_scenes_device() -> None:
    """Delay beyond the device's own, its encoder, and a hand that knows its friction."""
    device = Device(mass_kg=0.2, viscous_nspm=2.0, coulomb_n=0.5, delay_s=0.002,
                    resolution_um=40.0)  # fmt: skip
    plan = elastic_plan(500.0, 1000.0, device)
    found = stability(plan)
    assert {(item.delay_samples, item.late) for item in found.outcomes} == {(2, False), (3, True)}
    hold = next(item for item in found.outcomes if item.case_name == "hold" and item.hand == "mid")
    steps = np.diff(hold.trace.seen_m) / 40e-6
    np.testing.assert_allclose(steps, np.rint(steps), atol=1e-6)
    assert np.abs(steps).max() >= 1.0
    still_m = hold.trace.position_m[-200:]
    assert np.ptp(still_m) == 0.0  # dry friction holds it
    assert still_m[-1] == pytest.approx(1.1 * SPAN_M, rel=0.1)
    told: dict[str, Any] = found.as_dict()["device"]
    assert told == {
        "mass_kg": 0.2, "viscous_nspm": 2.0, "coulomb_n": 0.5, "resolution_um": 40.0,
        "position_noise_um": 12.0, "delay_s": 0.002, "delay_samples": 2, "measured": True,
    }  # fmt: skip


def test_a_hand_pushes_against_the_friction_while_it_moves() -> None:
    plans = [elastic_plan(500.0, 1000.0, Device(coulomb_n=coulomb_n)) for coulomb_n in (1e-9, 3.0)]

    def motion(t: np.ndarray) -> np.ndarray:
        return 0.01 * minimum_jerk_rise(t / 0.5)

    none, rubbed = (
        press_scenario(
            Workspace.of(plan), motion, lambda x: 500.0 * x, HAND_MODELS[0], 1.0
        ).intended_m
        for plan in plans
    )
    np.testing.assert_allclose((rubbed - none)[100:400], 3.0 / 400.0, rtol=1e-3)
    np.testing.assert_allclose((rubbed - none)[600:], 0.0, atol=1e-12)
