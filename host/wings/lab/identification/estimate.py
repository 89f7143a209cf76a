"""From a run to what the device is: fit, intervals, sensors, and what is not to be told."""

import numpy as np

from springpot import SpringpotError
from springpot.host.wings.lab.identification.first_guess import first_guess
from springpot.host.wings.lab.identification.fit import MotionFit, fit_motion
from springpot.host.wings.lab.identification.free_motion import FreeMotion
from springpot.host.wings.lab.identification.result import DeviceMeasured, Identified, judged
from springpot.host.wings.lab.identification.sensors import position_step, velocity_noise

_STEP_NOISE = 0.3  # rms of a step's rounding, of the step
_MISFIT, _MAX_MISFIT = 1.5, 3.0


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
    """rms of what changes from tick to tick in the residual, m: noise, and no motion."""
    return float(np.sqrt(np.mean(np.diff(fit.residual_m, n=2, axis=1) ** 2) / 6))


def _widening(misfit: float) -> float:
    """Of the intervals, where the device is not as the model: what is left is no chance then."""
    return min(misfit, _MAX_MISFIT) if misfit > _MISFIT else 1.0


def _delay_hidden(widen: float, dt_s: float) -> str:
    if widen > 1.0:
        return "samples or forces came unevenly, or the device is not as the model"
    return f"samples come every {1e3 * dt_s:g} ms"


def _promised(max_n: float | None) -> Identified:
    if max_n is None:
        return Identified(why="the device promises none, and the test does not try")
    return Identified(max_n, max_n, max_n)
