"""The model that is fitted: one mass with viscous and Coulomb friction under a late, held force.

m dv/dt + b v + F_c sign(v) + bias = F(t - d), exact in each piece of constant force, and from
and to rest. Many segments and many parameters go through it at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import exprel

Lanes = NDArray[np.float64]  # one value for each simulated segment, shape (lanes,)

_SHORT = 1e-2  # of m / b: shorter pieces lose digits in a difference
_MIN_NSPM = 1e-9


@dataclass(frozen=True)
class ModelLanes:
    """Parameters of the model, each (lanes,): kg, N s/m, N, N, s."""

    mass_kg: Lanes
    viscous_nspm: Lanes
    coulomb_n: Lanes
    bias_n: Lanes
    delay_s: Lanes


def simulate_lanes(
    model: ModelLanes,
    force_n: NDArray[np.float64],
    begins: NDArray[np.int64],
    ticks: int,
    dt_s: float,
    start_m: Lanes,
    start_mps: Lanes,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return positions, m, and velocities, m/s, at the ticks of each segment, both (lanes, ticks).

    force_n: (n,), positive where it raises the position, held for a tick each. begins: (lanes,),
    the first tick of each segment. start_m, start_mps: where it is then, and how fast.
    """
    whole = np.floor(model.delay_s / dt_s).astype(np.int64)
    late_s = model.delay_s - whole * dt_s
    position_m, velocity_mps = start_m.astype(float), start_mps.astype(float)
    positions_m = np.empty((len(begins), ticks))
    velocities_mps = np.empty_like(positions_m)
    for tick in range(ticks):
        positions_m[:, tick], velocities_mps[:, tick] = position_m, velocity_mps
        newest = begins + tick - whole
        for index, while_s in ((newest - 1, late_s), (newest, dt_s - late_s)):
            acting_n = np.where(index >= 0, force_n[np.clip(index, 0, len(force_n) - 1)], 0.0)
            position_m, velocity_mps = _piece(
                model, acting_n - model.bias_n, while_s, position_m, velocity_mps
            )
    return positions_m, velocities_mps


def _piece(
    model: ModelLanes, drive_n: Lanes, while_s: Lanes, position_m: Lanes, velocity_mps: Lanes
) -> tuple[Lanes, Lanes]:
    """Move through a piece of constant force: to rest, if it comes to rest, and then on or not."""
    resting = velocity_mps == 0.0
    way = np.where(resting, np.sign(drive_n), np.sign(velocity_mps))
    stuck = resting & (np.abs(drive_n) <= model.coulomb_n)
    push_n = drive_n - way * model.coulomb_n
    rest_s = np.where(resting, np.inf, _time_to_rest(model, push_n, velocity_mps))
    first_s = np.minimum(while_s, rest_s)
    position_m, velocity_mps = _slide(
        model, np.where(stuck, 0.0, push_n), first_s, position_m, velocity_mps
    )
    stopped = rest_s < while_s
    if stopped.any():
        moves_on = stopped & (np.abs(drive_n) > model.coulomb_n)
        velocity_mps = np.where(stopped, 0.0, velocity_mps)
        push_n = np.where(moves_on, drive_n - np.sign(drive_n) * model.coulomb_n, 0.0)
        left_s = np.where(moves_on, while_s - first_s, 0.0)
        position_m, velocity_mps = _slide(model, push_n, left_s, position_m, velocity_mps)
    return position_m, velocity_mps


def _time_to_rest(model: ModelLanes, push_n: Lanes, velocity_mps: Lanes) -> Lanes:
    """Return when the velocity passes zero, s; infinite if the push does not oppose it."""
    viscous_nspm = np.maximum(model.viscous_nspm, _MIN_NSPM)
    opposes = push_n * velocity_mps < 0.0
    ratio = np.where(opposes, -velocity_mps / np.where(opposes, push_n, 1.0), 0.0)
    time_s = model.mass_kg / viscous_nspm * np.log1p(viscous_nspm * ratio)
    return np.where(opposes, time_s, np.inf)


def _slide(
    model: ModelLanes, push_n: Lanes, while_s: Lanes, position_m: Lanes, velocity_mps: Lanes
) -> tuple[Lanes, Lanes]:
    """Move without a change of direction: a first-order answer."""
    acceleration = (push_n - model.viscous_nspm * velocity_mps) / model.mass_kg
    speed_share, distance_share = _shares(model.viscous_nspm / model.mass_kg * while_s)
    change_mps = acceleration * while_s * speed_share
    moved_m = while_s * (velocity_mps + 0.5 * while_s * acceleration * distance_share)
    return position_m + moved_m, velocity_mps + change_mps


def _shares(decay: Lanes) -> tuple[Lanes, Lanes]:
    """Return speed and distance gained while it decays by exp(-decay), of those without decay."""
    speed_share = exprel(-decay)
    series = 1.0 - decay / 3.0 * (1.0 - decay / 4.0 * (1.0 - decay / 5.0))
    lasting = np.maximum(decay, _SHORT)
    difference = 2.0 * (1.0 - exprel(-lasting)) / lasting
    return speed_share, np.where(decay < _SHORT, series, difference)
