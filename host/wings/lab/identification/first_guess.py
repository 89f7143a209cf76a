"""A first guess of the model: windows of the motion against smooth weights, one linear fit a delay.

A weight w that vanishes with its slope at both ends moves the derivatives from the position onto
itself: m int(w'' x) - b int(w' x) + F_c int(w sign v) + bias int(w) = int(w F)."""

import numpy as np
from scipy import ndimage

from springpot.basics import Samples
from springpot.host.wings.lab.identification.free_motion import FreeMotion

_WINDOW_S, _STRIDE_S, _SMOOTH_S = 0.06, 0.005, 0.005
_MAX_DELAY_S, _DELAY_STEP_S = 0.012, 0.0005
_MIN_KG, _MIN_NSPM = 1e-3, 1e-3


def first_guess(motion: FreeMotion) -> tuple[float, float, float, float, float]:
    """mass_kg, viscous_nspm, coulomb_n, bias_n, delay_s. Raises ValueError where the tool moves
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
