"""Figures of a validation, as SVG text. The paper's figures 7, 8, 11 and 17, on one's own data."""

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from springpot.basics import Samples
from springpot.figures import ERROR, MEASURED, MUTED, PREDICTED, STYLE, log_ticks, stride, svg_text
from springpot.host.wings.report.frequency_loops import LoopRow, frequency_loops
from springpot.host.wings.report.relaxation import Hold
from springpot.validation import SCORED_ABOVE_N, Series, just_noticeable_percent, rms

_POINTS = 2000  # of a curve against time: three for each pixel
_MAX_PICKED = 12  # recordings in a page


def ranked_series(series: Sequence[Series]) -> list[Series]:
    """Return the recordings in the order of their RMSE."""
    return sorted(series, key=lambda item: rms(item.predicted_n - item.measured_n))


def typical_series(series: Sequence[Series]) -> Series:
    """Return the recording whose RMSE is the median one."""
    return ranked_series(series)[len(series) // 2]


@dataclass(frozen=True)
class Picked:
    """A recording's figure, which the page's reader picks by its name and error."""

    name: str
    rmse_n: float
    figure: str
    typical: bool


def prediction_figures(series: Sequence[Series]) -> list[Picked]:
    """Figures of all recordings, or of `_MAX_PICKED` evenly along their RMSE; the best first."""
    ranked, typical = ranked_series(series), typical_series(series)
    shown = np.linspace(0, len(ranked) - 1, min(len(ranked), _MAX_PICKED)).round().astype(int)
    chosen = [item for k, item in enumerate(ranked) if k in shown or item is typical]
    return [
        Picked(
            name=item.name,
            rmse_n=rms(item.predicted_n - item.measured_n),
            figure=prediction_figure(item),
            typical=item is typical,
        )
        for item in chosen
    ]


def draw_prediction(axes: Axes, item: Series) -> None:
    """Measured and predicted force against time."""
    step = stride(len(item.measured_n), _POINTS)
    time_s = np.arange(len(item.measured_n))[::step] * item.dt_s
    axes.plot(time_s, item.measured_n[::step], color=MEASURED, lw=1.2, label="measured")
    axes.plot(time_s, item.predicted_n[::step], color=PREDICTED, lw=1.0, ls="--", label="C")
    axes.set_ylabel("force, N")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False, ncols=2, borderpad=0.0)
    axes.set_title(item.name, loc="left", fontsize=9)


def prediction_figure(item: Series) -> str:
    """Measured and predicted force, and their difference, against time (figure 7)."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 4.2), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1])
        step = stride(len(item.measured_n), _POINTS)
        time_s = np.arange(len(item.measured_n))[::step] * item.dt_s
        draw_prediction(upper, item)
        lower.plot(time_s, (item.predicted_n - item.measured_n)[::step], color=ERROR, lw=0.8)
        lower.axhline(0.0, color=MUTED, lw=0.6)
        lower.set(ylabel="error, N", xlabel="time, s")
        return svg_text(figure)


def hysteresis_loops(item: Series) -> tuple[str, list[LoopRow]]:
    """Force against depth, measured and of the C (figure 17): a loop for each frequency."""
    rows = frequency_loops(item)
    if len(rows) < 2:
        return _whole_loop(item), rows
    turn = np.linspace(0.0, 2.0 * np.pi, 120)
    with mpl.rc_context(STYLE):
        columns = 2
        figure = Figure(figsize=(4.8, 2.0 * -(-len(rows) // columns)), layout="constrained")
        panels = figure.subplots(-(-len(rows) // columns), columns, sharex=True, sharey=True,
                                 squeeze=False)  # fmt: skip
        for axes, row in zip(panels.flat, rows, strict=False):
            for swing, colour, dashes, name in (
                (row.measured, MEASURED, "-", "measured"), (row.predicted, PREDICTED, "--", "C")
            ):  # fmt: skip
                axes.plot(1e3 * row.depth_m * np.cos(turn), (swing * np.exp(1j * turn)).real,
                          color=colour, ls=dashes, lw=1.1, label=name)  # fmt: skip
            axes.set_title(f"{row.frequency_hz:.3g} Hz", loc="left", fontsize=9)
        for axes in panels.flat[len(rows) :]:
            axes.set_axis_off()
        panels.flat[0].legend(frameon=False, fontsize=7, loc="upper left")
        figure.supxlabel("depth that swings at the frequency, mm", fontsize=9)
        figure.supylabel("force that swings at it, N", fontsize=9)
        return svg_text(figure), rows


def _whole_loop(item: Series) -> str:
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.4, 3.6), layout="constrained")
        axes = figure.subplots()
        step = stride(len(item.measured_n))
        depth_mm = 1e3 * item.position_m[::step]
        axes.plot(depth_mm, item.measured_n[::step], color=MEASURED, lw=0.9, label="measured")
        axes.plot(depth_mm, item.predicted_n[::step], color=PREDICTED, lw=0.8, ls="--", label="C")
        axes.set(xlabel="depth, mm", ylabel="force, N")
        axes.legend(loc="upper left", frameon=False)
        return svg_text(figure)


def held_forces(scene: Hold, recorded: Hold | None) -> str:
    """Force while the tool is held, of what it is at the beginning, on a logarithmic time."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.8, 3.4), layout="constrained")
        axes = figure.subplots()
        curves = [(scene.force_n, scene, PREDICTED, "--", f"C, {1e3 * scene.depth_m:.3g} mm")]
        if recorded is not None and recorded.measured_n is not None:
            depth = f"{1e3 * recorded.depth_m:.3g} mm"
            curves += [(recorded.measured_n, recorded, MEASURED, "-", f"measured, {depth}"),
                       (recorded.force_n, recorded, ERROR, ":", f"C on it, {depth}")]  # fmt: skip
        lowest = min(100.0 * float(np.min(force_n)) / force_n[0] for force_n, *_ in curves)
        for force_n, hold, colour, dashes, name in curves:
            kept = np.unique(np.geomspace(1, len(force_n), 600).astype(int)) - 1
            axes.plot((kept + 1) * hold.dt_s, 100.0 * force_n[kept] / force_n[0], color=colour,
                      ls=dashes, lw=1.3, label=name)  # fmt: skip
        axes.set(
            xscale="log",
            ylim=(max(0.0, 20.0 * np.floor((lowest - 5.0) / 20.0)), 102.0),
            xlabel="time held still, s",
            ylabel="force, % of the first",
        )
        log_ticks(axes.xaxis)
        axes.legend(frameon=False, loc="lower left")
        return svg_text(figure)


def percentage_error(series: Sequence[Series]) -> str:
    """Absolute percentage error against force, with the just noticeable difference (figure 8)."""
    measured_n = np.concatenate([item.measured_n for item in series])
    error_n = np.concatenate([item.predicted_n - item.measured_n for item in series])
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.4, 3.6), layout="constrained")
        axes = figure.subplots()
        shown = measured_n > 0.02 * measured_n.max()
        step = stride(int(shown.sum()))
        force_n = measured_n[shown][::step]
        axes.scatter(
            force_n, 100.0 * np.abs(error_n[shown][::step]) / force_n,
            s=2, color=ERROR, alpha=0.4, linewidths=0, rasterized=True, label="C",
        )  # fmt: skip
        curve_n = np.linspace(0.05, max(measured_n.max(), 1.1 * SCORED_ABOVE_N), 300)
        axes.plot(curve_n, just_noticeable_percent(curve_n), color=MEASURED, lw=1.2, label="JND")
        axes.axvline(SCORED_ABOVE_N, color=MUTED, lw=0.8, ls=":")
        axes.set_ylim(0.0, 50.0)
        axes.set_xlim(left=0.0)
        axes.set(
            xlabel="measured force, N (scored right of the dotted line)", ylabel="absolute error, %"
        )
        axes.legend(loc="upper right", frameon=False, markerscale=4)
        return svg_text(figure)


def importance(orders: Sequence[float], shares: Sequence[float]) -> str:
    """Importance of each fractional order in the forest (figure 11)."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.4, 3.0), layout="constrained")
        axes = figure.subplots()
        axes.bar([f"{order:g}" for order in orders], shares, color=ERROR)
        axes.set(xlabel="fractional order", ylabel="share of the variance removed")
        axes.tick_params(axis="x", labelrotation=45)
        return svg_text(figure)


def tick_histogram(tick_ns: Samples, hot_ns: float) -> str:
    """Paced tick times with cold caches, and the hot median."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.4, 3.0), layout="constrained")
        axes = figure.subplots()
        tick_us = tick_ns * 1e-3
        low, high = min(hot_ns * 1e-3, tick_us.min()), tick_us.max()
        bins = np.geomspace(0.8 * low, 1.2 * high, 60)
        axes.hist(tick_us, bins=list(bins), color=ERROR, label="paced, cold caches")
        axes.axvline(hot_ns * 1e-3, color=PREDICTED, lw=1.4, ls="--", label="hot median")
        axes.set(xscale="log", xlabel="time of a tick, µs", ylabel="ticks")
        log_ticks(axes.xaxis)
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False, ncols=2)
        return svg_text(figure)
