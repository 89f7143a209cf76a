"""Features along a recording, in float64: fractional derivatives, past positions, velocity.

Fractional derivatives are Grünwald-Letnikov sums (the paper's appendix A), an imitation of these by
direct taps and truncated exponentials (engine `fir-fast`), or sums of exponentials, which are true
to the derivative at any rate.
"""

from functools import singledispatch
from itertools import accumulate

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.model.features import (
    FastFirBank,
    Features,
    FirBank,
    Lags,
    PositionVelocity,
    RecursiveBank,
)
from springpot.codegen.model.formulas import compute_loss_and_gain, estimate_foaw_velocity
from springpot.trainer.recordings.signals import estimate_history_m

POLES_PER_DECADE = 2.5
_MIN_TAU_STEPS = 0.25  # shortest time constant
MAX_TAU_PER_MEMORY = (
    3.0  # longest time constant, of the memory asked for: the kernel's tail needs it
)
_FREQUENCIES_PER_DECADE = 60
N_DIRECT_TAPS = 4
FAST_FIR_POLES = 8
_MIN_TAU_CANDIDATES = (1.0, 1.5, 2.0, 3.0, 4.0)
_MAX_TAU_CANDIDATES = (0.5, 1.0, 2.0, 6.0)
_CHUNK_ROWS = 8192  # rows with windows that are gathered at once


def gl_weights(order: float, length: int) -> Samples:
    """Return the Grünwald-Letnikov weights c_k h^r, (length,): (-1)^k binomial(order, k), k from 0.

    By the recurrence c_k = c_(k-1) (k - 1 - r)/k, which overflows at no length (the gamma functions
    of the paper's equation (15) do from k = 171 on). Raises ValueError where the order is not in
    [0, 1] or there is no tap.
    """
    if not 0.0 <= order <= 1.0:
        raise ValueError(f"fractional order {order}: give one in [0, 1]")
    if length < 1:
        raise ValueError(f"{length} taps: give at least one")
    k = np.arange(1, length)
    return np.concatenate([[1.0], np.cumprod((k - 1 - order) / k)])


def gl_taps(order: float, length: int, dt_s: float) -> Samples:
    """Taps c(r, k) of equation (16), shape (length,), newest sample first, 1/s^order.

    The sum is over f(t - k h), the samples that exist; the paper prints f(t + (r - k) h).
    """
    weights: Samples = gl_weights(order, length) * dt_s**-order
    return weights


def fit_recursive_bank(orders: tuple[float, ...], dt_s: float, longest_s: float) -> RecursiveBank:
    """Log-spaced poles, one bank for all orders, true to motion between longest_s/2 and two steps.

    Weights are non-negative: each feature is then a sum of Maxwell branches, locally dissipative.
    """
    fastest_s, slowest_s = _MIN_TAU_STEPS * dt_s, MAX_TAU_PER_MEMORY * longest_s
    n_poles = 1 + round(POLES_PER_DECADE * np.log10(slowest_s / fastest_s))
    tau_s = np.geomspace(fastest_s, slowest_s, max(n_poles, 2))
    ends = MAX_TAU_PER_MEMORY / longest_s, 0.5 / dt_s
    n_points = round(_FREQUENCIES_PER_DECADE * np.log10(ends[1] / ends[0]))
    omega = np.geomspace(*ends, max(n_points, _FREQUENCIES_PER_DECADE))
    weights = np.stack([_fit_pole_weights(order, tau_s, omega) for order in orders], axis=1)
    return RecursiveBank(orders=orders, tau_s=tau_s, weights=weights)


def _fit_pole_weights(order: float, tau_s: Samples, omega: Samples) -> Samples:
    """Fit weights w >= 0, (poles,), so that the sum of w s/(s + 1/tau) is near s^r, s = j omega."""
    from scipy.optimize import nnls  # what replays recordings has no scipy

    s = 1j * omega[:, None]
    system = s / (s + 1.0 / tau_s) / s**order
    target = np.concatenate([np.ones(len(omega)), np.zeros(len(omega))])
    columns = np.concatenate([system.real, system.imag])
    column_norms = np.linalg.norm(
        columns, axis=0
    )  # far from 1 for high orders, and nnls goes in circles
    weights, _ = nnls(columns / column_norms, target)
    return np.asarray(weights / column_norms, dtype=np.float64)


def fit_fast_fir_bank(bank: FirBank) -> FastFirBank:
    """Fit the running sums C_k of all orders' taps with shared poles, by least squares.

    By parts, sum of c_k x(t-k) = sum of C_k (x(t-k) - x(t-k-1)) + C_last x(oldest): the C_k fall
    smoothly with age, as sums of exponentials do. The poles are log-spaced; their ends
    are those of a few that give the lowest error.
    """
    length = len(bank.taps)
    candidates = [
        _fit_shared_poles(bank, np.geomspace(fastest, slowest * length, FAST_FIR_POLES))
        for fastest in _MIN_TAU_CANDIDATES
        for slowest in _MAX_TAU_CANDIDATES
    ]
    return min(candidates, key=lambda fast: compute_response_error(bank, fast))


def _fit_shared_poles(bank: FirBank, tau_ticks: Samples) -> FastFirBank:
    """Fit the running sums of the taps, beyond the newest ones, by exponentials of given times.

    Linear least squares for the weights; the sums of every order share the exponentials.
    """
    length = len(bank.taps)
    sums = np.cumsum(bank.taps, axis=0)
    age = np.arange(length - 1 - N_DIRECT_TAPS)
    # Rows over their mean: without it the newest sums, the largest, would count most.
    scale = sums[N_DIRECT_TAPS : length - 1].mean(axis=1, keepdims=True)
    poles, *_ = np.linalg.lstsq(
        np.exp(-age[:, None] / tau_ticks) / scale,
        sums[N_DIRECT_TAPS : length - 1] / scale,
        rcond=1e-10,
    )
    weights = np.concatenate([sums[:N_DIRECT_TAPS], poles, sums[-1:]])
    return FastFirBank(orders=bank.orders, tau_ticks=tau_ticks, length=length, weights=weights)


def compute_taps(fast: FastFirBank) -> Samples:
    """Taps of the same filter, shape (length, orders): differences of its running sums."""
    n_direct = len(fast.weights) - len(fast.tau_ticks) - 1
    age = np.arange(fast.length - 1 - n_direct)
    tail = np.exp(-age[:, None] / fast.tau_ticks) @ fast.weights[n_direct:-1]
    sums = np.concatenate([fast.weights[:n_direct], tail, fast.weights[-1:]])
    return np.diff(sums, axis=0, prepend=np.zeros((1, sums.shape[1])))


def compute_response_error(bank: FirBank, fast: FastFirBank) -> float:
    """Return the greatest relative error of a bank's response to slow and fast sines, over orders.

    RMS over frequencies, log-spaced from one period in ten windows to a tenth of the sample rate.
    """
    length = len(bank.taps)
    cycles_per_sample = np.geomspace(0.1 / length, 0.1, 60)
    phase = np.exp(-2j * np.pi * cycles_per_sample[:, None] * np.arange(length))
    target_response, response = phase @ bank.taps, phase @ compute_taps(fast)
    relative = np.abs(response - target_response) / np.abs(target_response)
    return float(np.sqrt((relative**2).mean(axis=0)).max())


@singledispatch
def feature_values(features: Features, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    """Features at `rows` of one recording, shape (rows, features), in float64.

    depth_m: (n,). Before its first sample the object has rested at that sample. Each kind of
    features registers its own; raises TypeError for one that did not.
    """
    raise TypeError(f"{type(features).__name__} has no values: register them with feature_values")


def depth_features(features: Features, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    """Features at rows, after `estimate_history_m`, of depths (n,), m: (rows, features)."""
    before_m = estimate_history_m(depth_m)
    along_m = np.concatenate([before_m, depth_m])
    return feature_values(features, along_m, dt_s, len(before_m) + rows)


@feature_values.register
def _fir_values(bank: FirBank, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    return _apply_taps(bank.taps, depth_m, rows)


@feature_values.register
def _fast_fir_values(bank: FastFirBank, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    return _apply_taps(compute_taps(bank), depth_m, rows)


@feature_values.register
def recursive_values(bank: RecursiveBank, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    """States of the poles times their weights, (rows, orders), m/s^r."""
    values = np.zeros((len(rows), len(bank.orders)))
    for tau_s, weights in zip(bank.tau_s, bank.weights, strict=True):
        values += highpass(depth_m, float(tau_s), dt_s)[rows, None] * weights
    return values


def highpass(values: Samples, tau_s: float, dt_s: float) -> Samples:
    """Step a pole h' = x' - h/tau along x, (n,), linear between samples; return h, (n,)."""
    from scipy.signal import lfilter  # what replays recordings has no scipy

    losses, gains = compute_loss_and_gain(np.array([tau_s]), dt_s)
    rises = np.diff(values, prepend=values[:1])
    states: Samples = lfilter([float(gains[0])], [1.0, float(losses[0]) - 1.0], rises)
    return states


def _apply_taps(taps: Samples, depth_m: Samples, rows: Indices) -> Samples:
    """Return weighted sums over the window that ends at each row, (rows, orders)."""
    padded_m = np.concatenate([np.full(len(taps) - 1, depth_m[0]), depth_m])
    windows = sliding_window_view(padded_m, len(taps))
    newest_last = taps[::-1]
    parts = [
        windows[rows[begin : begin + _CHUNK_ROWS]] @ newest_last
        for begin in range(0, len(rows), _CHUNK_ROWS)
    ]
    return np.concatenate(parts) if parts else np.empty((0, taps.shape[1]))


@feature_values.register
def _lag_values(lags: Lags, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    return np.stack([depth_m[np.maximum(rows - lag, 0)] for lag in lags.samples], axis=1)


@feature_values.register
def _position_velocity_values(
    features: PositionVelocity, depth_m: Samples, dt_s: float, rows: Indices
) -> Samples:
    """Return depth and estimated velocity at rows, (rows, 2): FOAW, then a low pass."""
    per_step = 1.0 / (dt_s * np.arange(1, features.length + 1))
    padded_m = np.concatenate([np.full(features.length, depth_m[0]), depth_m])
    windows = sliding_window_view(padded_m, features.length + 1)
    velocity, w = (
        estimate_foaw_velocity(per_step, np.float64(features.band_m), windows),
        features.weight,
    )
    averages = accumulate(velocity.tolist(), lambda padded_m, new: w * new + (1.0 - w) * padded_m)
    return np.stack([depth_m, list(averages)], axis=1)[rows]
