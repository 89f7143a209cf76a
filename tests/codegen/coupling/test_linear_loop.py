"""The linear loop: its hands, and what it allows."""

import re

import numpy as np
import pytest

from springpot.codegen.coupling.auto import STIFFNESS_MARGIN_PROXY, choose_coupling
from springpot.codegen.coupling.linear_loop import CHECKED, HAND_MODELS, LinearLoop
from springpot.codegen.coupling.loop_device import DEVICE_DAMPING_NSPM, DEVICE_MASS_KG, LoopDevice
from springpot.codegen.scene import Coupling
from springpot.runtime_c.paths import SIM


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
