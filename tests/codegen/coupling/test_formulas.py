"""The coupling's step, formulas of its choice, and the linear loop, each derived a second time."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.signal import cont2discrete
from support.springs import select_for_spring

from springpot.codegen.coupling import gains
from springpot.codegen.coupling.auto import STIFFNESS_MARGIN_PROXY
from springpot.codegen.coupling.linear_loop import (
    CHECKED_HANDS,
    DESIGN_HAND,
    HAND_MODELS,
    LinearLoop,
)
from springpot.codegen.coupling.loop_device import DEVICE_DAMPING_NSPM, DEVICE_MASS_KG, LoopDevice
from springpot.codegen.coupling.loop_margin import compute_loop_margin
from springpot.codegen.coupling.object_tangent import ObjectTangent
from springpot.codegen.errors import UnsafeError
from springpot.codegen.proxy_motion import VirtualCoupling
from springpot.codegen.scene import Coupling
from springpot.runtime_c.paths import SIM

OFF = Coupling(mode="off")


@pytest.mark.parametrize(
    "device", [LoopDevice(), LoopDevice(0.05, 0.5), LoopDevice(delay_samples=2)]
)
@pytest.mark.parametrize("coupling", [OFF, Coupling("tool", 4000.0, 10.0, 0.05)])
def test_a_limit_is_stable_and_little_more_is_not(device: LoopDevice, coupling: Coupling) -> None:
    for hand in HAND_MODELS:
        loop = LinearLoop(1e-3, coupling, hand, device)
        limit_npm = loop.max_stiffness_npm()
        softer = np.geomspace(1.0, limit_npm, 300)
        assert np.all(loop.spectral_radius(softer) < 1.0)
        assert loop.spectral_radius(1.002 * limit_npm)[0] >= 1.0


def test_limits_that_are_beyond_the_search_are_its_ends() -> None:
    held = LinearLoop(1e-5, OFF, replace(DESIGN_HAND, damping_nspm=1e4))
    assert held.max_stiffness_npm() == 1e7
    never = LinearLoop(1e-3, OFF, replace(DESIGN_HAND, damping_nspm=-50.0))
    assert never.max_stiffness_npm() == 0.0


def ticked(state: np.ndarray, coupling: Coupling, stiffness_npm: float) -> np.ndarray:
    """One tick of 1 ms: matrix exponential, scipy's filter, the reference's coupling.

    state: position, velocity, position and velocity that were seen before, the proxy's two.
    """
    dt_s, hand, device = 1e-3, DESIGN_HAND, LoopDevice()
    mass_kg = hand.mass_kg + device.mass_kg
    damping, system = hand.damping_nspm + device.viscous_nspm, np.zeros((3, 3))
    system[0, 1] = 1.0
    system[1] = [-hand.stiffness_npm / mass_kg, -damping / mass_kg, -1.0 / mass_kg]
    low_pass = [1.0], [0.004, 1.0]  # 4 ms, by backward Euler
    numerator, denominator, _ = cont2discrete(low_pass, dt_s, method="backward_diff")
    x, v, before, v_before, *proxy = state
    v_held = -denominator[1] * v_before + numerator.sum() * (x - before) / dt_s
    couple = VirtualCoupling(gains.build_couple_config(coupling, dt_s, np.float64))
    couple.proxy = (proxy[0], proxy[1])
    force = couple.force(x, v_held, stiffness_npm * (proxy[0] if coupling.mode == "proxy" else x))
    moved = expm(system * dt_s)[:2] @ [x, v, force]
    return np.array([*moved, x, v_held, *couple.proxy])


@pytest.mark.parametrize(
    ("coupling", "stiffness_npm"),
    [(Coupling("tool", 4000.0, 20.0, 0.05), 6000.0), (Coupling("tool", 4000.0, 20.0, 0.05), 3e4),
     (Coupling("proxy", 30_000.0, 40.0, 0.05), 4e4), (Coupling("proxy", 9000.0, 60.0, 0.02), 2e4)],
)  # fmt: skip
def test_the_radius_is_that_of_a_loop_put_together_otherwise(
    coupling: Coupling, stiffness_npm: float
) -> None:
    columns = [ticked(unit, coupling, stiffness_npm) for unit in np.eye(6)]
    truth = np.abs(np.linalg.eigvals(np.stack(columns, axis=1))).max()
    loop = LinearLoop(1e-3, coupling, DESIGN_HAND)
    assert loop.spectral_radius(stiffness_npm)[0] == pytest.approx(truth, abs=1e-9)


@pytest.mark.parametrize("stiffness_npm", [2000.0, 5300.0, 5400.0, 9000.0])
def test_off_reaches_as_far_as_the_damping_of_the_least_stable_hand(stiffness_npm: float) -> None:
    """A held spring in ticks takes b > K (dt/2 + delay) of damping, of hand and device."""
    limit_npm = min(
        (hand.damping_nspm + 4.0) / (5e-4 + 1e-3 * more) for hand, more in CHECKED_HANDS
    )
    choice = select_for_spring(stiffness_npm, 1e-3, LoopDevice())
    assert (choice.coupling.mode == "off") is (1.25 * stiffness_npm < limit_npm)


PAPER = Coupling(mode="tool")


@given(st.floats(1.0, 1e5), st.floats(0.01, 100.0), st.floats(1e-3, 1.0), st.floats(1e-4, 0.01))
def test_transition_is_the_matrix_exponential(k: float, b: float, m: float, dt: float) -> None:
    exact = expm(np.array([[0.0, 1.0], [-k / m, -b / m]]) * dt)
    scale = np.abs(exact).max()
    np.testing.assert_allclose(gains.state_transition(k, b, m, dt), exact, atol=1e-9 * scale)


def test_moves_like_an_independent_two_body_integration() -> None:
    # The tool swings; the model pushes the proxy out like a spring at the proxy's last position.
    dt_s, ticks = 1e-3, 400
    k, b, m = PAPER.stiffness_npm, PAPER.damping_nspm, PAPER.mass_kg
    time_s = np.arange(ticks) * dt_s
    x = 0.004 * (1 - np.cos(2 * np.pi * 3 * time_s))
    v = np.append(np.diff(x) / dt_s, 0.0)  # the tool moves straight within a tick
    pushed_n = 2.0 + np.sin(2 * np.pi * 7 * time_s)
    couple = VirtualCoupling(gains.build_couple_config(PAPER, dt_s, np.float64))
    forces = [couple.force(*row) for row in zip(x, v, pushed_n, strict=True)]
    state = np.array([x[0], v[0]])
    for i in range(ticks - 1):
        felt = k * (x[i] - state[0]) + b * (v[i] - state[1])
        assert forces[i] == pytest.approx(felt, abs=1e-6)

        def move(t: float, s: np.ndarray, i: int = i) -> list[float]:
            tool = x[i] + v[i] * t
            return [s[1], (-pushed_n[i] - k * (s[0] - tool) - b * (s[1] - v[i])) / m]

        state = solve_ivp(move, (0.0, dt_s), state, rtol=1e-11, atol=1e-14).y[:, -1]


def test_the_printed_damping_is_refused_as_a_unit_error() -> None:
    with pytest.raises(UnsafeError, match=r"20 N s/m\) was probably meant"):
        gains.require_plausible_damping(Coupling(mode="tool", damping_nspm=20_000.0))
    with pytest.raises(UnsafeError, match=r"1500 N/m\) was probably meant"):
        gains.require_plausible_damping(Coupling(mode="tool", stiffness_npm=1.5e6))
    with pytest.raises(UnsafeError, match="the paper's gains"):
        gains.require_plausible_damping(Coupling(mode="tool", mass_kg=1e-9))
    critical_nspm = 2.0 * np.sqrt(1500.0 * 0.05)
    for ratio, is_error in ((9.9, False), (10.1, True)):
        proxy = Coupling("proxy", 1500.0, ratio * critical_nspm, 0.05)
        assert gains.is_implausible(proxy) is is_error


@given(st.floats(1.0, 1e4), st.floats(0.01, 1.0), st.floats(1e-4, 1e-3))
def test_the_published_step_is_stable_up_to_its_damping(k: float, m: float, dt: float) -> None:
    assert gains.max_published_damping_nspm(Coupling("tool", 1e6, 1.0, 0.01), 1e-3) == 0.0
    most_nspm = gains.max_published_damping_nspm(Coupling("tool", k, 1.0, m), dt)
    for b in (0.999 * most_nspm, 1.001 * most_nspm):
        grow = np.array([[1.0, 0.0], [-k * dt / m, 1.0 - b * dt / m]])  # the speed, then the way
        step = np.array([[1.0, dt], [0.0, 1.0]]) @ grow
        assert (np.abs(np.linalg.eigvals(step)).max() < 1.0) == (b < most_nspm)


def test_the_exact_step_is_stable_at_any_gains() -> None:
    """Half of them near the border of Algorithm 1 as published, 2 b dt/m + k dt^2/m = 4."""
    rng, sets = np.random.default_rng(1), 100_000
    spans = ((0.0, 6.0), (-2.0, 5.0), (-3.0, 0.0), (-4.0, -2.0))
    k, b, m, dt = (10.0 ** rng.uniform(low, high, sets) for low, high in spans)
    near = rng.uniform(size=sets) < 0.5
    size = 4.0 * 10.0 ** rng.normal(0.0, 0.05, sets) / (2.0 * b * dt / m + k * dt**2 / m)
    size = np.where(near, size, 1.0)
    steps = np.stack(list(map(gains.state_transition, k * size, b * size, m, dt)))
    assert np.abs(np.linalg.eigvals(steps)).max() < 1.0 + 1e-9


@pytest.mark.parametrize(
    ("mode", "delay", "npmm"), [("off", 0, 20.0), ("off", 1, 6.6), ("tool", 1, 3.1)]
)
def test_limits_are_those_measured_on_prototypes(mode: str, delay: int, npmm: float) -> None:
    # Within 15 %: there the loop was simulated, with an average of 0.7 behind the tool's coupling.
    smoothing = 0.7 if mode == "tool" else 1.0
    loop = LinearLoop(1e-3, Coupling(mode), DESIGN_HAND, LoopDevice(delay_samples=delay), smoothing)  # type: ignore[arg-type]
    assert 1e-3 * loop.max_stiffness_npm() == pytest.approx(npmm, rel=0.15)


def test_hands_are_the_simulated_ones() -> None:
    text = (SIM / "sim_hand.c").read_text()
    found = re.findall(r'\{"(\w+)", \{([\d.]+), ([\d.]+), ([\d.]+)\}\}', text)
    assert [(h.name, h.mass_kg, h.stiffness_npm, h.damping_nspm) for h in HAND_MODELS] == [
        (name, *map(float, rest)) for name, *rest in found
    ]
    device = (SIM / "sim_hand.h").read_text()
    assert f"SIM_DEVICE_MASS_KG {DEVICE_MASS_KG}" in device
    assert f"SIM_DEVICE_DAMPING_NSPM {DEVICE_DAMPING_NSPM}" in device


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", range(12))
def test_what_auto_picks_is_stable_with_every_hand_or_says_that_it_is_not(seed: int) -> None:
    """At any rate, stiffness and delay, with any softer object too: gains are rounded and eased."""
    rng = np.random.default_rng(seed)
    rate_hz, stiffness_npm = 10.0 ** rng.uniform(1.8, 3.7), 10.0 ** rng.uniform(2.5, 4.7)
    device = LoopDevice(delay_samples=int(rng.integers(0, 3)))
    choice = select_for_spring(stiffness_npm, 1.0 / rate_hz, device)
    assert choice.why.startswith(f"{choice.coupling.mode}: auto: ")
    assert choice.felt_npm <= stiffness_npm
    proxy = choice.coupling.mode == "proxy"
    loops = [
        LinearLoop(1.0 / rate_hz, choice.coupling, hand, device.with_delay(more))
        for hand, more in CHECKED_HANDS
    ]
    # The choice looks at eight stiffnesses, this at a hundred: between them it may miss a little.
    most = STIFFNESS_MARGIN_PROXY if proxy else 1.0
    loads_npm = stiffness_npm * np.geomspace(0.01, most, 100)
    radius = max(float(loop.spectral_radius(loads_npm).max()) for loop in loops)
    spring = ObjectTangent.from_spring(stiffness_npm)
    margin = compute_loop_margin(spring, choice.coupling, 1.0 / rate_hz, device, 1.0)
    assert (radius < 1.0 + 1e-3) == (margin.gain_margin > most)
