"""Figures as SVG text: their look, and those of a stored validation."""

import io
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from springpot.host.validation.store import Series
from springpot.host.validation.validation import draw_forces, median_error

MUTED = "#888888"
STYLE: Any = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.hashsalt": "springpot",
    "svg.fonttype": "path",
}
_PLAIN = (1e-4, 1e7)
SVG_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))
_SIZE_INCHES = (4.4, 3.4)
_TOTAL_POINTS = 20_000  # of all recordings in one figure


def stride(samples: int, max_points: int = 4000) -> int:
    """Every how many samples a curve is drawn through."""
    return max(1, -(-samples // max_points))


def log_ticks(axis: Axis) -> None:
    """Write plain numbers on a logarithmic axis on which all is drawn: the wider, the fewer.

    Where these would be long, powers of ten stay.
    """
    low, high = axis.get_view_interval()
    if low < _PLAIN[0] or high > _PLAIN[1]:
        return
    decades = np.log10(high / low)
    fits = {0.7: (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0), 1.5: (1.0, 2.0, 5.0), 4.0: (1.0, 3.0)}
    subs = next((subs for most, subs in fits.items() if decades < most), (1.0,))
    axis.set_major_locator(LogLocator(subs=subs))
    axis.set_major_formatter(lambda value, _: f"{value:.10g}")
    axis.set_minor_formatter(NullFormatter())


def svg_text(figure: Figure) -> str:
    """The figure as an SVG element: the same figure, the same text."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata=SVG_METADATA)
    svg = text.getvalue()
    return svg[svg.index("<svg") :]


def median_series(series: Sequence[Series]) -> Series:
    """Return the recording with the median RMSE, thinned for drawing."""
    forces_n = [(one.measured_n, one.predicted_n) for one in series]
    found = series[median_error(*zip(*forces_n, strict=True))]
    return _thinned(found, stride(len(found.measured_n)))


@mpl.rc_context(STYLE)
def time_figure(series: Series) -> str:
    """Draw measured force, that of the C and their difference against time."""
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1])
    draw_forces(upper, series.name, series.dt_s, series.measured_n, series.predicted_n)
    upper.set_xlabel("")
    time_s = series.dt_s * np.arange(len(series.measured_n))
    lower.plot(time_s, series.predicted_n - series.measured_n, color="tab:blue", lw=0.8)
    lower.axhline(0.0, color=MUTED, lw=0.6)
    lower.set(xlabel="time, s", ylabel="C - measured, N")
    return svg_text(figure)


@mpl.rc_context(STYLE)
def loop_figure(series: Series) -> str:
    """Draw both forces against depth."""
    figure = Figure(figsize=_SIZE_INCHES, layout="constrained")
    axes = figure.subplots()
    depth_mm = 1e3 * series.position_m
    axes.plot(depth_mm, series.measured_n, color="black", lw=0.9, label="measured")
    axes.plot(depth_mm, series.predicted_n, color="tab:red", lw=0.8, ls="--", label="C")
    axes.set(xlabel="depth, mm", ylabel="force, N")
    axes.legend(loc="upper left", frameon=False)
    return svg_text(figure)


@mpl.rc_context(STYLE)
def error_figure(series: Sequence[Series]) -> str:
    """Draw the error of every recording against depth."""
    step = stride(sum(len(one.measured_n) for one in series), _TOTAL_POINTS)
    figure = Figure(figsize=_SIZE_INCHES, layout="constrained")
    axes = figure.subplots()
    for one in (_thinned(each, step) for each in series):
        error_n = one.predicted_n - one.measured_n
        axes.plot(1e3 * one.position_m, error_n, ",", color="tab:blue", rasterized=True)
    axes.axhline(0.0, color=MUTED, lw=0.6)
    axes.set(xlabel="depth, mm", ylabel="C - measured, N")
    return svg_text(figure)


def _thinned(series: Series, step: int) -> Series:
    names = ("position_m", "measured_n", "predicted_n")
    thin = {name: getattr(series, name)[::step] for name in names}
    return replace(series, dt_s=series.dt_s * step, **thin)
