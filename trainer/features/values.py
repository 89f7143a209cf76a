"""Values of a model's features along a recording, in float64, only at the rows that are used."""

from collections.abc import Sequence
from functools import singledispatch
from itertools import pairwise

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
from springpot.codegen.model.formulas import foaw, loss_and_gain
from springpot.trainer.features.fast_fir import equivalent_taps

_KEPT = 1e-15  # of a state after a tick: of less nothing is left
_LOG_PIECE = 200.0  # e^-200 is a float64 yet
_CHUNK = 8192  # rows whose windows are gathered at once


@singledispatch
def feature_values(features: Features, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    """Features at `rows` of one recording, shape (rows, features), in float64.

    depth_m: (n,). Before its first sample the object has rested at that sample. Each kind of
    features registers its own; raises TypeError for one that did not.
    """
    raise TypeError(f"{type(features).__name__} has no values: register them with feature_values")


@feature_values.register
def _fir_values(bank: FirBank, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    return _windowed(bank.taps, depth_m, rows)


@feature_values.register
def _fast_fir_values(bank: FastFirBank, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    return _windowed(equivalent_taps(bank), depth_m, rows)


@feature_values.register
def recursive_values(bank: RecursiveBank, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    """States of the poles times their weights, (rows, orders), m/s^r."""
    values = np.zeros((len(rows), len(bank.orders)))
    for tau_s, weights in zip(bank.tau_s, bank.weights, strict=True):
        values += highpass(depth_m, float(tau_s), dt_s)[rows, None] * weights
    return values


def highpass(
    values: Samples, tau_s: float, dt_s: float, pauses: Sequence[tuple[int, float]] = ()
) -> Samples:
    """State h of a pole: h' = x' - h/tau, x linear within a step and at rest before.

    values: x, (n,), or of several, (n, k), as what is returned. pauses: samples, ascending, before
    which so many seconds passed: half of their rise comes first.
    """
    from scipy.signal import lfilter  # what replays recordings has no scipy

    losses, gains = loss_and_gain(np.array([tau_s]), dt_s)
    loss, gain = float(losses[0]), float(gains[0])
    rises = np.diff(values, axis=0, prepend=values[:1])
    states, begin, h = np.empty_like(rises), 0, np.zeros_like(rises[0])
    for index, seconds in (*pauses, (len(values), 0.0)):
        part, start = rises[begin:index], np.asarray((1.0 - loss) * h)[None]
        states[begin:index] = lfilter([gain], [1.0, loss - 1.0], part, axis=0, zi=start)[0]
        if index < len(values):
            half = 0.5 * rises[index]
            h = (states[index - 1] + half) * float(np.exp(-seconds / tau_s)) + half
            states[index], begin = h, index + 1
    return states


def highpass_by_depth(values: Samples, lost: Samples) -> Samples:
    """State h of a pole that loses the share `lost`, (n,), in each tick: sp_depth.h.

    values: (n, k), as what is returned.
    """
    rises = np.diff(values, axis=0, prepend=values[:1])
    return _decaying(1.0 - lost, (1.0 - 0.5 * lost)[:, None] * rises)


def _decaying(kept: Samples, added: Samples) -> Samples:
    """h[i] = kept[i] h[i-1] + added[i] from 0, (n, k); kept, (n,), above 0.

    By sums of what is added over the product of what is kept, in pieces in which that product
    stays a number.
    """
    logs = np.log(np.maximum(kept, _KEPT))
    passed = np.cumsum(logs)
    cuts = [0, *(1 + np.flatnonzero(np.diff(np.floor(passed / -_LOG_PIECE)))).tolist(), len(kept)]
    h, last = np.empty_like(added), np.zeros_like(added[0])
    for begin, end in pairwise(cuts):
        before = passed[begin] - logs[begin]
        product = np.exp(passed[begin:end] - before)[:, None]
        h[begin:end] = product * (last + np.cumsum(added[begin:end] / product, axis=0))
        last = h[end - 1] if end > begin else last
    return h


def _windowed(taps: Samples, depth_m: Samples, rows: Indices) -> Samples:
    held = np.concatenate([np.full(len(taps) - 1, depth_m[0]), depth_m])
    windows = sliding_window_view(held, len(taps))
    newest_last = taps[::-1]
    parts = [
        windows[rows[begin : begin + _CHUNK]] @ newest_last for begin in range(0, len(rows), _CHUNK)
    ]
    return np.concatenate(parts) if parts else np.empty((0, taps.shape[1]))


@feature_values.register
def _lag_values(lags: Lags, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    past = [depth_m[np.maximum(rows - lag, 0)] for lag in lags.samples]
    if lags.difference:
        past = [past[0], *(past[0] - values for values in past[1:])]
    return np.stack(past, axis=1)


@feature_values.register
def _position_velocity_values(
    features: PositionVelocity, depth_m: Samples, dt_s: float, rows: Indices
) -> Samples:
    per_step = 1.0 / (dt_s * np.arange(1, features.length + 1))
    held = np.concatenate([np.full(features.length, depth_m[0]), depth_m])
    windows = sliding_window_view(held, features.length + 1)[rows]
    velocity = foaw(per_step, np.float64(features.band_m), windows)
    return np.stack([depth_m[rows], velocity], axis=1)
