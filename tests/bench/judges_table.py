"""Tables of tests/bench/judges.py: object x recording x candidate, and how well `auto` chose."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from springpot.host.simulation.objects import FOREIGN_OBJECTS, OBJECTS
from springpot.host.wings.evidence.benchmark.report import plain
from springpot.trainer.kinds import AUTO

Metadata = dict[str, Any]
MACH1 = "mach1"
PASSIVE = "hammerstein"
SLOPES = "stiffness, %"
GROUPS = (
    ("Mach-1, one frequency left out in turn", (MACH1,)),
    ("Foreign objects", FOREIGN_OBJECTS),
    ("The five silicones, hammerstein's own class", OBJECTS),
)
KINSHIP = (
    "Which of our models is of a judge's own class: `hammerstein` (and the passive part of "
    "`hybrid`) is made of curves, Maxwell modes and stops, and so are the five silicones: they "
    "flatter it. `stiffening-tissue` is quasi-linear too, one curve with 24 modes, and of its "
    "class but for the steepness of the curve. Flow and damage were added with "
    "`bergstrom-boyce`, which creeps at a rate that depends on stress, and `mullins` in sight: "
    "their laws are others, their kind is the same. The fluid of `poro-viscoelastic` flows the "
    "slower the denser it is: no model of ours is of that class. "
    "Mach-1 is a real machine on a material that is not stated.\n"
)
EXPLAINED = (
    "Each cell: RMSE in % of the peak force of the test part, replayed through the emitted C, and "
    "below it the time of a tick. The best candidate is bold. floor: of a simulated object, the "
    "error that the object itself makes when it is moved along the measured positions (noise and "
    "steps of the sensors, drift); of Mach-1, the scatter of its cycles. auto / best: the error "
    "of what `auto` chose without the test part, of that of the best candidate. The last column: "
    "error of the stiffness of `hammerstein` on the way in, median and 95 %, and its floor. "
    "[recordings](../reference/recordings.md) says what the recordings are. `paper`: the "
    "paper's 27 presses, and 4 of its sums as a test; it and `third-repeat` press one object "
    "every 2 s, the others a fresh one each time; `slow-ramps` sampled at 50 Hz, `one-long` at "
    "100 Hz with a load cell that drifts by 0.1 N a minute, `preload` with a first position that "
    "reads 0.\n"
)


def percent(model: Metadata) -> float:
    """Error of a model of a cell; infinite where it failed."""
    return float(model.get("percent", np.inf))


def best_candidate(cell: Metadata) -> str:
    """The candidate of the lowest error on the test part."""
    names = [name for name in cell["models"] if name != AUTO]
    return min(names, key=lambda name: percent(cell["models"][name]))


def auto_ratio(cell: Metadata) -> float:
    """Error of `auto`'s choice, of that of the best candidate."""
    models = cell["models"]
    return percent(models[AUTO]) / percent(models[best_candidate(cell)])


def geometric(values: Sequence[float]) -> float:
    return float(np.exp(np.mean(np.log(values))))


def grouped(judges: Metadata) -> list[tuple[str, list[Metadata]]]:
    """Titles and cells: real data, foreign objects, kin; empty groups are left out."""
    found = [
        (title, [cell for name in names for cell in judges["cells"] if cell["object"] == name])
        for title, names in GROUPS
    ]
    return [(title, cells) for title, cells in found if cells]


def judges_section(judges: Metadata) -> list[str]:
    """Of docs/explanation/results.md."""
    parts = [
        "## Test objects that do not share our model's structure\n",
        f"`python tests/bench/judges.py`: {len(judges['cells'])} cells of object and recording; "
        f"{judges['machine']}; {judges['compiler']}; "
        f"commit {judges.get('commit', 'unknown')[:12]}.\n",
        KINSHIP,
        EXPLAINED,
        "| cells | auto / best, geometric mean | at most | where |\n| --- | --- | --- | --- |",
        *(choice_row(title, cells) for title, cells in grouped(judges)),
        choice_row("all", judges["cells"]),
    ]
    for title, cells in grouped(judges):
        parts += [f"\n### {title}\n", cells_table(cells, judges["candidates"])]
    failures = [
        f"- {cell['object']}, {cell['structure']}, {name}: {model['failed']}"
        for cell in judges["cells"]
        for name, model in cell["models"].items()
        if "failed" in model
    ]
    return [*parts, "\nFailed:\n" if failures else "\nNothing failed.", *failures, ""]


def choice_row(title: str, cells: Sequence[Metadata]) -> str:
    """How well `auto` chose in some cells."""
    ratios = [auto_ratio(cell) for cell in cells]
    worst = cells[int(np.argmax(ratios))]
    return (
        f"| {title}: {len(cells)} | {geometric(ratios):.2f} | {max(ratios):.2f} | "
        f"{worst['object']}, {worst['structure']} |"
    )


def cells_table(cells: Sequence[Metadata], names: Sequence[str]) -> str:
    """One row a cell, one column a candidate."""
    head = ["object", "recording", "floor, %", *names, "auto took", "auto / best", SLOPES]
    rows = [head, ["---"] * len(head)]
    for cell in cells:
        models, best = cell["models"], best_candidate(cell)
        rows.append([
            cell["object"], cell["structure"], floor_cell([cell]),
            *(model_cell(models.get(name), name == best) for name in names),
            models[AUTO].get("chosen", "-"), f"{auto_ratio(cell):.2f}",
            slope_cell(models.get(PASSIVE)),
        ])  # fmt: skip
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def slope_cell(model: Metadata | None) -> str:
    """Median and 95 % quantile of the error of the stiffness, and its floor."""
    if model is None or model.get("slope_floor_percent") is None:
        return "unknown"
    names = ("slope_error_median_percent", "slope_error_p95_percent", "slope_floor_percent")
    return "<br>".join(plain(model[name], 2) for name in names)


def floor_cell(cells: Sequence[Metadata]) -> str:
    """Geometric mean of the noise floors that are known."""
    floors = [cell["floor_percent"] for cell in cells if cell["floor_percent"] is not None]
    return plain(geometric(floors), 2) if floors else "unknown"


def model_cell(model: Metadata | None, best: bool) -> str:
    """Error, and below it the tick."""
    if model is None:
        return "-"
    if "failed" in model:
        return "failed"
    error = plain(model["percent"])
    return f"{f'**{error}**' if best else error}<br>{model['tick_ns']:.0f}&nbsp;ns"
