"""Work-precision of the filter engines and of the coupling's steps, as one picture.

python tests/bench/work_precision.py docs/work-precision.svg

Filters: half derivative of a sine of 2 Hz against the true one, and ns a tick of the emitted C,
whose regressor is one split. Steps: force of the paper's coupling on a tapping tool after 1 s,
against the exact solution, and ticks for that second (either tick: about ten multiplications).
"""

import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy import linalg

from springpot import Coupling, Guard, Model, Scene
from springpot.emission import Coupled, couple_config, make_plan
from springpot.figures import STYLE, svg_text
from springpot.host.wings.evidence.benchmark.figures import DASHES, log_axes
from springpot.modelling import (
    KINDS,
    Features,
    FirBank,
    Forest,
    TrainedRange,
    fast_fir_bank,
    gl_taps,
    recursive_bank,
)
from springpot.native import Replay, built

_DT_S, ORDER, DEPTH_M, TURN = 1e-3, 0.5, 0.01, 2.0 * np.pi * 2.0
PAPER = Coupling("tool", 1500.0, 20.0, 0.05)
SPRING_NPM = 1000.0  # the model under the coupling
TAP_M, TAP_TURN = 0.004, 37.0
_STEPS_S = (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)

Curve = list[dict[str, Any]]  # points of one family: name, time, error


def work_precision() -> dict[str, dict[str, Curve]]:
    """Curves of both, by family; time in ns a tick, or in ticks."""
    truth_n = exact_force()
    return {
        "filters": filter_curves(),
        "integrators": {
            family: [
                {
                    "name": f"{1e3 * step:g} ms",
                    "time": 1.0 / step,
                    "error": abs(stepped_force(step, published) - truth_n),
                }
                for step in _STEPS_S
            ]
            for family, published in (
                ("as published (semi-implicit Euler)", True),
                ("exact step", False),
            )
        },
    }


def filter_curves() -> dict[str, Curve]:
    """Taps of several lengths, the same by direct taps and exponentials, exponentials alone."""
    taps = {n: FirBank((ORDER,), gl_taps(ORDER, n, _DT_S)[:, None])
            for n in (21, 43, 86, 171, 342, 684, 1368)}  # fmt: skip
    banks: dict[str, dict[str, Features]] = {
        "fir": {f"{n} taps": bank for n, bank in taps.items()},
        "fir-fast": {f"as {n} taps": fast_fir_bank(taps[n]) for n in (86, 171, 342, 684)},
        "recursive": {f"{w:g} s": recursive_bank((ORDER,), _DT_S, w) for w in (0.1, 1.0, 10.0)},
    }
    return {
        engine: [{"name": name, **filter_point(bank)} for name, bank in family.items()]
        for engine, family in banks.items()
    }


def filter_point(features: Features) -> dict[str, float]:
    """Run time (ns) and relative RMS error of one engine."""
    leaf = Forest(
        feature=np.array([0, -1, -1], dtype=np.int32), threshold=np.zeros(3),
        left=np.array([1, 0, 0], dtype=np.int32), right=np.array([2, 0, 0], dtype=np.int32),
        value_n=np.array([0.0, 1.0, 2.0]), roots=np.array([0], dtype=np.int32), weight=1.0,
        bias_n=0.0,
    )  # fmt: skip
    trained = TrainedRange(0.0, DEPTH_M, 0.2, 0.0, 10.0)
    model = Model("rf-fd", "x", _DT_S, "surface", trained, features, leaf, None, False)
    scene = Scene(1, "x", "x", coupling=Coupling("off"), guard=Guard(outside="hold"))
    plan = make_plan(model, scene)
    time_s = np.arange(8000) * _DT_S
    depth = (0.5 * DEPTH_M * (1.0 + np.sin(TURN * time_s))).astype(np.float32)
    found = plan.features.reference(depth, np.array([0]))[6000:, 0].astype(np.float64)
    true = 0.5 * DEPTH_M * TURN**ORDER * np.sin(TURN * time_s + ORDER * np.pi / 2)[6000:]
    error = np.sqrt(np.mean((found - found.mean() - true) ** 2) / np.mean(true**2))
    with built(plan) as library:
        return {"time": Replay(library).hot_ns(depth, np.zeros_like(depth)), "error": float(error)}


def stepped_force(step_s: float, published: bool) -> float:
    """Force of the coupling after 1 s on a tool that taps a spring, N."""
    couple = Coupled(couple_config(PAPER, step_s, np.float64))
    x_p = v_p = force_n = 0.0
    for i in range(round(1.0 / step_s) + 1):
        x, v = _tool(i * step_s)
        model_n = SPRING_NPM * x
        if published:
            force_n = -PAPER.stiffness_npm * (x_p - x) - PAPER.damping_nspm * (v_p - v)
            v_p += step_s * (force_n - model_n) / PAPER.mass_kg
            x_p += step_s * v_p
        else:
            force_n = couple.force(x, v, model_n)
    return force_n


def exact_force() -> float:
    """The same force from the exact solution: a linear system driven by a sine, N."""
    k, b, m = PAPER.stiffness_npm, PAPER.damping_nspm, PAPER.mass_kg
    # The tool: TAP_M (1 - c), with c' = -TAP_TURN s and s' = TAP_TURN c. State: x_p, v_p, c, s, 1.
    rate = np.zeros((5, 5))
    rate[0, 1] = 1.0
    spring = (k - SPRING_NPM) * TAP_M / m
    rate[1] = [-k / m, -b / m, -spring, b * TAP_M * TAP_TURN / m, spring]
    rate[2, 3], rate[3, 2] = -TAP_TURN, TAP_TURN
    x_p, v_p = (linalg.expm(rate) @ [0.0, 0.0, 1.0, 0.0, 1.0])[:2]
    x, v = _tool(1.0)
    return float(-k * (x_p - x) - b * (v_p - v))


def _tool(time_s: float) -> tuple[float, float]:
    angle = TAP_TURN * time_s
    return float(TAP_M * (1.0 - np.cos(angle))), float(TAP_M * TAP_TURN * np.sin(angle))


def draw_curves(axes: Axes, curves: dict[str, Curve], x: str, y: str) -> None:
    """Draw one line a family, each point named."""
    marks = [(kind.mark, kind.colour) for kind in KINDS.values()]
    for i, (family, curve) in enumerate(curves.items()):
        shape, color = marks[i]
        axes.plot([p["time"] for p in curve], [p["error"] for p in curve], marker=shape,
                  color=color, ls=DASHES[i], ms=5, label=family)  # fmt: skip
        right = i % 2 == 0
        for point in curve:
            axes.annotate(
                point["name"], (point["time"], point["error"]), fontsize=7, color="#333333",
                xytext=(5, 4) if right else (-5, -9), textcoords="offset points",
                ha="left" if right else "right",
            )  # fmt: skip
    axes.margins(x=0.15)
    log_axes(axes, x, y)
    axes.legend(frameon=False, fontsize=8)


def main(path: Path) -> None:
    curves = work_precision()
    for family in (line for panel in curves.values() for line in panel.items()):
        print(family[0], ", ".join(f"{p['name']}: {p['time']:.3g}, {p['error']:.2e}"
                                   for p in family[1]))  # fmt: skip
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 3.4), layout="constrained")
        left, right = figure.subplots(1, 2)
        error = "relative error of the half derivative at 2 Hz"
        draw_curves(left, curves["filters"], "whole tick, hot, ns", error)
        steps = "ticks for one second (either: about ten multiplications)"
        draw_curves(right, curves["integrators"], steps, "error of the force, N")
        path.write_text(svg_text(figure))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
