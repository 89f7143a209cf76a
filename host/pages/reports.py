"""The pages of `springpot report`: on an emitted and validated scene, and on a benchmark."""

import json
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from springpot.codegen.errors import DataError
from springpot.codegen.files import write_file
from springpot.codegen.types import JsonMapping, JsonObject
from springpot.host.bench.bench import RESULT
from springpot.host.emission.emission import read_emission, require_emission
from springpot.host.native.compiler import CompilerError
from springpot.host.native.toolchain import measure_footprint
from springpot.host.pages import figures
from springpot.host.pages.figures import STYLE, log_ticks, svg_text
from springpot.host.pages.page import page_text
from springpot.host.validation.store import read_validation
from springpot.trainer.kinds import KINDS, Kind

_REPORT_NAME = "report.html"
_FILE = Kind("file", "", "", "D", "#6a4c93")  # of a model that was not fitted here
Row = JsonMapping


def write_report(folder: Path) -> Path:
    """Write folder/report.html from the emission and the last validation; return its path.

    Raises DataError where the folder was not emitted or validated, or changed since.
    """
    require_emission(folder)
    stored = read_validation(folder)
    if read_emission(folder).hash != stored.metadata["result"]["hash"]:
        raise DataError(f"{folder}: changed since it was validated: `springpot validate` again")
    manifest = json.loads((folder / "manifest.json").read_text())
    median = figures.median_series(stored.series)
    context = {
        "manifest": manifest,
        "result": stored.metadata["result"],
        "machine": stored.metadata["machine"],
        "recordings": stored.metadata["recordings"],
        "provenance": manifest["provenance"],
        "rows": stored.metadata["rows"],
        "costs": _cost_rows(folder, manifest),
        "time_figure": figures.time_figure(median),
        "loop_figure": figures.loop_figure(median),
        "error_figure": figures.error_figure(stored.series),
    }
    path = folder / _REPORT_NAME
    write_file(path, page_text("report.html", context).encode())
    return path


def _cost_rows(folder: Path, manifest: JsonObject) -> dict[str, str]:
    """Return bytes of memory in words."""
    target = manifest["target"]
    try:
        found = measure_footprint(folder, target)
        stack = "" if found.stack_bytes is None else f", stack {found.stack_bytes} bytes"
        flash = f"{found.flash_bytes} bytes ({target}){stack}"
    except CompilerError as error:
        flash = f"not measured: {error}"
    return {"flash": flash, "RAM": f"{manifest['state_bytes']} bytes of state"}


def write_bench_page(folder: Path) -> Path:
    """Write folder/bench.html of folder/bench.json. Raises DataError if there is none."""
    try:
        result = json.loads((folder / RESULT).read_text())
    except (OSError, ValueError):
        raise DataError(
            f"{folder}: no benchmark: `springpot bench --recording ... --out {folder}` makes one"
        ) from None
    page = folder / "bench.html"
    context = {"result": result, "points": result["points"], "figure": _figure(result["points"])}
    text = page_text("bench.html", context, label=label)
    write_file(page, text.encode())
    return page


def label(point: Row) -> str:
    """Return a model's kind, or file, and the options that are not the default's."""
    options = ", ".join(f"{name} {value}" for name, value in point["options"].items())
    return f"{point['model']} ({options})" if options else str(point["model"])


def _figure(points: Sequence[Row]) -> str:
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
        log_ticks(axes.xaxis)
        log_ticks(axes.yaxis)
        axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        return svg_text(figure)
