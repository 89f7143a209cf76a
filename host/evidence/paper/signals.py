"""Figures 5, 13, 14, 19 and 20 of the paper: one signal each."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from springpot.host.evidence.paper.figures import PAPER_STYLE, save, typical_recording
from springpot.host.evidence.paper.reproduce import ObjectResult, by_softness, shown_object
from springpot.host.evidence.paper.sampling import (
    SHOWN_ORDERS,
    STEP_S,
    STEPS_S,
    Resampled,
    coupled_force,
    derivative,
    example_press,
)
from springpot.host.pages.plot_style import ERROR, MEASURED, PREDICTED

_SHOWN_S = 5.0
_STYLES: tuple[dict[str, Any], ...] = (
    {"color": MEASURED, "lw": 1.0},
    {"color": PREDICTED, "ls": "--", "lw": 0.9},
)
Curve = tuple[str, np.ndarray, np.ndarray]  # label, times (s), values


def signal_figures(
    results: Sequence[ObjectResult], sampled: Resampled, out: Path, data: str
) -> list[str]:
    """Draw figures 5, 13, 14, 19 and 20 into `out`; data: what captions say of the recordings."""
    middle = shown_object(results)
    with mpl.rc_context(PAPER_STYLE):
        return [
            *_collected(by_softness(results)[0], out, data),
            *_coupled(middle, out, data),
            *_resampled(middle.data.name, sampled, out, data),
            *_derivatives(out),
            *_sampling_times(out),
        ]


def _collected(result: ObjectResult, out: Path, data: str) -> list[str]:
    training = result.data.training
    # The strongest press nearest to one second: a = 10 N, v = 1 Hz in the paper's protocol.
    max_n = max(recording.force_n.max() for recording in training)
    strong = [i for i, rec in enumerate(training) if rec.force_n.max() > 0.8 * max_n]
    number = min(strong, key=lambda i: abs(np.log(training[i].duration_s)))
    recording = training[number]
    time_s = np.arange(len(recording.force_n)) * recording.dt_s
    curves = [("measured", time_s, recording.force_n)]
    if result.data.commands_n:
        curves.append(("commanded", time_s, result.data.commands_n[number]))
    below = ("position, mm", time_s, 1e3 * recording.position_m)
    caption = f"Figure 5: {recording.name}, as recorded. {data}"
    return _save_panels(curves, below, out, "figure-05", caption)


def _coupled(result: ObjectResult, out: Path, data: str) -> list[str]:
    number = typical_recording(result)
    recording, model = result.data.validation[number], result.models["rf-fd"]
    n = min(len(recording.force_n), round(_SHOWN_S / recording.dt_s))
    time_s = np.arange(n) * recording.dt_s
    model_n = model.validation.predicted_n[number][:n]
    coupled_n = coupled_force(model, recording)[:n]
    curves = [("model", time_s, model_n), ("coupling and average", time_s, coupled_n)]
    caption = (
        f"Figure 13: rf-fd of {result.data.name} before and after the virtual coupling and the "
        f"moving average of 0.7. {data}"
    )
    below = ("change, N", time_s, coupled_n - model_n)
    return _save_panels(curves, below, out, "figure-13", caption)


def _resampled(name: str, sampled: Resampled, out: Path, data: str) -> list[str]:
    shown = sampled.time_s < _SHOWN_S
    slow = sampled.slow_time_s < _SHOWN_S
    time_s = sampled.time_s[shown]
    curves = [
        ("every 1 ms", time_s, sampled.force_n[shown]),
        ("every 1.27 ms", sampled.slow_time_s[slow], sampled.slow_n[slow]),
    ]
    below = ("difference, N", time_s, sampled.difference_n[shown])
    caption = f"Figure 14: rf-fd of {name} at two sampling times, with the taps of 1 ms. {data}"
    return _save_panels(curves, below, out, "figure-14", caption)


def _save_panels(
    forces: Sequence[Curve], below: Curve, out: Path, name: str, caption: str
) -> list[str]:
    """Draw one or two forces over time, and another quantity below them."""
    figure = Figure(figsize=(7.5, 3.8), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    for (label, time_s, force_n), style in zip(forces, _STYLES, strict=False):
        upper.plot(time_s, force_n, label=label, **style)
    upper.set_ylabel("force, N")
    upper.legend(frameon=False, loc="upper right")
    lower.plot(*below[1:], color=ERROR, lw=0.8)
    lower.set_ylabel(below[0])
    lower.set_xlabel("time, s")
    return save(figure, out, name, caption)


def _derivatives(out: Path) -> list[str]:
    figure = Figure(figsize=(5.0, 3.2), layout="constrained")
    axes = figure.subplots()
    time_s = np.arange(len(example_press(STEP_S))) * STEP_S
    for i in range(11):
        values = 1e3 * derivative(0.1 * i, STEP_S, STEP_S)
        axes.plot(time_s, values, lw=0.9, color=mpl.colormaps["viridis"](i / 12), label=f"{i / 10}")
    axes.set_xlabel("time, s")
    axes.set_ylabel("derivative, mm/s^order")
    axes.legend(frameon=False, ncols=2, fontsize=7, title="order", loc="upper right")
    caption = "Figure 19: derivatives of order 0 to 1 of a press of 10 mm at 1 Hz (computed)."
    return save(figure, out, "figure-19", caption)


def _sampling_times(out: Path) -> list[str]:
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    grid = figure.subplots(2, len(SHOWN_ORDERS), sharex=True)
    for row, own in zip(grid, (False, True), strict=True):
        for axes, order in zip(row, SHOWN_ORDERS, strict=True):
            for step_s, style in zip(STEPS_S, ("--", "-", ":"), strict=True):
                values = 1e3 * derivative(order, step_s, step_s if own else STEP_S)
                time_s = np.arange(len(values)) * step_s
                axes.plot(time_s, values, ls=style, lw=0.9, label=f"{1e3 * step_s:g} ms")
            axes.set_title(f"order {order:g}", loc="left", fontsize=8)
        row[0].set_ylabel("taps of its own step" if own else "taps of 1 ms")
    grid[0][0].legend(frameon=False, fontsize=7)
    for axes in grid[-1]:
        axes.set_xlabel("time, s")
    caption = "Figure 20: derivatives of a press at three sampling times, mm/s^order (computed)."
    return save(figure, out, "figure-20", caption)
