"""Formulas of the coupling's choice and of the linear loop, each derived a second time here."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.signal import cont2discrete

from springpot.codegen.coupling.auto import choose_coupling
from springpot.codegen.coupling.gains import couple_config
from springpot.codegen.coupling.linear_loop import CHECKED, DESIGN_HAND, HAND_MODELS, LinearLoop
from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.proxy_motion import Coupled
from springpot.codegen.scene import Coupling

OFF = Coupling(mode="off")
LIGHT_DEVICE = LoopDevice(0.05, 0.5)


@pytest.mark.parametrize("device", [LoopDevice(), LIGHT_DEVICE, LoopDevice(delay_samples=2)])
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
    damping = hand.damping_nspm + device.viscous_nspm
    system = np.zeros((3, 3))
    system[0, 1] = 1.0
    system[1] = [-hand.stiffness_npm / mass_kg, -damping / mass_kg, -1.0 / mass_kg]
    low_pass = [1.0], [0.004, 1.0]  # 4 ms, by backward Euler
    numerator, denominator, _ = cont2discrete(low_pass, dt_s, method="backward_diff")
    x, v, before, v_before, *proxy = state
    v_held = -denominator[1] * v_before + numerator.sum() * (x - before) / dt_s
    couple = Coupled(couple_config(coupling, dt_s, np.float64))
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
    limit_npm = min((hand.damping_nspm + 4.0) / (5e-4 + 1e-3 * more) for hand, more in CHECKED)
    choice = choose_coupling(stiffness_npm, 1e-3, LoopDevice(), 1.0, Coupling())
    assert (choice.coupling.mode == "off") is (1.25 * stiffness_npm < limit_npm)
