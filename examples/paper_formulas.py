"""Appendix A and Algorithm 1, written from the paper's text, without springpot."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]
TAPS = 171  # of equation (16)
STEP_S = 1e-3
SPRING_NPM, DAMPER_NSPM, MASS_KG = 1500.0, 20.0, 0.05  # section V; its 20 Ns/mm read as Ns/m


def derivative(values: Samples, order: float, step_s: float = STEP_S) -> Samples:
    """Derivative of values (n,) by equation (16), at t - kh: its t + (r - k)h lies ahead of time.

    By the recurrence of the coefficients, which needs no gamma function.
    """
    k = np.arange(1, TAPS)
    taps = np.concatenate([[1.0], np.cumprod((k - 1 - order) / k)]) / step_s**order
    return np.convolve(values, taps)[: len(values)]


def press(step_s: float = STEP_S) -> Samples:
    """One press at 1 Hz, of height 2, (n,)."""
    return 1.0 - np.cos(2.0 * np.pi * np.arange(0.0, 1.0, step_s))


def change_of_step(order: float, step_s: float) -> float:
    """RMS change of a derivative of a press, relative: coefficients of 1 ms, samples of another."""
    right = derivative(press(), order)
    other = derivative(press(step_s), order)  # with the coefficients of 1 ms
    time_s = [step * np.arange(len(each)) for step, each in ((STEP_S, right), (step_s, other))]
    return rms(np.interp(time_s[0], time_s[1], other) - right) / rms(right)


def coupled_n(tool_m: Samples, model_n: Callable[[int, float, float], float],
              sign: float = -1.0) -> Samples:  # fmt: skip
    """Return f_VC of Algorithm 1, (n,), N.

    tool_m: depths, (n,). model_n: f_M, out of the object, of the tick, the tool's depth and the
    proxy's. sign: with which f_M enters the proxy's force; 1.0 as printed.
    """
    proxy_m, proxy_mps, before_m, found_n = float(tool_m[0]), 0.0, float(tool_m[0]), []
    for tick, tool in enumerate(tool_m.tolist()):
        stretch_mps = proxy_mps - (tool - before_m) / STEP_S
        coupling_n = -SPRING_NPM * (proxy_m - tool) - DAMPER_NSPM * stretch_mps
        proxy_mps += STEP_S * (sign * model_n(tick, tool, proxy_m) + coupling_n) / MASS_KG
        proxy_m += STEP_S * proxy_mps
        before_m = tool
        found_n.append(coupling_n)
    return np.array(found_n)


def growth(damping_nspm: float) -> float:
    """Factor by which a stretch of Algorithm 1's coupling grows in a step of 1 ms, tool at rest."""
    spring, damper = STEP_S * SPRING_NPM / MASS_KG, STEP_S * damping_nspm / MASS_KG
    step = [[1.0 - STEP_S * spring, STEP_S * (1.0 - damper)], [-spring, 1.0 - damper]]
    return float(np.abs(np.linalg.eigvals(step)).max())


def largest_damping_nspm() -> float:
    """Damping at which `growth` is 1: with more, Algorithm 1 as printed is unstable."""
    return 2.0 * MASS_KG / STEP_S - 0.5 * SPRING_NPM * STEP_S


def rms(values: Samples) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
