"""Work-precision: error against run time of the filter engines and of the coupling's integrators.

    python tests/bench/work_precision.py docs/work-precision.svg

Filters: half derivative of a sine of 2 Hz against the true one, and ns a tick of the emitted C,
whose regressor is one split. Integrators: force of the coupling on a tapping tool after 1 s,
against a step of 1 us.
"""

import sys
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from springpot.codegen.coupling import couple_config
from springpot.codegen.ir import Features, FirBank, Forest, Model, TrainedRange
from springpot.codegen.plan import make_plan
from springpot.codegen.reference_tick import Coupled
from springpot.codegen.scene import Coupling, Guard, Scene
from springpot.host.figures import ERROR, MEASURED, PREDICTED, STYLE, svg_text
from springpot.host.replay import Replay
from springpot.host.trial_build import built
from springpot.trainer.exponentials import recursive_bank
from springpot.trainer.fractional import gl_taps

DT_S, ORDER, DEPTH_M = 1e-3, 0.5, 0.01
PAPER = Coupling("tool", 1500.0, 20.0, 0.05)


def filter_point(features: Features) -> tuple[float, float]:
    """Run time (ns) and relative RMS error of one engine."""
    leaf = Forest(
        feature=np.array([0, -1, -1], dtype=np.int32), threshold=np.zeros(3),
        left=np.array([1, 0, 0], dtype=np.int32), right=np.array([2, 0, 0], dtype=np.int32),
        value_n=np.array([0.0, 1.0, 2.0]), roots=np.array([0], dtype=np.int32), weight=1.0,
        bias_n=0.0,
    )  # fmt: skip
    trained = TrainedRange(0.0, DEPTH_M, 0.2, 0.0, 10.0)
    model = Model("rf-fd", "x", DT_S, "surface", trained, features, leaf, None, False)
    scene = Scene(1, "x", "x", coupling=Coupling("off"), guard=Guard(outside="hold"))
    plan = make_plan(model, scene)
    turn = 2.0 * np.pi * 2.0
    time_s = np.arange(8000) * DT_S
    depth = (0.5 * DEPTH_M * (1.0 + np.sin(turn * time_s))).astype(np.float32)
    assert plan.features is not None
    found = plan.features.reference(depth, np.array([0]))[6000:, 0].astype(np.float64)
    true = 0.5 * DEPTH_M * turn**ORDER * np.sin(turn * time_s + ORDER * np.pi / 2)[6000:]
    error = np.sqrt(np.mean((found - found.mean() - true) ** 2) / np.mean(true**2))
    with built(plan) as library:
        ticks = Replay(library).tick_times(depth, np.zeros_like(depth), DT_S, 0.1)
    return ticks.hot_median, float(error)


def integrator_force(step_s: float, printed: bool) -> float:
    """Force after 1 s of a 6 Hz tool whose model is a spring of 1 N/mm."""
    couple = Coupled(couple_config(PAPER, step_s, np.float64))
    x_p = v_p = force = 0.0
    for i in range(round(1.0 / step_s) + 1):
        t = i * step_s
        x, v = 0.004 * (1 - np.cos(37.0 * t)), 0.148 * np.sin(37.0 * t)
        model_n = 1000.0 * x
        if printed:
            force = -PAPER.stiffness_npm * (x_p - x) - PAPER.damping_nspm * (v_p - v)
            v_p += step_s * (force - model_n) / PAPER.mass_kg
            x_p += step_s * v_p
        else:
            force = couple.force(x, v, model_n)
    return force


def main(path: Path) -> None:
    taps = {
        length: filter_point(FirBank((ORDER,), gl_taps(ORDER, length, DT_S)[:, None]))
        for length in (21, 43, 86, 171, 342, 684, 1368)
    }
    poles = {
        window: filter_point(replace(recursive_bank((ORDER,), DT_S, window), orders=(ORDER,)))
        for window in (0.1, 1.0, 10.0)
    }
    truth = integrator_force(1e-6, printed=False)
    steps = np.array([4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4])
    for printed in (True, False):
        for step in steps:
            print("printed" if printed else "exact", step, integrator_force(step, printed) - truth)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 3.4), layout="constrained")
        left, right = figure.subplots(1, 2)
        for points, color, label in ((taps, ERROR, "taps"), (poles, PREDICTED, "window, s, poles")):
            times, errors = zip(*points.values(), strict=True)
            left.loglog(times, errors, "o-", color=color, label=label)
            for name, x, y in zip(points, times, errors, strict=True):
                left.annotate(f"{name:g}", (x, y), fontsize=7, xytext=(3, 3),
                              textcoords="offset points")  # fmt: skip
                print(label, name, f"{x:.0f} ns", f"{y:.2e}")
        left.set_xlabel("whole tick, hot, ns")
        left.set_ylabel("relative error of the half derivative at 2 Hz")
        left.legend(frameon=False)
        left.set_xticks([20, 50, 100, 200, 500, 1000], ["20", "50", "100", "200", "500", "1000"])
        left.minorticks_off()
        for printed, color in ((True, MEASURED), (False, PREDICTED)):
            errors = [max(abs(integrator_force(s, printed) - truth), 1e-9) for s in steps]
            name = "printed (semi-implicit Euler)" if printed else "exact"
            right.loglog(1e3 * steps, errors, "o-", color=color, label=name)
        right.set_xlabel("step of the coupling, ms (both: about ten multiplications)")
        right.set_ylabel("error of the force, N")
        right.legend(frameon=False)
        right.set_xticks(list(1e3 * steps), [f"{1e3 * step:g}" for step in steps])
        right.minorticks_off()
        path.write_text(svg_text(figure))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
