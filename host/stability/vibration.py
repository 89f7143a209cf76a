"""How the tool vibrates: above 15 Hz, from 0.5 Hz on while a hand holds still, and if it grows."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Samples

HIGH_PASS_HZ, LOW_HZ = 15.0, 0.5
LONG_S = 6.0  # a hold that long shows vibrations from LOW_HZ on, in each third of it
FELT_MPS = 2.5e-4  # growth of less is that of noise and of steps of the encoder
GROWS = 2.0


@dataclass(frozen=True)
class Vibration:
    """Of the worst of some holds; None where none is long enough.

    lf_speed_mps: RMS of the speed from 0.5 to 15 Hz in a hold's last third. growth_ratio: of the
    RMS from 0.5 Hz on, last third over first, or its square over the second third if that is less:
    what grows evenly has the same there, and what has come to its size has 1.
    """

    lf_speed_mps: float | None = None
    growth_ratio: float | None = None

    @property
    def grows(self) -> bool:
        """Whether some hold vibrates more and more."""
        return self.growth_ratio is not None and self.growth_ratio > GROWS


def vibration_of(holds: Sequence[Samples], dt_s: float) -> Vibration:
    """holds: the tool's speed in each, (n,), m/s."""
    found = [_hold(speed_mps, dt_s) for speed_mps in holds if len(speed_mps) * dt_s >= LONG_S]
    if not found:
        return Vibration()
    return Vibration(max(low for low, _ in found), max(growth for _, growth in found))


def _hold(speed_mps: Samples, dt_s: float) -> tuple[float, float]:
    n = len(speed_mps) // 3
    thirds = [speed_mps[i * n : (i + 1) * n] for i in range(3)]
    first, second, last = (max(band_rms(part, dt_s, LOW_HZ), FELT_MPS) for part in thirds)
    low_mps = band_rms(thirds[-1], dt_s, LOW_HZ, HIGH_PASS_HZ)
    return low_mps, min(last / first, (last / second) ** 2)


def high_passed_rms(speed_mps: Samples, dt_s: float) -> float:
    """RMS of a signal above 15 Hz."""
    return band_rms(speed_mps, dt_s, HIGH_PASS_HZ)


def band_rms(signal: Samples, dt_s: float, above_hz: float, up_to_hz: float = np.inf) -> float:
    """RMS of a signal in a band: its spectrum under a Hann window."""
    n = len(signal)
    window = np.hanning(n)
    power = np.abs(np.fft.rfft((signal - signal.mean()) * window)) ** 2
    at_hz = np.fft.rfftfreq(n, dt_s)
    within = (at_hz > above_hz) & (at_hz <= up_to_hz)
    return float(np.sqrt(2.0 * power[within].sum() / (n * np.sum(window**2))))
