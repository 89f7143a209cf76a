"""Figures 7 to 11 of the paper: errors, modelling times and importances of all objects."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from springpot.codegen.arrays import rms
from springpot.codegen.atomic_write import written_aside
from springpot.host.evidence.paper.reproduce import PAPER_KINDS, ObjectResult
from springpot.host.metrics import SCORED_ABOVE_N, just_noticeable_percent
from springpot.host.pages.plot_style import MEASURED, MUTED, STYLE, SVG_METADATA, stride

PAPER_STYLE: Any = {**STYLE, "font.size": 8.0}
# Distinct in colour, and in black and white by line style.
COLORS = {
    "rf-fd": "#d1495b",
    "rbf-fd": "#2e6f95",
    "rbf-pv": "#edae49",
    "hammerstein": "#3c8a5b",
    "hybrid": "#7a5195",
}
PAPER_LINES = {"rf-fd": "-", "rbf-fd": "--", "rbf-pv": ":"}
_POINTS = 3000
_METADATA: dict[str, dict[str, None]] = {
    "svg": SVG_METADATA,
    "pdf": {"CreationDate": None},
}


def save(figure: Figure, out: Path, name: str, caption: str) -> list[str]:
    """Write NAME.svg and NAME.pdf with the caption below the figure; return the file names."""
    figure.supxlabel(caption, fontsize=7, color="#555555", wrap=True)
    names = []
    for kind, metadata in _METADATA.items():
        names.append(f"{name}.{kind}")
        with written_aside(out / names[-1]) as aside:
            figure.savefig(aside, format=kind, metadata=metadata)
    return names


def error_figures(results: Sequence[ObjectResult], out: Path, data: str) -> list[str]:
    """Draw figures 7 to 11 into `out`; data: what the captions say of the recordings."""
    files = []
    with mpl.rc_context(PAPER_STYLE):
        for draw in (_predictions, _percentages, _errors, _times, _importances):
            files += draw(results, out, data)
    return files


def typical_recording(result: ObjectResult) -> int:
    """Return validation recording whose RMSE with rf-fd is the median one."""
    pairs = zip(result.models["rf-fd"].validation.predicted_n, result.data.validation, strict=True)
    errors = [rms(predicted_n - recording.force_n) for predicted_n, recording in pairs]
    return int(np.argsort(errors)[len(errors) // 2])


def _predictions(results: Sequence[ObjectResult], out: Path, data: str) -> list[str]:
    n = len(results)
    figure = Figure(figsize=(9.0, 0.5 + 2.0 * n), layout="constrained")
    panels = figure.subplots(2 * n, 1, sharex=True, squeeze=False, height_ratios=[2, 1] * n)[:, 0]
    for result, upper, lower in zip(results, panels[::2], panels[1::2], strict=True):
        number = typical_recording(result)
        recording = result.data.validation[number]
        step = stride(len(recording.force_n), _POINTS)
        time_s = np.arange(len(recording.force_n))[::step] * recording.dt_s
        upper.plot(time_s, recording.force_n[::step], color=MEASURED, lw=1.2, label="measured")
        for kind in PAPER_KINDS:
            predicted_n = result.models[kind].validation.predicted_n[number]
            style = {"color": COLORS[kind], "ls": PAPER_LINES[kind], "lw": 0.9}
            upper.plot(time_s, predicted_n[::step], label=kind, **style)
            lower.plot(time_s, (predicted_n - recording.force_n)[::step], **style)
        upper.set_title(f"{result.data.name}: {recording.name}", loc="left", fontsize=8)
        upper.set_ylabel("force, N")
        lower.set_ylabel("error, N")
    panels[0].legend(loc="upper right", frameon=False, ncols=4)
    panels[-1].set_xlabel("time, s")
    caption = f"Figure 7: force of the emitted C on typical validation recordings. {data}"
    return save(figure, out, "figure-07", caption)


def _percentages(results: Sequence[ObjectResult], out: Path, data: str) -> list[str]:
    figure = Figure(figsize=(7.5, 0.6 + 1.7 * len(results)), layout="constrained")
    grid = figure.subplots(len(results), 3, sharex=True, sharey=True, squeeze=False)
    curve_n = np.linspace(0.05, 10.0, 300)
    for result, row in zip(results, grid, strict=True):
        measured_n = np.concatenate([recording.force_n for recording in result.data.validation])
        shown = np.flatnonzero(measured_n > 0.1)
        shown = shown[:: max(1, len(shown) // _POINTS)]
        for kind, axes in zip(PAPER_KINDS, row, strict=True):
            predicted_n = np.concatenate(result.models[kind].validation.predicted_n)
            percent = 100.0 * np.abs(predicted_n - measured_n)[shown] / measured_n[shown]
            axes.scatter(measured_n[shown], percent, s=1, color=COLORS[kind], linewidths=0,
                         rasterized=True)  # fmt: skip
            axes.plot(curve_n, just_noticeable_percent(curve_n), color=MEASURED, lw=1.0)
            axes.axvline(SCORED_ABOVE_N, color=MUTED, lw=0.7, ls=":")
            axes.set_ylim(0.0, 50.0)
            axes.set_title(f"{result.data.name}, {kind}", loc="left", fontsize=8)
        row[0].set_ylabel("error, %")
    for axes in grid[-1]:
        axes.set_xlabel("measured force, N")
    caption = f"Figure 8: absolute percentage error; line: just noticeable difference. {data}"
    return save(figure, out, "figure-08", caption)


def _errors(results: Sequence[ObjectResult], out: Path, data: str) -> list[str]:
    caption = f"Figure 9: RMSE averaged over the validation recordings. {data}"
    return _bars(results, ObjectResult.rmse_n, "RMSE, N", out, ("figure-09", caption))


def _times(results: Sequence[ObjectResult], out: Path, data: str) -> list[str]:
    def seconds(result: ObjectResult, kind: str) -> float:
        return result.models[kind].modelling_s

    caption = f"Figure 10: time for features and training, without searches. {data}"
    return _bars(results, seconds, "modelling time, s", out, ("figure-10", caption))


def _bars(
    results: Sequence[ObjectResult],
    value: Callable[[ObjectResult, str], float],
    label: str,
    out: Path,
    named: tuple[str, str],
) -> list[str]:
    figure = Figure(figsize=(7.5, 3.0), layout="constrained")
    axes = figure.subplots()
    kinds = list(results[0].models)
    at, width = np.arange(len(results)), 0.8 / len(kinds)
    for i, kind in enumerate(kinds):
        values = [value(result, kind) for result in results]
        axes.bar(at + (i - (len(kinds) - 1) / 2) * width, values, width, label=kind,
                 color=COLORS.get(kind))  # fmt: skip
    axes.set_xticks(at, [result.data.name for result in results])
    axes.set_ylabel(label)
    axes.legend(frameon=False, ncols=len(kinds), loc="upper right", fontsize=7)
    return save(figure, out, *named)


def _importances(results: Sequence[ObjectResult], out: Path, data: str) -> list[str]:
    figure = Figure(figsize=(9.0, 2.6), layout="constrained")
    panels = figure.subplots(1, len(results), sharey=True, squeeze=False)[0]
    for result, axes in zip(results, panels, strict=True):
        fit = result.models["rf-fd"].fit
        orders = [f"{order:g}" for order in fit.model.features.orders]  # type: ignore[union-attr]
        axes.bar(orders, fit.metadata["importance"], color=COLORS["rf-fd"])
        axes.set_title(result.data.name, loc="left", fontsize=8)
        axes.tick_params(axis="x", labelrotation=90)
    panels[0].set_ylabel("importance")
    caption = f"Figure 11: importance of the fractional orders in rf-fd. {data}"
    return save(figure, out, "figure-11", caption)
