"""Figures 5, 13, 14, 19 and 20 of the paper: one signal each."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from springpot.figures import ERROR, MEASURED, PREDICTED
from springpot.host.wings.evidence.paper.figures import PAPER_STYLE, save, typical_recording
from springpot.host.wings.evidence.paper.reproduce import ObjectResult, by_softness, shown_object
from springpot.host.wings.evidence.paper.sampling import (
    SHOWN_ORDERS,
    STEP_S,
    STEPS_S,
    Resampled,
    coupled_force,
    derivative,
    example_press,
)

_SHOWN_S = 5.0


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
    figure = Figure(figsize=(6.0, 3.8), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot(time_s, recording.force_n, color=MEASURED, lw=1.1, label="measured")
    if result.data.commands_n:
        commanded_n = result.data.commands_n[number]
        upper.plot(time_s, commanded_n, color=PREDICTED, ls="--", lw=1.0, label="commanded")
    upper.set_ylabel("force, N")
    upper.legend(frameon=False, loc="upper right")
    lower.plot(time_s, 1e3 * recording.position_m, color=MEASURED, lw=1.1)
    lower.set_ylabel("position, mm")
    lower.set_xlabel("time, s")
    return save(figure, out, "figure-05", f"Figure 5: {recording.name}, as recorded. {data}")


def _coupled(result: ObjectResult, out: Path, data: str) -> list[str]:
    number = typical_recording(result)
    recording, model = result.data.validation[number], result.models["rf-fd"]
    n = min(len(recording.force_n), round(_SHOWN_S / recording.dt_s))
    time_s = np.arange(n) * recording.dt_s
    model_n = model.validation.predicted_n[number][:n]
    coupled_n = coupled_force(model, recording)[:n]
    figure = Figure(figsize=(7.5, 3.8), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    upper.plot(time_s, model_n, color=MEASURED, lw=0.9, label="model")
    upper.plot(time_s, coupled_n, color=PREDICTED, ls="--", lw=0.9, label="coupling and average")
    upper.set_ylabel("force, N")
    upper.legend(frameon=False, loc="upper right")
    lower.plot(time_s, coupled_n - model_n, color=ERROR, lw=0.8)
    lower.set_ylabel("change, N")
    lower.set_xlabel("time, s")
    caption = (
        f"Figure 13: rf-fd of {result.data.name} before and after the virtual coupling and the "
        f"moving average of 0.7. {data}"
    )
    return save(figure, out, "figure-13", caption)


def _resampled(name: str, sampled: Resampled, out: Path, data: str) -> list[str]:
    shown = sampled.time_s < _SHOWN_S
    slow = sampled.slow_time_s < _SHOWN_S
    figure = Figure(figsize=(7.5, 3.8), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    upper.plot(sampled.time_s[shown], sampled.force_n[shown], color=MEASURED, lw=1.0,
               label="every 1 ms")  # fmt: skip
    upper.plot(sampled.slow_time_s[slow], sampled.slow_n[slow], color=PREDICTED, ls="--", lw=0.9,
               label="every 1.27 ms")  # fmt: skip
    upper.set_ylabel("force, N")
    upper.legend(frameon=False, loc="upper right")
    lower.plot(sampled.time_s[shown], sampled.difference_n[shown], color=ERROR, lw=0.8)
    lower.set_ylabel("difference, N")
    lower.set_xlabel("time, s")
    caption = f"Figure 14: rf-fd of {name} at two sampling times, with the taps of 1 ms. {data}"
    return save(figure, out, "figure-14", caption)


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
