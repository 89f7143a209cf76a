"""The page of a benchmark: one figure, one table."""

import json
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from springpot.codegen.atomic_write import write_file
from springpot.codegen.errors import DataError
from springpot.codegen.types import JsonMapping
from springpot.host.bench.bench import RESULT
from springpot.host.pages.figures import STYLE, log_ticks, svg_text
from springpot.host.pages.page import page_text
from springpot.trainer.kinds import KINDS, Kind

_FILE = Kind("file", "", "", "D", "#6a4c93")  # of a model that was not fitted here
Row = JsonMapping


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
