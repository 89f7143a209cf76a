"""How late a force sensor is, from the motion that its force and the motor's make together.

Between motor and sensor moves one mass: m a = u(t - d) - b v - c sign(v) - F(t), with the motor's
force u, late by d, and the sensor's F, which is here late by tau: F(t) = F_sensor(t + tau). A fast
press excites the mass, and the least squares of all pairs (tau, d) have one minimum.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, signal, stats

from springpot import DeviceError
from springpot.basics import Samples

CHIRP_S, PRELOAD_N, SWING_N = 4.0, 1.5, 1.3
_RISE_S, _SLOWEST_HZ, _FASTEST_HZ = 0.4, 2.0, 30.0
_SMOOTH_S = 0.003  # of the Gaussian that differentiates
_MAX_LATE_S, _MIN_LATE_S, _MAX_MOTOR_S = 0.040, -0.005, 0.008
_COARSE_S, _FINE_S, _MOTOR_S, _REACH_S = 0.5e-3, 0.05e-3, 0.1e-3, 2e-3
_MOTION = 4  # terms: acceleration, speed, friction, a constant
_BLOCKS = 8
_CREEP_MPS = 2e-3  # below it friction has no clear sign
_MAX_UNEXPLAINED = 0.25  # of the force's standard deviation


@dataclass(frozen=True)
class Delay:
    """How late the sensor's force is behind the position, s; low, high: 95 %.

    motor_s: how late the motor is. mass_kg: what moves between motor and sensor.
    """

    value_s: float
    low_s: float
    high_s: float
    motor_s: float
    mass_kg: float


@dataclass(frozen=True, eq=False)
class ForcedMotion:
    """One press: times t_s, positions and motor forces (positive into the object), each (n,);
    the sensor's own times and forces, each (k,), on the same clock."""

    t_s: Samples
    position_m: Samples
    motor_n: Samples
    sensor_s: Samples
    sensor_n: Samples


def alignment_command(rate_hz: float, share: float = 1.0) -> Samples:
    """Return a chirp around a preload, N, one value a sample; share: of its force."""
    rise = np.linspace(0.0, 1.0, round(_RISE_S * rate_hz)) ** 2
    t_s = np.arange(round(CHIRP_S * rate_hz)) / rate_hz
    chirp = signal.chirp(t_s, _SLOWEST_HZ, CHIRP_S, _FASTEST_HZ, method="logarithmic", phi=-90.0)
    chirp_n = PRELOAD_N + SWING_N * chirp
    command_n = np.concatenate([PRELOAD_N * rise, chirp_n, chirp_n[-1] * rise[::-1]])
    return np.asarray(share * command_n)


def find_delay(motion: ForcedMotion, url: str) -> Delay:
    """Return how late the sensor is. Raises DeviceError where its force does not fit the motion."""
    signals = _Signals(_evenly(motion))
    coarse = _Fit(signals, np.arange(_MIN_LATE_S, _MAX_LATE_S, _COARSE_S),
                  np.arange(0.0, _MAX_MOTOR_S, _COARSE_S))  # fmt: skip
    rough = coarse.best(coarse.whole)
    around_s = np.arange(-_REACH_S, _REACH_S, _MOTOR_S)
    motors_s = rough.motor_s + around_s[around_s >= -rough.motor_s]
    fine = _Fit(signals, rough.late_s + np.arange(-_REACH_S, _REACH_S, _FINE_S), motors_s)
    found = fine.best(fine.whole)
    _require_sense(found, url)
    # The spread of estimates that each leave one stretch of time out (jackknife).
    without = np.array([fine.best(fine.whole - stretch).late_s for stretch in fine.stretches])
    spread_s = np.sqrt((_BLOCKS - 1) / _BLOCKS * np.sum((without - without.mean()) ** 2))
    half_s = float(np.hypot(stats.t.ppf(0.975, _BLOCKS - 1) * spread_s, _FINE_S))
    mass_kg = float(-found.coefficients[1] / found.coefficients[0])
    return Delay(found.late_s, found.late_s - half_s, found.late_s + half_s, found.motor_s, mass_kg)


def _evenly(motion: ForcedMotion) -> ForcedMotion:
    """Resample the press at even times: a loop that was held up makes up for its ticks at once.

    Positions are linear between two; a motor force stays until the next.
    """
    step_s = float(np.median(np.diff(motion.t_s)))
    t_s = np.arange(motion.t_s[0], motion.t_s[-1], step_s)
    held = np.clip(np.searchsorted(motion.t_s, t_s, side="right") - 1, 0, None)
    position_m = np.interp(t_s, motion.t_s, motion.position_m)
    return replace(motion, t_s=t_s, position_m=position_m, motor_n=motion.motor_n[held])


def aligned_force(t_s: Samples, delay_s: float, sensor_s: Samples, sensor_n: Samples) -> Samples:
    """Return the sensor's force at the times t_s (n,), linear between its samples."""
    return np.asarray(np.interp(t_s + delay_s, sensor_s, sensor_n))


@dataclass(frozen=True, eq=False)
class _Found:
    """Coefficients: of the motor's force, acceleration, speed, friction, and a constant."""

    late_s: float
    motor_s: float
    coefficients: Samples
    unexplained: float


class _Signals:
    """All terms of the equation behind the same filter, each (n,); `used`: rows off its ends."""

    def __init__(self, motion: ForcedMotion) -> None:
        self._raw = motion
        self._dt_s = float(np.median(np.diff(motion.t_s)))
        speed_mps = self._smooth(motion.position_m, 1)
        self.motion = np.column_stack(
            [
                self._smooth(motion.position_m, 2),
                speed_mps,
                self._smooth(speed_mps / np.hypot(speed_mps, _CREEP_MPS)),
                np.ones(len(speed_mps)),
            ]
        )
        reach = round((_MAX_LATE_S + 4 * _SMOOTH_S) / self._dt_s)
        t_s, sensor_s = motion.t_s, motion.sensor_s
        off_ends = (np.arange(len(t_s)) >= reach) & (np.arange(len(t_s)) < len(t_s) - reach)
        sensed = (t_s > sensor_s[0] - _MIN_LATE_S) & (t_s < sensor_s[-1] - _MAX_LATE_S)
        self.used = np.flatnonzero(off_ends & sensed)

    def sensor(self, late_s: float) -> Samples:
        raw = self._raw
        return self._smooth(aligned_force(raw.t_s, late_s, raw.sensor_s, raw.sensor_n))

    def motor(self, late_s: float) -> Samples:
        """Delay the motor's force, held for a period each: between two, their mean by time."""
        t_s, raw_n = self._raw.t_s, self._raw.motor_n
        held = np.clip(np.searchsorted(t_s, t_s - late_s, side="right") - 1, 0, None)
        share = np.clip((t_s - late_s - t_s[held]) / self._dt_s, 0.0, 1.0)
        now_n, before_n = raw_n[held], raw_n[np.clip(held - 1, 0, None)]
        return self._smooth(share * now_n + (1.0 - share) * before_n)

    def _smooth(self, values: Samples, order: int = 0) -> Samples:
        """Smooth by a Gaussian, and differentiate `order` times."""
        smooth = ndimage.gaussian_filter1d(values, _SMOOTH_S / self._dt_s, order=order)
        return np.asarray(smooth / self._dt_s**order)


class _Fit:
    """Least squares for every pair of delays, out of sums of products over stretches of time.

    whole, stretches: those sums, over all rows and over each stretch.
    """

    def __init__(self, signals: _Signals, late_s: Samples, motor_s: Samples) -> None:
        self._late_s, self._motor_s = late_s, motor_s
        columns = np.column_stack(
            [signals.motion, *map(signals.motor, motor_s), *map(signals.sensor, late_s)]
        )
        self.stretches = [
            columns[rows].T @ columns[rows] for rows in np.array_split(signals.used, _BLOCKS)
        ]
        self.whole = sum(self.stretches, start=np.zeros_like(self.stretches[0]))

    def best(self, sums: NDArray[np.float64]) -> _Found:
        """Return the pair that leaves least of the sensor's force unexplained."""
        constant = _MOTION - 1
        forces = slice(_MOTION + len(self._motor_s), None)
        squares = np.diag(sums)[forces]
        spread = squares - sums[constant, forces] ** 2 / sums[constant, constant]
        best = _Found(0.0, 0.0, np.zeros(_MOTION + 1), np.inf)
        for number, motor_s in enumerate(self._motor_s):
            known = [_MOTION + number, *range(_MOTION)]
            scale = 1 / np.sqrt(np.diag(sums)[known])
            normal = sums[np.ix_(known, known)] * np.outer(scale, scale)
            right = sums[known, forces] * scale[:, None]
            found = np.linalg.solve(normal, right)
            left = (squares - np.sum(found * right, axis=0)) / spread
            at = int(left.argmin())
            if left[at] < best.unexplained:
                coefficients = found[:, at] * scale
                best = _Found(float(self._late_s[at]), float(motor_s), coefficients, left[at])
        return best


def _require_sense(found: _Found, url: str) -> None:
    share = np.sqrt(max(0.0, found.unexplained))
    if share > _MAX_UNEXPLAINED:
        raise DeviceError(
            f"{url}: {100 * share:.0f} % of its force does not fit the tool's motion: is it "
            "between tool and object, firmly fixed, and along the device's axis?"
        )
    if found.coefficients[0] <= 0:
        raise DeviceError(
            f"{url}: its force falls where the motor pushes harder: turn its sign, &n_per_unit=-1"
        )
