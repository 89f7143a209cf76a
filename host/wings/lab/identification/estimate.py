"""From a run to what the device is: fit, intervals, sensors; and what stays unknown, with why."""

import numpy as np

from springpot import SpringpotError
from springpot.basics import Samples
from springpot.host.wings.lab.identification.fit import Matrix, MotionFit, first_guess, fit_motion
from springpot.host.wings.lab.identification.free_motion import FreeMotion
from springpot.host.wings.lab.identification.result import DeviceMeasured, Identified, judged

_MIN_LEVELS = 20  # of positions, to tell a step
_GRID_ERROR = 0.1  # of the step: positions lie no farther from its multiples
_STUDENT_SEGMENTS = 2.1
_STEP_NOISE = 0.3  # rms of a step's rounding, of the step
_MISFIT, _MAX_MISFIT = 1.5, 3.0


def position_step(position_m: Samples) -> Identified:
    """Return the smallest step of positions (n,), if they are multiples of one."""
    levels_m = np.unique(position_m)
    gaps_m = np.diff(levels_m)
    gaps_m = gaps_m[gaps_m > 1e-6 * np.ptp(levels_m) / len(levels_m)]
    if len(gaps_m) < _MIN_LEVELS:
        return Identified(why=f"{len(gaps_m) + 1} positions were seen: too few to tell their step")
    step_m = float(np.median(gaps_m[gaps_m < 1.5 * np.quantile(gaps_m, 0.05)]))
    for _ in range(3):
        counts = np.round(gaps_m / step_m)
        step_m = float(np.sum(counts * gaps_m) / np.sum(counts**2))
    error = np.sqrt(np.mean((gaps_m / step_m - np.round(gaps_m / step_m)) ** 2))
    if error > _GRID_ERROR:
        max_step_m = float(np.median(gaps_m))
        why = f"positions are multiples of no step: it is below {1e6 * max_step_m:.2g} um"
        return Identified(None, 0.0, max_step_m, why)
    half_width_m = 2 * float(error) * step_m / np.sqrt(len(gaps_m)) + 1e-6 * step_m
    return Identified(step_m, step_m - half_width_m, step_m + half_width_m)


def velocity_noise(motion: FreeMotion, fit: MotionFit) -> Identified:
    """Estimate the noise of the device's velocity about the fitted one, less its own lag."""
    ticks = fit.residual_m.shape[1]
    places = fit.begins[:, None] + np.arange(ticks)
    seen_mps = motion.velocity_mps[places]
    if not np.isfinite(seen_mps).all() or not np.any(seen_mps):
        return Identified(why="the device gives no velocity")
    rest_mps = _without_lag(seen_mps, fit.velocity_mps, motion.dt_s)
    by_segment = np.mean(rest_mps**2, axis=1)
    variance = float(np.mean(by_segment))
    spread = _STUDENT_SEGMENTS * float(np.std(by_segment)) / np.sqrt(len(by_segment))
    value = np.sqrt(variance)
    if spread > 0.36 * variance:  # of the variance: twice as much as of its root, and some
        why = "it depends on the motion: a filter of the device's own, or friction, shows in it"
        return Identified(None, 0.0, float(np.sqrt(variance + spread)), why)
    low, high = np.sqrt(variance - spread), np.sqrt(variance + spread)
    return Identified(float(value), float(low), float(high))


def _without_lag(seen_mps: Matrix, true_mps: Matrix, dt_s: float) -> Matrix:
    """Subtract what a scale and a lag of up to the second order explain."""
    slope = np.gradient(true_mps, dt_s, axis=1)
    bend = np.gradient(slope, dt_s, axis=1)
    table = np.stack([true_mps.ravel(), slope.ravel(), bend.ravel()], axis=1)
    found, *_ = np.linalg.lstsq(table, seen_mps.ravel(), rcond=None)
    rest: Matrix = seen_mps - (table @ found).reshape(seen_mps.shape)
    return rest


def estimate_device(
    motion: FreeMotion, quiet: FreeMotion, sign: int, max_n: float | None, url: str
) -> DeviceMeasured:
    """Find what the device is, from a run that swung it and one before which it rested.

    sign: of the force. max_n: that the device promises.
    Raises SpringpotError where the motion contradicts the sign.
    """
    try:
        guess = np.array(first_guess(motion))
    except ValueError:
        raise SpringpotError(
            f"{url}: moved against the force: something else moves it (a hand, gravity, a spring): "
            "let go of it, lay it so that it stays where it is, or give more force with "
            "--max-force-n"
        ) from None
    fit = fit_motion(motion, guess)
    step = position_step(
        np.concatenate([motion.position_m[motion.fresh], quiet.position_m[quiet.fresh]])
    )
    sensor_m = max(_white_m(fit), _STEP_NOISE * (step.value or 0.0))
    widen = _widening(fit.rms_m / sensor_m if sensor_m > 0 else 1.0)
    mass_kg, viscous_nspm, coulomb_n, bias_n, delay_s = fit.values
    mass, viscous, coulomb, bias, delay = widen * fit.half_width
    more = "more force (--max-force-n) or more travel (--max-travel-mm) shows it better"
    return DeviceMeasured(
        mass_kg=judged(mass_kg, mass, "kg", 1, more),
        viscous_nspm=judged(
            viscous_nspm, viscous, "N s/m", 1, f"hidden under {coulomb_n:.2g} N of other friction"
        ),
        coulomb_n=judged(coulomb_n, coulomb, "N", 1, "too small beside the other forces"),
        delay_s=judged(delay_s, delay, "ms", 1e3, _delay_hidden(widen, motion.dt_s)),
        position_step_m=step,
        velocity_noise_mps=velocity_noise(motion, fit),
        force_sign=Identified(sign, sign, sign),
        max_force_n=_promised(max_n),
        bias_n=Identified(float(bias_n), float(bias_n - bias), float(bias_n + bias)),
        position_noise_m=float(np.std(quiet.position_m)),
        residual_m=fit.rms_m,
        sensor_m=sensor_m,
    )


def _white_m(fit: MotionFit) -> float:
    """Return rms of what changes from tick to tick in the residual, m: noise, and no motion."""
    return float(np.sqrt(np.mean(np.diff(fit.residual_m, n=2, axis=1) ** 2) / 6))


def _widening(misfit: float) -> float:
    """Return the factor of all intervals: above 1 if the misfit is more than chance."""
    return min(misfit, _MAX_MISFIT) if misfit > _MISFIT else 1.0


def _delay_hidden(widen: float, dt_s: float) -> str:
    if widen > 1.0:
        return "samples or forces came unevenly, or the device is not as the model"
    return f"samples come every {1e3 * dt_s:g} ms"


def _promised(max_n: float | None) -> Identified:
    if max_n is None:
        return Identified(why="the device promises none, and the test does not try")
    return Identified(max_n, max_n, max_n)
