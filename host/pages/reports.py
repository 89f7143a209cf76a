"""The pages of `springpot report`, with their figures: on a validated scene, and on a benchmark."""

import io
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.files import write_file
from springpot.codegen.native.compiler import CompilerError
from springpot.codegen.types import JsonMapping, JsonObject
from springpot.host.emission.emission import read_emission, require_emission
from springpot.host.native.scene_library import read_manifest
from springpot.host.native.toolchain import measure_footprint
from springpot.host.output import RESULT
from springpot.host.pages.page import page_text
from springpot.host.validation.store import Validated, read_validation
from springpot.host.validation.validation import draw_forces, median_error_recording
from springpot.trainer.kinds import KINDS, Kind
from springpot.trainer.recordings.recording import Recording

_FILE = Kind("file", "", "", "D", "#6a4c93")  # of a model that was not fitted here
MUTED = "#888888"
STYLE: Any = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.hashsalt": "springpot",
    "svg.fonttype": "path",
}
SVG_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))
_SIZE_INCHES = (4.4, 3.4)
_CURVE_POINTS, _TOTAL_POINTS = 4000, 20_000  # of a recording; of all in one figure


def svg_text(figure: Figure) -> str:
    """Return the figure as an SVG element: the same figure, the same text."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata=SVG_METADATA)
    svg = text.getvalue()
    return svg[svg.index("<svg") :]


@mpl.rc_context(STYLE)
def time_figure(recording: Recording, predicted_n: Samples) -> str:
    """Draw measured force, that of the C and their difference against time."""
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1])
    draw_forces(upper, recording, predicted_n)
    upper.set_xlabel("")
    time_s = recording.dt_s * np.arange(len(predicted_n))
    lower.plot(time_s, predicted_n - recording.force_n, color="tab:blue", lw=0.8)
    lower.axhline(0.0, color=MUTED, lw=0.6)
    lower.set(xlabel="time, s", ylabel="error, N")
    return svg_text(figure)


@mpl.rc_context(STYLE)
def loop_figure(recording: Recording, predicted_n: Samples) -> str:
    """Draw both forces against depth."""
    figure = Figure(figsize=_SIZE_INCHES, layout="constrained")
    axes = figure.subplots()
    depth_mm = 1e3 * recording.position_m
    axes.plot(depth_mm, recording.force_n, color="black", lw=0.9, label="measured")
    axes.plot(depth_mm, predicted_n, color="tab:red", lw=0.8, ls="--", label="model (C)")
    axes.set(xlabel="depth, mm", ylabel="force, N")
    axes.legend(loc="upper left", frameon=False)
    return svg_text(figure)


@mpl.rc_context(STYLE)
def error_figure(pairs: Sequence[Validated]) -> str:
    """Draw the error of every recording against depth."""
    figure = Figure(figsize=_SIZE_INCHES, layout="constrained")
    axes = figure.subplots()
    every = _stride(sum(len(predicted_n) for _, predicted_n in pairs), _TOTAL_POINTS)
    for recording, predicted_n in pairs:
        depth_mm = 1e3 * recording.position_m[::every]
        error_n = (predicted_n - recording.force_n)[::every]
        axes.plot(depth_mm, error_n, ",", color="tab:blue", rasterized=True)
    axes.axhline(0.0, color=MUTED, lw=0.6)
    axes.set(xlabel="depth, mm", ylabel="error, N")
    return svg_text(figure)


def _downsampled(recording: Recording, predicted_n: Samples) -> Validated:
    """Return samples enough for a curve."""
    every = _stride(len(predicted_n), _CURVE_POINTS)
    position_m, force_n = recording.position_m[::every], recording.force_n[::every]
    dt_s = every * recording.dt_s
    thin = replace(recording, position_m=position_m, force_n=force_n, dt_s=dt_s)
    return thin, predicted_n[::every]


def _stride(samples: int, points: int) -> int:
    """Return every how many samples one is drawn."""
    return max(1, -(-samples // points))


def write_report(folder: Path) -> Path:
    """Write folder/report.html from the emission and the last validation; return its path.

    Raises DataError where the folder was not emitted or validated, or changed since.
    """
    require_emission(folder)
    metadata, pairs = read_validation(folder)
    emitted = read_emission(folder)
    if emitted.hash != metadata["result"]["hash"]:
        raise DataError(f"{folder}: changed since it was validated: `springpot validate` again")
    manifest = read_manifest(folder)
    median = _downsampled(*median_error_recording(pairs))
    context = {
        "manifest": manifest,
        "verdict": metadata["result"]["verdict"],
        **{key: metadata[key] for key in ("result", "machine", "recordings", "rows")},
        "provenance": manifest["provenance"],
        "costs": _cost_rows(folder, manifest),
        "time_figure": time_figure(*median),
        "loop_figure": loop_figure(*median),
        "error_figure": error_figure(pairs),
    }
    path = folder / "report.html"
    write_file(path, page_text("report.html", context).encode())
    return path


def _cost_rows(folder: Path, manifest: JsonObject) -> dict[str, str]:
    """Return bytes of memory in words."""
    target = manifest["target"]
    try:
        footprint = measure_footprint(folder, target)
        stack = "" if footprint.stack_bytes is None else f", stack {footprint.stack_bytes} bytes"
        flash = f"{footprint.flash_bytes} bytes ({target}){stack}"
    except CompilerError as error:
        flash = f"not measured: {error}"
    return {"flash": flash, "RAM": f"{manifest['state_bytes']} bytes of state"}


def write_bench_page(folder: Path) -> Path:
    """Write folder/bench.html of folder/bench.json. Raises DataError if there is none."""
    try:
        result = json.loads((folder / RESULT).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise DataError(
            f"{folder}: no benchmark: `springpot bench --recording ... --out {folder}` makes one"
        ) from None
    page = folder / "bench.html"
    context = {"result": result, "points": result["points"], "figure": _figure(result["points"])}
    text = page_text("bench.html", context, label=point_label)
    write_file(page, text.encode())
    return page


def point_label(point: JsonMapping) -> str:
    """Return a model's kind, or file, and the options that are not the default's."""
    options = ", ".join(f"{name} {value}" for name, value in point["options"].items())
    return f"{point['model']} ({options})" if options else str(point["model"])


def _figure(points: Sequence[JsonMapping]) -> str:
    """Draw the error against the time of a tick; marks filled on the front, as large as flash."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 5.2), layout="constrained")
        axes = figure.subplots()
        for name in dict.fromkeys(point["model"] for point in points):
            kind = KINDS.get(name, _FILE)
            for front in (False, True):
                chosen = [p for p in points if p["model"] == name and p["pareto"] == front]
                axes.scatter(
                    [point["tick_ns_hot"] for point in chosen],
                    [point["rmse_n"] for point in chosen],
                    [20.0 + (point["flash_bytes"] or 0) ** 0.5 / 4.0 for point in chosen],
                    marker=kind.mark, edgecolors=kind.colour, linewidths=1.2,
                    facecolors=kind.colour if front else "none",
                )  # fmt: skip
            axes.scatter([], [], marker=kind.mark, color=kind.colour, label=name)
        axes.set(
            xscale="log", yscale="log", xlabel="time of a tick, ns",
            ylabel="RMSE on recordings that were not trained on, N",
        )  # fmt: skip
        for axis in (axes.xaxis, axes.yaxis):  # 0.02 in place of 2 x 10^-2
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter(NullFormatter())
        axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        return svg_text(figure)
