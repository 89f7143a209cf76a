"""The linear loop: the exact step, its hands, and what it allows."""

import re

import numpy as np
import pytest

from springpot.codegen.coupling.auto import STIFFNESS_MARGIN_PROXY, choose_coupling
from springpot.codegen.coupling.gains import transition as exact_step
from springpot.codegen.coupling.linear_loop import CHECKED, DESIGN_HAND, HAND_MODELS, LinearLoop
from springpot.codegen.coupling.loop_device import DEVICE_DAMPING_NSPM, DEVICE_MASS_KG, LoopDevice
from springpot.codegen.scene import Coupling
from springpot.runtime_c.paths import SIM


def test_the_exact_step_is_stable_at_any_gains() -> None:
    """Half of them near the border of Algorithm 1 as published, 2 b dt/m + k dt^2/m = 4."""
    rng, sets = np.random.default_rng(1), 100_000
    spans = ((0.0, 6.0), (-2.0, 5.0), (-3.0, 0.0), (-4.0, -2.0))
    k, b, m, dt = (10.0 ** rng.uniform(low, high, sets) for low, high in spans)
    near = rng.uniform(size=sets) < 0.5
    size = 4.0 * 10.0 ** rng.normal(0.0, 0.05, sets) / (2.0 * b * dt / m + k * dt**2 / m)
    size = np.where(near, size, 1.0)
    steps = np.stack([exact_step(*row) for row in zip(k * size, b * size, m, dt, strict=True)])
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
    choice = choose_coupling(stiffness_npm, 1.0 / rate_hz, device, 1.0, Coupling())
    assert choice.why.startswith(f"{choice.coupling.mode}: auto: ")
    assert choice.felt_npm <= stiffness_npm
    proxy = choice.coupling.mode == "proxy"
    loops = [
        LinearLoop(1.0 / rate_hz, choice.coupling, hand, device.later(more))
        for hand, more in CHECKED
    ]
    # The choice looks at eight stiffnesses, this at a hundred: between them it may miss a little.
    most = STIFFNESS_MARGIN_PROXY if proxy else 1.0
    loads_npm = stiffness_npm * np.geomspace(0.01, most, 100)
    radius = max(float(loop.spectral_radius(loads_npm).max()) for loop in loops)
    assert (radius < 1.0 + 1e-3) == choice.every_hand
