"""How late a force sensor is, from the motion that its force and the motor's make together.

Between motor and sensor moves one mass: m a = u(t - d) - b v - c sign(v) - F(t), with the motor's
force u, late by d, and the sensor's F, which is here late by tau: F(t) = F_sensor(t + tau). A fast
press excites the mass; u(t - d) is linear in u and its derivatives, and tau alone is sought.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.optimize import minimize_scalar
from scipy.signal import chirp

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DeviceError
from springpot.host.recording.indentation import OPEN_LOOP
from springpot.host.recording.protocols import RATE_HZ

CHIRP_PEAK_N = 2.8  # of the alignment's press
_SMOOTH_S = 0.003  # of the Gaussian that differentiates
_FIRST_S, _LAST_S, _STEP_S = -0.005, 0.040, 1e-3  # where the delay is sought
_CREEP_MPS = 2e-3  # below it friction has no clear sign
_MAX_UNEXPLAINED = 0.25  # of the force's standard deviation
_POLE_RADPS = 600.0  # of the observer: it hears the encoder's steps as little noise
_DAMPING = 0.25  # of the mass per reaction time; a damper so late makes a free tool ring at pi/2
_RESISTANCE = 10.0  # reaction times: its low-pass takes less than half of the damping
_MIN_MASS_KG = 0.05


@dataclass(frozen=True)
class Delay:
    """How late force and motor are behind the position, s; what moves between them, kg."""

    value_s: float
    motor_s: float
    mass_kg: float


def alignment_command(share: float = 1.0) -> Samples:
    """Return a chirp from 2 to 30 Hz on a preload, N, one value each ms; share: of its force."""
    rise, t_s = np.linspace(0.0, 1.0, 400) ** 2, np.arange(4000) / RATE_HZ
    chirp_n = 1.5 + 1.3 * chirp(t_s, 2.0, 4.0, 30.0, method="logarithmic", phi=-90.0)
    return share * np.concatenate([chirp_n[0] * rise, chirp_n, chirp_n[-1] * rise[::-1]])


def find_delay(
    motion: tuple[Samples, Samples, Samples], sensor: tuple[Samples, Samples], url: str
) -> Delay:
    """Return how late the sensor is, of a press by `alignment_command`.

    motion: times, positions and the motor's forces, (n,) each, positive into the object. sensor:
    its times on the same clock and its forces, (k,) both.
    Raises DeviceError where its force does not fit the motion.
    """
    # A loop that was held up makes up for its ticks at once: a force stays until the next.
    t_s, position_m, motor_n = motion
    step_s = float(np.median(np.diff(t_s)))
    even_s = np.arange(t_s[0], t_s[-1], step_s)
    x_m = np.interp(even_s, t_s, position_m)
    u_n = motor_n[np.searchsorted(t_s, even_s, "right") - 1]
    smooth = partial(gaussian_filter1d, sigma=_SMOOTH_S / step_s)
    speed_mps = smooth(x_m, order=1) / step_s
    columns = [smooth(u_n, order=k) / step_s**k for k in range(3)]
    columns += [smooth(x_m, order=2) / step_s**2, speed_mps, np.ones(len(x_m))]
    columns += [smooth(speed_mps / np.hypot(speed_mps, _CREEP_MPS))]
    first_s, last_s = max(t_s[0], sensor[0][0]), min(t_s[-1], sensor[0][-1])
    rows = (even_s > first_s + _LAST_S) & (even_s < last_s - 1.3 * _LAST_S)  # off the ends
    terms = np.stack(columns, axis=1)[rows]

    def fitted(late_s: float) -> tuple[float, Samples]:
        """Share of the variance that is not explained, and the coefficients."""
        force_n = smooth(np.interp(even_s + late_s, *sensor))[rows]
        found = np.linalg.lstsq(terms, force_n)[0]
        return float(np.var(force_n - terms @ found) / np.var(force_n)), found

    near_s = min(np.arange(_FIRST_S, _LAST_S, _STEP_S), key=lambda late_s: fitted(late_s)[0])
    around = (near_s - _STEP_S, near_s + _STEP_S)
    late_s = float(minimize_scalar(lambda late_s: fitted(late_s)[0], bounds=around).x)
    missed, found = fitted(late_s)
    if missed > _MAX_UNEXPLAINED**2:
        raise DeviceError(
            f"{url}: {100 * math.sqrt(missed):.0f} % of its force does not fit the tool's motion: "
            "is it between tool and object, firmly fixed, and along the device's axis?"
        )
    if found[0] <= 0:
        raise DeviceError(
            f"{url}: its force falls where the motor pushes harder: turn its sign, &n_per_unit=-1"
        )
    motor_s = max(0.0, float(-found[1] / found[0]) - step_s / 2)  # a force is held for a step
    return Delay(late_s, motor_s, max(_MIN_MASS_KG, float(-found[3] / found[0])))


def late_gains(delay: Delay) -> Mapping[str, float]:
    """Return gains of sp_press for a late sensor and motor: stable on soft and stiff objects."""
    reaction_s = 1 / RATE_HZ + 1.5 / _POLE_RADPS + delay.motor_s
    return {
        **OPEN_LOOP,
        "mass_kg": delay.mass_kg,
        "pole": math.exp(-_POLE_RADPS / RATE_HZ),
        "damping_nspm": _DAMPING * delay.mass_kg / reaction_s,
        "resistance_share": 1 / (RATE_HZ * _RESISTANCE * reaction_s),
        "motor_late": round(RATE_HZ * delay.motor_s),
        "sensor_late": round(RATE_HZ * max(0.0, delay.value_s - 2.8 / _POLE_RADPS)),
    }
