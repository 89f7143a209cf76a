"""The gain margin of a loop: against eigenvalues, against the recurrence of a branch, and in words.

An object that relaxes is no spring: its fast branches damp the loop that its stiffness drives.
"""

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from support.small import damage, passive_model, scene

from springpot.codegen.coupling.linear_loop import CHECKED_HANDS, HAND_MODELS, Hand, LinearLoop
from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.coupling.loop_margin import (
    LoopOnCircle,
    compute_held_noise_n,
    compute_loop_margin,
    compute_noise_m,
)
from springpot.codegen.coupling.object_tangent import ObjectTangent
from springpot.codegen.make_plan import make_plan
from springpot.codegen.scene import Coupling

LIGHT = HAND_MODELS[2]
Mode = Literal["off", "tool", "proxy"]
MODES: tuple[Mode, ...] = ("off", "tool", "proxy")


def drawn(rng: np.random.Generator, mode: Mode) -> LinearLoop:
    """A random loop with a hand, stable without an object."""
    coupling = Coupling(
        mode, 10.0 ** rng.uniform(2, 4), 10.0 ** rng.uniform(0, 1.3), 10.0 ** rng.uniform(-2.5, -1)
    )
    device = LoopDevice(10.0 ** rng.uniform(-1.3, 0), 10.0 ** rng.uniform(-0.3, 1.0),
                        delay_samples=int(rng.integers(0, 3)))  # fmt: skip
    hand = HAND_MODELS[int(rng.integers(0, 3))]
    return LinearLoop(10.0 ** rng.uniform(-4, -2.5), coupling, hand, device, rng.uniform(0.2, 1.0))


@pytest.mark.parametrize("mode", MODES)
def test_a_spring_is_held_up_to_where_an_eigenvalue_leaves_the_circle(mode: Mode) -> None:
    rng, compared = np.random.default_rng(3), 0
    while compared < 12:
        loop = drawn(rng, mode)
        limit_npm = loop.max_stiffness_npm()
        if not 30.0 < limit_npm < 1e6:
            continue
        margin = compute_loop_margin(
            ObjectTangent.from_spring(100.0), loop.coupling, loop.dt_s, loop.device,
            loop.smoothing, [(loop.hand, 0)],
        )  # fmt: skip
        assert margin.gain_margin == pytest.approx(limit_npm / 100.0, rel=0.02)
        compared += 1


def relaxing(branch_npm: float, decay: float, spring_npm: float = 1000.0) -> ObjectTangent:
    return ObjectTangent(
        np.array([spring_npm]), np.array([[branch_npm]]), np.array([[decay]]), np.array([True])
    )


def test_the_response_is_that_of_the_recurrence() -> None:
    """Of sp_poles.h, driven at one frequency."""
    tangent, turn, n = relaxing(3000.0, 0.1), 0.2, 4000
    depth, h, before = np.sin(turn * np.arange(n)), 0.0, 0.0
    force_n = np.empty(n)
    for i in range(n):
        rise = 3000.0 * depth[i] - before
        before += rise
        h += rise - 0.1 * (h + 0.5 * rise)
        force_n[i] = 1000.0 * depth[i] + h
    waves = np.stack([np.cos(turn * np.arange(n)), np.sin(turn * np.arange(n))], axis=1)[n // 2 :]
    real, imag = np.linalg.lstsq(waves, force_n[n // 2 :], rcond=None)[0]
    response = tangent.compute_response(np.exp(1j * np.array([turn])))[0, 0]
    assert response == pytest.approx(imag + 1j * real, rel=1e-6)


def test_fast_branches_damp_the_loop_and_slow_ones_do_not() -> None:
    """A branch pays for itself if tau < 2 m/(K (T + 2 delay)): .1 s here."""
    device, off = LoopDevice(), Coupling("off")
    objects = ObjectTangent.from_spring(8000.0), relaxing(7000.0, 1e-5), relaxing(7000.0, 0.05)
    spring, slow, fast = (
        compute_loop_margin(tangent, off, 1e-3, device, 1.0).gain_margin for tangent in objects
    )
    assert slow == pytest.approx(spring, rel=0.02) and fast > 2.0 * spring


def simulate_speed_mps(
    tangent: ObjectTangent, hand: Hand, device: LoopDevice, dt_s: float, noise_m: float
) -> float:
    """RMS speed of the bare loop under white position noise, by its own recurrence."""
    rng, n, steps = np.random.default_rng(1), 60_000, 20
    k, b, m = hand.stiffness_npm, hand.damping_nspm + device.viscous_nspm, hand.mass_kg
    m += device.mass_kg
    x = v = h = before = 0.0
    moved_m = np.zeros(n)
    for i in range(n):
        seen_m = x + noise_m * rng.standard_normal()
        rise = tangent.branch_npm[0, 0] * seen_m - before
        before += rise
        h += rise - tangent.decay[0, 0] * (h + 0.5 * rise)
        force_n = tangent.spring_npm[0] * seen_m + h
        for _ in range(steps):  # semi-implicit Euler, far below the tick
            v += dt_s / steps * (-k * x - b * v - force_n) / m
            x += dt_s / steps * v
        moved_m[i] = x
    return float(np.std(np.diff(moved_m[n // 10 :]) / dt_s))


@pytest.mark.parametrize("hand", HAND_MODELS, ids=lambda hand: hand.name)
def test_the_vibration_from_noise_is_that_of_the_loop(hand: Hand) -> None:
    device, tangent = LoopDevice(resolution_um=1.0, noise_um=4.0), relaxing(800.0, 0.05, 400.0)
    noise_m = compute_noise_m(device)
    loop = LoopOnCircle.build(tangent, 1e-3, device, 1.0, hand, 0)
    expected_mps = loop.vibration_mps(Coupling("off"), noise_m)[0]
    assert simulate_speed_mps(tangent, hand, device, 1e-3, noise_m) == pytest.approx(
        expected_mps, rel=0.1
    )


def test_the_noise_of_a_coupling_grows_with_its_damping_and_the_encoders_step() -> None:
    calm, hard = Coupling("proxy", 4000.0, 5.0, 0.01), Coupling("proxy", 4000.0, 50.0, 0.01)
    noise_m = compute_noise_m(LoopDevice(resolution_um=10.0, noise_um=3.0))
    assert noise_m == pytest.approx(1e-6 * np.hypot(3.0, 10.0 / np.sqrt(12.0)))
    assert compute_held_noise_n(hard, 1e-3, noise_m) > 2.0 * compute_held_noise_n(
        calm, 1e-3, noise_m
    )


@pytest.mark.parametrize("is_damaged", [False, True])
def test_the_tangent_of_a_model_is_the_slope_of_its_force(is_damaged: bool) -> None:
    """Spring and branches at rest, stops that stick, damage of both powers; a nudge in double."""
    model = passive_model()
    assert model.hammerstein is not None
    if is_damaged:
        curve_n = 3.0 * np.linspace(0.5, 2.0, len(model.hammerstein.elastic_n))
        model = replace(model, hammerstein=replace(model.hammerstein, damage=damage(curve_n)))
    plan = make_plan(model, scene("float64"))
    stage = plan.passive
    assert stage is not None
    tangent = plan.tangent
    depth_m = np.array([0.5 * plan.model.trained.max_m])
    row = int(np.argmin(np.abs(np.arange(0.05, 1.101, 0.05) - 0.5)))
    nudge_m = -1e-7  # the way out, on which damage is stiffer
    rest = np.full(20_000, depth_m[0])
    motion = np.concatenate([rest, [depth_m[0] + nudge_m]])
    force_n = stage.reference(motion, np.array([0]))
    instant_npm = (force_n[-1] - force_n[-2]) / nudge_m
    gained = (1.0 - 0.5 * tangent.decay[row]) @ tangent.branch_npm[row]
    assert instant_npm == pytest.approx(tangent.spring_npm[row] + gained, rel=0.02)


def test_the_worst_hand_is_named_and_every_depth_counts() -> None:
    device, off = LoopDevice(0.1, 1.0, delay_samples=1), Coupling("off")
    spring = ObjectTangent.from_spring(1500.0)
    margin = compute_loop_margin(spring, off, 1e-3, device, 1.0)
    alone = {
        (hand.name, extra): compute_loop_margin(spring, off, 1e-3, device, 1.0, [(hand, extra)])
        for hand, extra in CHECKED_HANDS
    }
    worst = min(alone, key=lambda name: alone[name].least)
    assert (margin.hand.name, margin.extra_delay) == worst and not margin.is_stable
    deep = replace(
        spring, spring_npm=np.array([100.0, 1500.0]), branch_npm=np.zeros((2, 0)),
        decay=np.zeros((2, 0)), is_held=np.array([True, False]),
    )  # fmt: skip
    pressed = compute_loop_margin(deep, off, 1e-3, device, 1.0)
    assert pressed.gain_margin > 1.0 > pressed.pressed_margin and not pressed.is_stable
