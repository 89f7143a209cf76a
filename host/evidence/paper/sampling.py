"""How the paper's features and models bear another sampling time (its figures 14, 19 and 20)."""

from dataclasses import dataclass

import numpy as np
from scipy import signal

from springpot import Recording
from springpot.codegen.arrays import Samples, rms
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.reference.run import run_reference
from springpot.host.evidence.paper.reproduce import Modelled, plain_scene
from springpot.host.native.scene_library import SceneLibrary
from springpot.trainer.features.fractional import fir_derivatives, gl_taps

TAPS = 171
STEP_S = 1e-3
SLOW_S = 1.27e-3  # one tick of RF-FD on the paper's computer
STEPS_S = (0.8e-3, 1.0e-3, 1.2e-3)
SHOWN_ORDERS = (0.0, 0.25, 0.5, 0.75, 1.0)


@dataclass(frozen=True, eq=False)
class Resampled:
    """One motion rendered every 1.27 ms and every 1 ms; all arrays of shape (n,)."""

    slow_time_s: Samples
    slow_n: Samples
    time_s: Samples
    force_n: Samples

    @property
    def difference_n(self) -> Samples:
        """Force at 1.27 ms minus force at 1 ms, at the times of the latter."""
        slow_n: Samples = np.interp(self.time_s, self.slow_time_s, self.slow_n)
        return slow_n - self.force_n


def resampled(model: Modelled, recording: Recording) -> Resampled:
    """Run the built C on a motion sampled every 1.27 ms, with taps made for its own step."""
    time_s = np.arange(len(recording.position_m), dtype=np.float64) * recording.dt_s
    slow_time_s = np.arange(0.0, time_s[-1], recording.dt_s * SLOW_S / STEP_S)
    slow_m: Samples = np.interp(slow_time_s, time_s, recording.position_m)
    # What was rendered, interpolated to an exact step, as the paper does.
    position_m: Samples = np.interp(time_s, slow_time_s, slow_m)
    library = SceneLibrary(model.folder)
    slow_n, force_n = (
        library.new_state().run(motion)[0].astype(np.float64) for motion in (slow_m, position_m)
    )
    return Resampled(slow_time_s, slow_n, time_s, force_n)


def coupled_force(model: Modelled, recording: Recording) -> Samples:
    """Compute the force behind the paper's virtual coupling by the reference of the C, (n,), N."""
    plan = make_plan(model.fit.model, plain_scene("coupled", mode="tool"))
    position_m = recording.position_m.astype(plan.dtype)
    velocity_mps = np.diff(position_m, prepend=position_m[:1]) / plan.dtype(plan.dt_s)
    force_n: Samples = run_reference(plan, position_m, velocity_mps).force_n.astype(float)
    return smoothed_0_7(force_n)


def smoothed_0_7(force_n: Samples) -> Samples:
    """Smooth by the paper's exponential moving average: weight 0.7 on the newest sample."""
    held_n: Samples = signal.lfilter([0.7], [1.0, -0.3], force_n, zi=0.3 * force_n[:1])[0]
    return held_n


def example_press(dt_s: float, duration_s: float = 1.0) -> Samples:
    """Return a press of 10 mm at 1 Hz, as in the paper's training data, m."""
    time_s = np.arange(round(duration_s / dt_s)) * dt_s
    press_m: Samples = 0.005 * (1.0 - np.cos(2.0 * np.pi * time_s))
    return press_m


def derivative(order: float, dt_s: float, taps_dt_s: float) -> Samples:
    """Differentiate the example press sampled every dt_s, with 171 taps made for `taps_dt_s`."""
    taps = gl_taps(order, TAPS, taps_dt_s)[:, None]
    return fir_derivatives(example_press(dt_s), taps)[:, 0]


def relative_change(order: float, dt_s: float, own_taps: bool) -> float:
    """Return RMS change of D^order against 1 ms, relative; with taps of its own step or of 1 ms."""
    reference = derivative(order, STEP_S, STEP_S)
    other = derivative(order, dt_s, dt_s if own_taps else STEP_S)
    time_s, other_s = (np.arange(len(v)) * h for v, h in ((reference, STEP_S), (other, dt_s)))
    return rms(np.interp(time_s, other_s, other) - reference) / rms(reference)
