"""The coupling's exact step: against scipy's matrix exponential and an independent integration."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from springpot.codegen.coupling.gains import couple_config, require_plausible_damping, transition
from springpot.codegen.errors import UnsafeError
from springpot.codegen.proxy_motion import Coupled
from springpot.codegen.scene import Coupling

PAPER = Coupling(mode="tool")


@given(st.floats(1.0, 1e5), st.floats(0.01, 100.0), st.floats(1e-3, 1.0), st.floats(1e-4, 0.01))
def test_transition_is_the_matrix_exponential(k: float, b: float, m: float, dt: float) -> None:
    exact = expm(np.array([[0.0, 1.0], [-k / m, -b / m]]) * dt)
    scale = np.abs(exact).max()
    np.testing.assert_allclose(transition(k, b, m, dt), exact, atol=1e-9 * scale)


def test_moves_like_an_independent_two_body_integration() -> None:
    # The tool swings; the model pushes the proxy out like a spring at the proxy's last position.
    dt_s, ticks = 1e-3, 400
    k, b, m = PAPER.stiffness_npm, PAPER.damping_nspm, PAPER.mass_kg
    time_s = np.arange(ticks) * dt_s
    x = 0.004 * (1 - np.cos(2 * np.pi * 3 * time_s))
    v = np.append(np.diff(x) / dt_s, 0.0)  # the tool moves straight within a tick
    pushed_n = 2.0 + np.sin(2 * np.pi * 7 * time_s)
    couple = Coupled(couple_config(PAPER, dt_s, np.float64))
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
        require_plausible_damping(Coupling(mode="tool", damping_nspm=20_000.0))
    with pytest.raises(UnsafeError, match=r"1500 N/m\) was probably meant"):
        require_plausible_damping(Coupling(mode="tool", stiffness_npm=1.5e6))
    with pytest.raises(UnsafeError, match="the paper's gains"):
        require_plausible_damping(Coupling(mode="tool", mass_kg=1e-9))
