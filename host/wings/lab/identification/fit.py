"""The fit: the model is simulated in short segments, each with a beginning of its own, and its
parameters are moved until positions agree best (multiple shooting, output error, Gauss-Newton)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.host.wings.lab.identification.free_motion import FreeMotion
from springpot.host.wings.lab.identification.motion_model import ModelLanes, simulate_lanes

Matrix = NDArray[np.float64]

_SEGMENT_S = 0.4
_ROUNDS, _DONE = 25, 1e-5
# Steps of the differences: kg (a share), N s/m, N, N, s, m, m/s.
_STEPS = np.array([1e-4, 1e-4, 1e-5, 1e-5, 2e-6, 1e-7, 1e-5])
_MIN_VALUES = np.array([1e-4, 0.0, 0.0, -np.inf, 0.0])
_COUNT = len(_MIN_VALUES)
_MAX_DAMPING = 1e6
_STATE_SCALE = np.array([1e-6, 1e-4])
_BEGIN_S = 0.012  # that give a segment's first position and velocity
# 97.5 % of Student's t for 8, 12, 16, 20, 30 and many degrees of freedom.
_FREEDOM, _STUDENT = (8, 12, 16, 20, 30, 1000), (2.31, 2.18, 2.12, 2.09, 2.04, 1.96)


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
        return float(np.sqrt(np.mean(self.residual_m**2)))


class _Segments:
    """Data in segments of equal length, and the simulation of all of them."""

    def __init__(self, motion: FreeMotion) -> None:
        self.motion = motion
        self.ticks = round(_SEGMENT_S / motion.dt_s)
        self.begins = np.arange(0, len(motion.position_m) - self.ticks + 1, self.ticks)
        places = self.begins[:, None] + np.arange(self.ticks)
        self.position_m, self.weight = motion.position_m[places], motion.fresh[places].astype(float)

    def first_states(self) -> Matrix:
        """Position and velocity at each begin, of a line or a curve through its first ticks."""
        time_s = np.arange(max(4, round(_BEGIN_S / self.motion.dt_s))) * self.motion.dt_s
        found = np.polynomial.polynomial.polyfit(time_s, self.position_m[:, : len(time_s)].T, 2)
        return np.column_stack([found[0], found[1]])

    def simulate(self, values: Matrix, states: Matrix) -> tuple[Matrix, Matrix]:
        """values: (k, 5), states: (k, segments, 2); positions and velocities (k, segments, n)."""
        copies, count = len(values), len(self.begins)
        lanes = np.repeat(values, count, axis=0).T
        positions_m, velocities_mps = simulate_lanes(
            ModelLanes(*lanes), self.motion.force_n, np.tile(self.begins, copies), self.ticks,
            self.motion.dt_s, states[:, :, 0].ravel(), states[:, :, 1].ravel(),
        )  # fmt: skip
        shape = (copies, count, self.ticks)
        return positions_m.reshape(shape), velocities_mps.reshape(shape)

    def linearise(self, values: Matrix, states: Matrix) -> tuple[Matrix, Matrix]:
        """Residual (segments, n) and Jacobian of the positions (segments, n, 7)."""
        steps = _STEPS * np.array([values[0], *np.ones(6)])
        many_values = np.tile(values, (len(steps) + 1, 1))
        many_states = np.tile(states, (len(steps) + 1, 1, 1))
        for k, step in enumerate(steps):
            if k < _COUNT:
                many_values[k + 1, k] += step
            else:
                many_states[k + 1, :, k - _COUNT] += step
        positions_m, _ = self.simulate(many_values, many_states)
        slopes = (positions_m[1:] - positions_m[0]) / steps[:, None, None]
        residual_m = (self.position_m - positions_m[0]) * self.weight
        return residual_m, np.moveaxis(slopes, 0, 2) * self.weight[:, :, None]


def fit_motion(motion: FreeMotion, guess: Matrix) -> MotionFit:
    """MotionFit from a first guess of the five values, (5,)."""
    segments = _Segments(motion)
    values, states = np.maximum(guess, _MIN_VALUES), segments.first_states()
    damping = 1e-3
    residual_m, slopes = segments.linearise(values, states)
    for _ in range(_ROUNDS):
        cost = float(np.sum(residual_m**2))
        change, state_change = _step(residual_m, slopes, damping)
        new_values = np.maximum(values + change, _MIN_VALUES)
        new_values[0] = np.clip(new_values[0], values[0] / 3, values[0] * 3)
        new_states = states + state_change
        with np.errstate(all="ignore"):  # a step may go anywhere, and is taken back then
            new_residual_m, new_slopes = segments.linearise(new_values, new_states)
            new_cost = float(np.sum(new_residual_m**2))
        done = abs(cost - new_cost) < _DONE * cost
        if not new_cost < cost:
            damping *= 10.0
            if done or damping > _MAX_DAMPING:
                break
            continue
        values, states, residual_m, slopes = new_values, new_states, new_residual_m, new_slopes
        damping = max(damping / 10, 1e-9)
        if done:
            break
    half_width = _half_width(residual_m, slopes)
    _, velocity_mps = segments.simulate(values[None], states[None])
    return MotionFit(values, half_width, residual_m, velocity_mps[0], segments.begins)


def _without_states(residual_m: Matrix, slopes: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """Residual and slopes of the five values, less what the states of each segment explain."""
    basis, _ = np.linalg.qr(slopes[:, :, _COUNT:])
    own = slopes[:, :, :_COUNT]
    rest_m = residual_m - np.einsum("snl,sl->sn", basis, np.einsum("snl,sn->sl", basis, residual_m))
    rest = own - np.einsum("snl,slp->snp", basis, np.einsum("snl,snp->slp", basis, own))
    return rest_m, rest, basis


def _step(residual_m: Matrix, slopes: Matrix, damping: float) -> tuple[Matrix, Matrix]:
    rest_m, rest, _ = _without_states(residual_m, slopes)
    normal = np.einsum("snp,snq->pq", rest, rest)
    scale = np.sqrt(np.diag(normal)) + 1e-30
    pull = np.einsum("snp,sn->p", rest, rest_m) / scale
    scaled = normal / np.outer(scale, scale) + damping * np.eye(_COUNT)
    change = np.linalg.solve(scaled, pull) / scale
    left_m = residual_m - slopes[:, :, :_COUNT] @ change
    states = slopes[:, :, _COUNT:]
    own = np.einsum("snk,snl->skl", states, states)
    least = np.diag(_STATE_SCALE)  # a tool that sticks at once says nothing of its first speed
    own = own * (1 + damping * np.eye(2)) + least
    pulls = np.einsum("snk,sn->sk", states, left_m)
    return change, np.linalg.solve(own, pulls[:, :, None])[:, :, 0]


def _half_width(residual_m: Matrix, slopes: Matrix) -> Matrix:
    """Half of the interval of 95 %: the wider of two. One takes residuals as independent from
    tick to tick, the other from segment to segment only."""
    rest_m, rest, _ = _without_states(residual_m, slopes)
    count, ticks = residual_m.shape
    normal = np.einsum("snp,snq->pq", rest, rest)
    inverse = np.linalg.pinv(normal, hermitian=True)
    pulls = np.einsum("snp,sn->sp", rest, rest_m)
    freedom = count - _COUNT
    by_segment = inverse @ (pulls.T @ pulls) @ inverse * count / freedom
    by_tick = inverse * np.sum(rest_m**2) / (count * (ticks - 2) - _COUNT)
    variance = np.maximum(np.diag(by_segment), np.diag(by_tick))
    half_width: Matrix = np.interp(freedom, _FREEDOM, _STUDENT) * np.sqrt(variance)
    return half_width
