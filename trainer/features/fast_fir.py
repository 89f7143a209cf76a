"""Engine `fir-fast`: a window of taps imitated by direct taps and truncated exponentials."""

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.model.features import FastFirBank, FirBank

DIRECT = 4
FAST_FIR_POLES = 8
_FASTEST_TICKS = (1.0, 1.5, 2.0, 3.0, 4.0)
_SLOWEST_WINDOWS = (0.5, 1.0, 2.0, 6.0)


def fast_fir_bank(bank: FirBank) -> FastFirBank:
    """Fit the running sums C_k of all orders' taps with shared poles, by least squares.

    By parts, sum of c_k x(t-k) = sum of C_k (x(t-k) - x(t-k-1)) + C_last x(oldest): the C_k fall
    smoothly with age, as sums of exponentials do. The poles are log-spaced; their ends
    are those of a few that give the lowest error.
    """
    length = len(bank.taps)
    candidates = [
        _fitted(bank, np.geomspace(fastest, slowest * length, FAST_FIR_POLES))
        for fastest in _FASTEST_TICKS
        for slowest in _SLOWEST_WINDOWS
    ]
    return min(candidates, key=lambda fast: imitation_error(bank, fast))


def _fitted(bank: FirBank, tau_ticks: Samples) -> FastFirBank:
    length = len(bank.taps)
    sums = np.cumsum(bank.taps, axis=0)
    age = np.arange(length - 1 - DIRECT)
    # Rows over their mean: without it the newest sums, the largest, would count most.
    scale = sums[DIRECT : length - 1].mean(axis=1, keepdims=True)
    poles, *_ = np.linalg.lstsq(
        np.exp(-age[:, None] / tau_ticks) / scale, sums[DIRECT : length - 1] / scale, rcond=1e-10
    )
    weights = np.concatenate([sums[:DIRECT], poles, sums[-1:]])
    return FastFirBank(orders=bank.orders, tau_ticks=tau_ticks, length=length, weights=weights)


def equivalent_taps(fast: FastFirBank) -> Samples:
    """Taps of the same filter, shape (length, orders): differences of its running sums."""
    n_direct = len(fast.weights) - len(fast.tau_ticks) - 1
    age = np.arange(fast.length - 1 - n_direct)
    tail = np.exp(-age[:, None] / fast.tau_ticks) @ fast.weights[n_direct:-1]
    sums = np.concatenate([fast.weights[:n_direct], tail, fast.weights[-1:]])
    return np.diff(sums, axis=0, prepend=np.zeros((1, sums.shape[1])))


def imitation_error(bank: FirBank, fast: FastFirBank) -> float:
    """Maximum over the orders of the relative RMS error of the response to slow and fast sines.

    Frequencies are log-spaced from one period in ten windows to a tenth of the sample rate.
    """
    length = len(bank.taps)
    turns = np.geomspace(0.1 / length, 0.1, 60)
    phase = np.exp(-2j * np.pi * turns[:, None] * np.arange(length))
    wanted, found = phase @ bank.taps, phase @ equivalent_taps(fast)
    relative = np.abs(found - wanted) / np.abs(wanted)
    return float(np.sqrt((relative**2).mean(axis=0)).max())
