"""Small motions about a depth: whether a model's force takes energy from the hand, or gives it."""

from collections.abc import Callable

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.model.model import Model

DEPTH_FRACTIONS = (0.2, 0.35, 0.5, 0.65, 0.8)  # of the trained depth
AMPLITUDE_FRACTIONS = (0.01, 0.05)
MIN_SIN_DELTA = -0.005  # a cell below this sin(delta) gives energy to the hand
_FREQUENCIES_HZ = np.geomspace(2.0, 80.0, 6)  # at 1 kHz and above
_MEASURED_S, _SETTLE_S = 0.25, 0.2


class SmallMotion:
    """A sine from a hold, whole periods of which are measured once it has settled."""

    def __init__(self, frequency_hz: float, dt_s: float, delay_samples: int = 0) -> None:
        """delay_samples: how late the force is taken."""
        slower = max(1.0, dt_s / 1e-3)
        cycles = max(1, round(_MEASURED_S * slower * frequency_hz))
        self._period = round(cycles / (frequency_hz * dt_s))
        self._turn = 2.0 * np.pi * cycles / self._period
        self._settle = round(_SETTLE_S * slower / dt_s) + self._period // cycles
        self._delay, self._dt_s = delay_samples, dt_s
        self._ticks = np.arange(self._settle + self._period + delay_samples)

    def motion(self, at_m: float, amplitude_m: float) -> tuple[Samples, Samples]:
        """Positions (n,), m, and velocities (n,), m/s."""
        phase = self._turn * self._ticks
        velocity_mps = amplitude_m * self._turn / self._dt_s * np.cos(phase)
        return at_m + amplitude_m * np.sin(phase), velocity_mps

    def min_sin_delta(
        self, force_n: Callable[[Samples, Samples], Samples], at_m: float, span_m: float
    ) -> float:
        """Return the lower `sin_delta` of two amplitudes; force_n: of positions and velocities.

        The force of a hold is taken off: an object that relaxes there, or that recovers from
        earlier presses, is not active for it.
        """
        still_n, *moved_n = (
            force_n(*self.motion(at_m, amplitude * span_m)).astype(np.float64)
            for amplitude in (0.0, *AMPLITUDE_FRACTIONS)
        )
        return min(self.sin_delta(each_n - still_n) for each_n in moved_n)

    def sin_delta(self, force_n: Samples) -> float:
        """Return the loss part of the force's fundamental over its size; below 0 it gives energy.

        0 where the force does not change. force_n: at each tick of `motion`, (n,), N.
        """
        part = slice(self._settle, self._settle + self._period)
        measured_n = force_n[part]
        phase = self._turn * (self._ticks[part] + self._delay)
        stored_n, lost_n = np.mean(measured_n * np.sin(phase)), np.mean(measured_n * np.cos(phase))
        size_n = float(np.hypot(stored_n, lost_n))
        if np.ptp(measured_n) == 0.0 or size_n == 0.0:
            return 0.0
        return float(lost_n / size_n)


def scale_frequencies_hz(dt_s: float) -> Samples:
    """Frequencies of a map's columns."""
    return _FREQUENCIES_HZ * min(1.0, 1e-3 / dt_s)


def count_active_cells(model: Model) -> int:
    """Depths and frequencies within the trained depth at which a model's force gives energy."""
    from springpot.trainer.models.predict import predict_n  # what judges C loads no scipy
    from springpot.trainer.recordings.recording import Recording

    trained, active = model.trained, 0
    base_m = 0.0 if model.contact == "surface" else trained.min_m
    span_m = trained.max_m - base_m

    def force_n(position_m: Samples, _: Samples) -> Samples:
        motion = Recording("sine", position_m, np.zeros_like(position_m), model.dt_s)
        return predict_n(model, motion)

    for frequency_hz in scale_frequencies_hz(model.dt_s):
        sine = SmallMotion(float(frequency_hz), model.dt_s)
        for share in DEPTH_FRACTIONS:
            active += sine.min_sin_delta(force_n, base_m + share * span_m, span_m) < MIN_SIN_DELTA
    return active
