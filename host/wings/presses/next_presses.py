"""Presses to record next: those that settle most of what the recordings leave open.

A soft object is taken as bands of force, each with a spring and relaxing branches of its own, all
linear in their weights. Of such models those that explain the recordings alike form a normal
distribution, whose spread along a press is their disagreement there. What no recording covers, in
force, speed or time, is where they disagree. A press is worth the more, the less they would
disagree, over all presses, once it is recorded.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import floor, log10, sqrt

import numpy as np
from numpy.typing import NDArray

from springpot import Recording
from springpot.basics import Samples
from springpot.modelling import LONGEST_SPIKE, contact_of, depth_m, highpass, hold_spikes

N_NEXT = 3
_SHARES = (0.25, 0.5, 0.75, 1.0)  # of the greatest recorded force, which is never exceeded
_HAND_HZ = (0.2, 5.0)
_BEYOND = 4.0  # times the fastest recorded press: a device may not do more
_SLOWEST_HZ = 0.05
_LASTS_S, _HOLD_S, _RISE_S = 5.0, 10.0, 0.5

_BANDS = 6
_ALIKE = 0.3  # of the force: bands that are nearer are stiff, and relax, alike
_TAUS, _SHORTEST_S = 8, 0.01
# How far each spring and each branch may be from the mean curve, and what such a model does not
# explain of a soft object: shares of the force.
_SPRING, _BRANCH, _UNEXPLAINED = 0.3, 0.1, 0.005
_ROWS = 100  # of a press, evenly in time
_SAMPLES = 1000  # of a press that is not recorded yet
_MAX_SAMPLES = 20_000  # of a recording
_BINS = 200

_Square = NDArray[np.float64]


@dataclass(frozen=True)
class NextPress:
    """From 0 N to the amplitude and back: cosine cycles, or a hold with cosine ramps within it.

    frequency_hz: 0 of a hold. hold_s: 0 of cycles.
    before_n, after_n: how far models that explain the recordings alike differ over all possible
    presses, rms, before and after this one is recorded too."""

    amplitude_n: float
    frequency_hz: float = 0.0
    cycles: int = 1
    hold_s: float = 0.0
    rise_s: float = _RISE_S
    before_n: float = 0.0
    after_n: float = 0.0

    @property
    def duration_s(self) -> float:
        return self.hold_s or self.cycles / self.frequency_hz

    def force_n(self, time_s: Samples) -> Samples:
        """The force at times within the press, (n,), N."""
        half_s = self.rise_s if self.hold_s else 0.5 / self.frequency_hz
        if self.hold_s:
            time_s = np.minimum(np.minimum(time_s, self.hold_s - time_s), half_s)
        command_n: Samples = self.amplitude_n / 2 * (1 - np.cos(np.pi * time_s / half_s))
        return command_n


def next_presses(
    recordings: Sequence[Recording], band_hz: tuple[float, float], count: int = N_NEXT
) -> list[NextPress]:
    """The presses that would help most together, the best first; band_hz: of `find_coverage`.

    Each is chosen knowing that those before it will be recorded: they differ from each other. None
    where no force lasts longer than a glitch.
    """
    recordings = [hold_spikes(recording)[0] for recording in recordings]
    contact = contact_of(recordings)
    depths_m = [depth_m(recording, contact) for recording in recordings]
    first_n = min(float(recording.force_n.min()) for recording in recordings)
    last_n = max(_greatest_n(recording) for recording in recordings)
    range_n = last_n - (first_n if contact == "always" else 0.0)
    if range_n <= 0.0:
        return []
    peak_n = _rounded_down(range_n)
    candidates = possible_presses(peak_n, band_hz)
    tau_s = np.geomspace(_SHORTEST_S, max(press.duration_s for press in candidates), _TAUS)
    known = np.linalg.inv(_prior()).astype(np.float64)
    for share, dt_s in _recorded_shares(recordings, depths_m):
        known += _information(share, dt_s, tau_s)
    told: list[_Square] = []
    for press in candidates:
        time_s = np.linspace(0.0, press.duration_s, _SAMPLES)
        told.append(_information(press.force_n(time_s) / peak_n, float(time_s[1]), tau_s))
    everywhere: _Square = np.sum(told, axis=0)

    def disagreement_n(information: _Square) -> float:
        square = float(np.sum(np.linalg.inv(information) * everywhere)) / (_ROWS * len(told))
        return peak_n * _UNEXPLAINED * sqrt(square)

    before_n = disagreement_n(known)
    chosen: list[NextPress] = []
    for _ in range(count):
        left_n = [disagreement_n(known + own) for own in told]
        best = int(np.argmin(left_n))
        chosen.append(replace(candidates[best], before_n=before_n, after_n=left_n[best]))
        before_n, known = left_n[best], known + told[best]
    return chosen


def possible_presses(peak_n: float, band_hz: tuple[float, float]) -> list[NextPress]:
    """Cycles as slow and as fast as a hand's, and holds, up to the greatest recorded force.

    Slower where the recordings are; at most four times as fast as they are.
    """
    slow_hz, fast_hz = band_hz
    high_hz = min(_BEYOND * fast_hz, _HAND_HZ[1])
    low_hz = min(max(slow_hz, _SLOWEST_HZ), _HAND_HZ[0], high_hz)
    octaves = round(np.log2(high_hz / low_hz))
    found = []
    for share in _SHARES:
        amplitude_n = _rounded_down(share * peak_n)
        for frequency_hz in np.geomspace(low_hz, high_hz, 1 + octaves).tolist():
            near_hz = _rounded_down(frequency_hz)
            cycles = max(1, round(near_hz * _LASTS_S))
            found.append(NextPress(amplitude_n, near_hz, cycles))
        found.append(NextPress(amplitude_n, hold_s=_HOLD_S))
    return found


def _greatest_n(recording: Recording) -> float:
    """The force that more samples reach than a glitch has: a protocol will press as hard."""
    own = np.sort(recording.force_n)[::-1]
    return float(own[min(LONGEST_SPIKE, len(own) // 20)])


def _recorded_shares(
    recordings: Sequence[Recording], depths_m: Sequence[Samples]
) -> Iterator[tuple[Samples, float]]:
    """Each recording's position as the share of the greatest force that it stands for; dt, s.

    By the median of force along position: where an object is stiff, bands of force are thin.
    """
    steps = [-(-len(recording.force_n) // _MAX_SAMPLES) for recording in recordings]
    pairs = list(zip(recordings, steps, strict=True))
    force_n = np.concatenate([recording.force_n[::step] for recording, step in pairs])
    thinned_m = [own_m[::step] for own_m, step in zip(depths_m, steps, strict=True)]
    depth = np.concatenate(thinned_m)
    bins = np.array_split(np.argsort(depth, kind="stable"), min(_BINS, len(depth)))
    rising_n = np.maximum.accumulate([np.median(force_n[rows]) for rows in bins])
    share = (rising_n - rising_n[0]) / (np.ptp(rising_n) or 1.0)
    at_m = [float(depth[rows].mean()) for rows in bins]
    for own_m, (recording, step) in zip(thinned_m, pairs, strict=True):
        yield np.interp(own_m, at_m, share), step * recording.dt_s


def _information(share: Samples, dt_s: float, tau_s: Samples) -> _Square:
    """Information of a press about the weights: their precision, (weights, weights)."""
    rows = np.linspace(0, len(share) - 1, _ROWS).astype(np.intp)
    bands = np.clip(_BANDS * share - np.arange(_BANDS)[:, None], 0.0, 1.0) / _BANDS
    passed = [band[rows] for band in bands]
    passed += [highpass(band, float(tau), dt_s)[rows] for tau in tau_s for band in bands]
    values = np.stack(passed, axis=1) / _UNEXPLAINED
    return np.asarray(values.T @ values, dtype=np.float64)


def _prior() -> _Square:
    """Covariance of the weights before any recording: springs, then branches by time constant."""
    middle = (np.arange(_BANDS) + 0.5) / _BANDS
    alike = np.exp(-0.5 * ((middle[:, None] - middle) / _ALIKE) ** 2) + 1e-6 * np.eye(_BANDS)
    return np.kron(np.diag([_SPRING**2] + _TAUS * [_BRANCH**2]), alike).astype(np.float64)


def _rounded_down(value: float) -> float:
    """Two significant digits, never more than the value."""
    digit = 10.0 ** (floor(log10(value)) - 1)
    return float(f"{floor(value / digit * (1 + 1e-12)) * digit:.2g}")
