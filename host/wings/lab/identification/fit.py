"""The fit: a first guess by one linear fit a delay; then the model, simulated in short segments
with a beginning of their own, until positions agree best (multiple shooting, least squares).

For the guess, a weight w that vanishes with its slope at both ends moves the derivatives from the
position onto itself: m int(w'' x) - b int(w' x) + F_c int(w sign v) + bias int(w) = int(w F)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, ndimage, optimize, stats

from springpot.basics import Samples
from springpot.host.wings.lab.identification.free_motion import FreeMotion
from springpot.host.wings.lab.identification.motion_model import ModelLanes, simulate_lanes
from springpot.validation import rms

Matrix = NDArray[np.float64]

_WINDOW_S, _STRIDE_S, _SMOOTH_S = 0.06, 0.005, 0.005
_MAX_DELAY_S, _DELAY_STEP_S = 0.012, 0.0005
_MIN_KG, _MIN_NSPM = 1e-3, 1e-3
_SEGMENT_S = 0.4
_ROUNDS, _DONE = 25, 1e-5
# Steps of the differences: kg (a share), N s/m, N, N, s, m, m/s.
_STEPS = np.array([1e-4, 1e-4, 1e-5, 1e-5, 2e-6, 1e-7, 1e-5])
_MIN_VALUES = np.array([1e-4, 0.0, 0.0, -np.inf, 0.0])
_COUNT = len(_MIN_VALUES)
_BEGIN_S = 0.012  # that give a segment's first position and velocity


def first_guess(motion: FreeMotion) -> tuple[float, float, float, float, float]:
    """Guess mass_kg, viscous_nspm, coulomb_n, bias_n, delay_s. Raises ValueError if the tool moves
    against force_n: what takes most of the force does not resist."""
    dt_s = motion.dt_s
    count, stride = round(_WINDOW_S / dt_s), max(1, round(_STRIDE_S / dt_s))
    at = np.linspace(-1.0, 1.0, count)
    weight = (1 - at**2) ** 3
    slope = np.gradient(weight, dt_s)
    bend = np.gradient(slope, dt_s)
    mean_of = 2 * max(1, round(_SMOOTH_S / dt_s)) + 1
    smooth_m = ndimage.uniform_filter1d(motion.position_m, mean_of, mode="nearest")
    smooth_m = ndimage.uniform_filter1d(smooth_m, mean_of, mode="nearest")
    speed_mps = np.gradient(smooth_m, dt_s)
    position_m = motion.position_m - motion.position_m.mean()

    def windows(values: Samples, weights: Samples) -> Samples:
        return np.correlate(values, weights, "valid")[::stride]

    table = np.column_stack(
        [
            windows(position_m, bend),
            -windows(position_m, slope),
            windows(np.sign(speed_mps), weight),
            windows(np.ones_like(position_m), weight),
        ]
    )
    best: Samples = np.zeros(4)
    best_delay_s, least = 0.0, np.inf
    middle = np.arange(len(motion.force_n)) * dt_s
    for delay_s in np.arange(0.0, _MAX_DELAY_S, _DELAY_STEP_S):
        # Held forces, as a line through the middles of their ticks.
        late_n = np.interp(middle - delay_s, middle + 0.5 * dt_s, motion.force_n)
        target = windows(late_n, weight)
        found, *_ = np.linalg.lstsq(table, target, rcond=None)
        error = float(np.sum((table @ found - target) ** 2))
        if error < least:
            best, best_delay_s, least = found.astype(np.float64), float(delay_s), error
    taken = best[:3] * np.linalg.norm(table[:, :3], axis=0)
    if taken[np.argmax(np.abs(taken))] < 0:
        raise ValueError("it moves against the force")
    mass_kg, viscous_nspm, coulomb_n, bias_n = best
    return (
        float(max(mass_kg, _MIN_KG)),
        float(max(viscous_nspm, _MIN_NSPM)),
        float(max(coulomb_n, 0.0)),
        float(bias_n),
        best_delay_s,
    )


@dataclass(frozen=True)
class MotionFit:
    """values, half_width: mass_kg, viscous_nspm, coulomb_n, bias_n, delay_s; the half of 95 %.

    residual_m: (segments, ticks), measured less simulated. velocity_mps: of the simulation,
    likewise. begins: (segments,), their first ticks.
    """

    values: Matrix
    half_width: Matrix
    residual_m: Matrix
    velocity_mps: Matrix
    begins: NDArray[np.int64]

    @property
    def rms_m(self) -> float:
        return rms(self.residual_m)


class _Segments:
    """Data in segments of equal length, and the simulation of all of them."""

    def __init__(self, motion: FreeMotion) -> None:
        self.motion = motion
        self.ticks = round(_SEGMENT_S / motion.dt_s)
        self.begins = np.arange(0, len(motion.position_m) - self.ticks + 1, self.ticks)
        places = self.begins[:, None] + np.arange(self.ticks)
        self.position_m, self.weight = motion.position_m[places], motion.fresh[places].astype(float)

    def first_states(self) -> Matrix:
        """Return position and velocity at each begin, by a parabola through its first ticks."""
        time_s = np.arange(max(4, round(_BEGIN_S / self.motion.dt_s))) * self.motion.dt_s
        found = np.polynomial.polynomial.polyfit(time_s, self.position_m[:, : len(time_s)].T, 2)
        return np.column_stack([found[0], found[1]])

    def simulate(self, values: Matrix, states: Matrix) -> tuple[Matrix, Matrix]:
        """Simulate values (k, 5) from states (k, segments, 2); returns m, m/s (k, segments, n)."""
        copies, count = len(values), len(self.begins)
        lanes = np.repeat(values, count, axis=0).T
        positions_m, velocities_mps = simulate_lanes(
            ModelLanes(*lanes), self.motion.force_n, np.tile(self.begins, copies), self.ticks,
            self.motion.dt_s, states[:, :, 0].ravel(), states[:, :, 1].ravel(),
        )  # fmt: skip
        shape = (copies, count, self.ticks)
        return positions_m.reshape(shape), velocities_mps.reshape(shape)

    def residual_m(self, values: Matrix, states: Matrix) -> Matrix:
        """Return simulated less measured positions, (segments, n); 0 if a tick had no sample."""
        positions_m, _ = self.simulate(values[None], states[None])
        residual_m: Matrix = (positions_m[0] - self.position_m) * self.weight
        return residual_m

    def jacobian(self, values: Matrix, states: Matrix) -> Matrix:
        """Differentiate the residual: (segments * n, 5 + 2 segments). A segment's positions do not
        depend on the states of another, so that one simulation serves all segments."""
        steps = _STEPS * np.array([values[0], *np.ones(6)])
        many_values = np.tile(values, (len(steps) + 1, 1))
        many_states = np.tile(states, (len(steps) + 1, 1, 1))
        for k, step in enumerate(steps):
            if k < _COUNT:
                many_values[k + 1, k] += step
            else:
                many_states[k + 1, :, k - _COUNT] += step
        positions_m, _ = self.simulate(many_values, many_states)
        slopes = (positions_m[1:] - positions_m[0]) / steps[:, None, None] * self.weight
        own = linalg.block_diag(*np.moveaxis(slopes[_COUNT:], 0, 2))
        return np.hstack([slopes[:_COUNT].reshape(_COUNT, -1).T, own])


def fit_motion(motion: FreeMotion, guess: Matrix) -> MotionFit:
    """Fit the motion from a first guess of the five values, (5,)."""
    segments = _Segments(motion)

    def parts(x: Matrix) -> tuple[Matrix, Matrix]:
        return x[:_COUNT], x[_COUNT:].reshape(-1, 2)

    def residual_m(x: Matrix) -> Matrix:
        return segments.residual_m(*parts(x)).ravel()

    def jacobian(x: Matrix) -> Matrix:
        return segments.jacobian(*parts(x))

    states = segments.first_states().ravel()
    start = np.concatenate([np.maximum(guess, _MIN_VALUES), states])
    minimum = np.concatenate([_MIN_VALUES, np.full_like(states, -np.inf)])
    found = optimize.least_squares(
        residual_m, start, jacobian, (minimum, np.inf), x_scale="jac", ftol=_DONE, max_nfev=_ROUNDS
    )
    left_m = -found.fun.reshape(segments.position_m.shape)
    half_width = _half_width(left_m, jacobian(found.x))
    values, fitted = parts(found.x)
    _, velocity_mps = segments.simulate(values[None], fitted[None])
    return MotionFit(values, half_width, left_m, velocity_mps[0], segments.begins)


def _half_width(residual_m: Matrix, jacobian: Matrix) -> Matrix:
    """Return half of the interval of 95 %, the wider of two: residuals are taken as independent
    from tick to tick, or from segment to segment only."""
    count, ticks = residual_m.shape
    influence = linalg.pinv(jacobian)[:_COUNT].reshape(_COUNT, count, ticks)
    freedom = count - _COUNT
    moved = np.sum(influence * residual_m, axis=2)  # of the values, by each segment
    by_segment = np.sum(moved**2, axis=1) * count / freedom
    left = np.sum(residual_m**2) / (count * (ticks - 2) - _COUNT)
    by_tick = np.sum(influence**2, axis=(1, 2)) * left
    half_width: Matrix = stats.t.ppf(0.975, freedom) * np.sqrt(np.maximum(by_segment, by_tick))
    return half_width
