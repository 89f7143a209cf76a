import mpmath
import numpy as np
import pytest
from hypothesis import given, strategies as st
from support.derivatives import fir_derivatives

from springpot.trainer.features import gl_taps, gl_weights


@pytest.mark.few(2)
@pytest.mark.parametrize("order", [0.0, 0.05, 0.3, 0.5, 0.95, 1.0])
def test_weights_equal_exact_binomials(order: float) -> None:
    with mpmath.workdps(40):
        exact = [float((-1) ** k * mpmath.binomial(mpmath.mpf(order), k)) for k in range(2000)]
    np.testing.assert_allclose(gl_weights(order, 2000), exact, rtol=5e-13, atol=1e-300)


@pytest.mark.parametrize("order", [0.1, 0.3, 0.5])
def test_sines_are_scaled_and_advanced(order: float) -> None:
    # D^r sin(w t) = w^r sin(w t + r pi/2) once the start has died away.
    dt_s, frequency_hz = 1e-3, 2.0
    time_s = np.arange(60_000) * dt_s
    angle = 2 * np.pi * frequency_hz * time_s
    filtered = fir_derivatives(np.sin(angle), gl_taps(order, 30_000, dt_s)[:, None])[:, 0]
    omega = 2 * np.pi * frequency_hz
    exact = omega**order * np.sin(angle + order * np.pi / 2)
    error = filtered[40_000:] - exact[40_000:]
    assert np.sqrt(np.mean(error**2)) < 6e-3 * omega**order


@given(st.floats(0, 1), st.integers(1, 300))
def test_a_rest_before_the_start_is_the_first_sample_held(order: float, length: int) -> None:
    taps = gl_taps(order, length, 1e-3)[:, None]
    features = fir_derivatives(np.full(5, 0.01), taps)
    np.testing.assert_allclose(features, 0.01 * taps.sum(), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(("order", "length"), [(-0.1, 5), (1.1, 5), (0.5, 0), (np.nan, 3)])
def test_refuses_what_is_no_filter(order: float, length: int) -> None:
    with pytest.raises(ValueError, match="give"):
        gl_weights(order, length)
