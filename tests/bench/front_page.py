"""Draw and write what the README says of error and size, from the stored benchmarks.

    springpot demo --out demo; python tests/bench/front_page.py demo/c docs/prediction.svg

Draws the README's other picture, of an emitted and validated folder.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
from judges_table import MACH1, PASSIVE, geometric, percent
from matplotlib.figure import Figure

from springpot.figures import STYLE, svg_text
from springpot.host.simulation.objects import FOREIGN_OBJECTS
from springpot.host.validation.store import read_validation
from springpot.host.wings.evidence.benchmark.labels import kilobytes
from springpot.host.wings.evidence.benchmark.point import points_of
from springpot.host.wings.evidence.benchmark.report import plain
from springpot.host.wings.report.figures import median_series, time_figure
from springpot.trainer.kinds import AUTO

Metadata = dict[str, Any]
PAPER = "rf-fd"
GROUPS = (("a real machine on a real material", (MACH1,)),
          ("objects of other laws than our models'", FOREIGN_OBJECTS))  # fmt: skip
_COLOURS = ("#8c3b1a", "#c98f6b", "#9a9a9a", "#d9d9d9")


def bars(judges: Metadata) -> list[tuple[str, int, dict[str, float]]]:
    """Return each group's title, number of recordings, and error of each bar, % of the peak."""
    found = []
    for title, names in GROUPS:
        cells = [cell for cell in judges["cells"] if cell["object"] in names]
        if cells:
            found.append((title, len(cells), _errors(cells)))
    return found


def _errors(cells: Sequence[Metadata]) -> dict[str, float]:
    return {
        "springpot": geometric([percent(cell["models"][AUTO]) for cell in cells]),
        "the paper's random forest": geometric([percent(cell["models"][PAPER]) for cell in cells]),
        "a spring and a dashpot": geometric([cell["spring_dashpot_percent"] for cell in cells]),
        "noise of the sensors": geometric([cell["floor_percent"] for cell in cells]),
    }


def bars_figure(judges: Metadata) -> str:
    """Draw `bars`: SVG text."""
    groups = bars(judges)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 1.9 * len(groups) + 0.5), layout="constrained")
        for axes, (title, count, errors) in zip(
            figure.subplots(len(groups), squeeze=False)[:, 0], groups, strict=True
        ):
            drawn = axes.barh(list(errors), list(errors.values()), color=_COLOURS, height=0.75)
            axes.bar_label(drawn, [f"{plain(each)} %" for each in errors.values()], padding=4)
            axes.set_title(f"{title}: {count} recordings that the model has not seen", loc="left",
                           fontsize=10)  # fmt: skip
            axes.invert_yaxis()
            axes.set_xlim(0, 1.15 * max(errors.values()))
            axes.xaxis.set_visible(False)
            axes.spines[["top", "right", "bottom"]].set_visible(False)
            axes.tick_params(axis="y", length=0)
        return svg_text(figure)


def sentence(benches: Sequence[Metadata], judges: Metadata) -> str:
    """Say the error and what it costs, in words that need no other page."""
    machine, foreign = (errors for _, _, errors in bars(judges))
    on_machine, on_foreign = (each["the paper's random forest"] / each["springpot"]
                              for each in (machine, foreign))  # fmt: skip
    points = {p.model: p for p in points_of(benches[0]) if p.model in (PASSIVE, PAPER)
              and not p.options}  # fmt: skip
    ours, paper = points[PASSIVE], points[PAPER]
    instructions = (
        f" and {ours.instructions} instructions of a Cortex-M4F" if ours.instructions else ""
    )
    return (
        "Error of the emitted C in % of the peak force, geometric mean over recordings that ask "
        "for what the model was not trained on: another depth, speed or frequency, a repeat, "
        f"minutes of memory. Beside the random forest of the paper it is {plain(on_machine, 2)} "
        f"times smaller on the real machine and {plain(on_foreign, 2)} times on simulated objects "
        "of laws that our models do not have, and a step takes "
        f"{plain(1e-3 * ours.tick_ns_hot, 1)} µs of a PC instead of "
        f"{plain(1e-3 * paper.tick_ns_hot, 1)} µs, {kilobytes(ours.flash_bytes)} of a "
        f"microcontroller instead of {kilobytes(paper.flash_bytes)}, {ours.ram_bytes} bytes of "
        f"its RAM{instructions}. "
        "[Every cell, every model, how it was measured](docs/explanation/results.md)."
    )


if __name__ == "__main__":
    folder, picture = map(Path, sys.argv[1:])
    picture.write_text(time_figure(median_series(read_validation(folder).series)))
