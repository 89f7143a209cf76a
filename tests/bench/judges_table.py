"""Tables of tests/bench/judges.py: object x recording x candidate, and how well `auto` chose."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from springpot.host.simulation.objects import FOREIGN_OBJECTS, OBJECTS
from springpot.host.wings.evidence.benchmark.report import plain
from springpot.trainer.kinds import AUTO

Metadata = dict[str, Any]
MACH1 = "mach1"
GROUPS = (
    ("Mach-1, one frequency left out in turn", (MACH1,)),
    ("Foreign objects", FOREIGN_OBJECTS),
    ("The five silicones, hammerstein's own class", OBJECTS),
)
KINSHIP = (
    "Which of our models is of a judge's own class: `hammerstein` (and the passive part of "
    "`hybrid`) is made of curves, Maxwell modes and stops, and so are the five silicones: they "
    "flatter it. `stiffening-tissue` is quasi-linear too, one curve with 24 modes, and of its "
    "class but for the steepness of the curve. Of `mullins` its adaptation and drift are, its "
    "damage is not. `bergstrom-boyce` creeps at a rate that depends on stress, the fluid of "
    "`poro-viscoelastic` flows the slower the denser it is: no model of ours is of their class. "
    "Mach-1 is a real machine on a material that is not stated.\n"
)
EXPLAINED = (
    "Each cell: RMSE in % of the peak force of the test part, replayed through the emitted C, and "
    "below it the time of a tick. The best candidate is bold. floor: of a simulated object, the "
    "error that the object itself makes when it is moved along the measured positions (noise and "
    "steps of the sensors, drift); of Mach-1, the scatter of its cycles. auto / best: the error "
    "of what `auto` chose without the test part, of that of the best candidate. "
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
        "## Judges that are no kin\n",
        f"`python tests/bench/judges.py`: {len(judges['cells'])} cells of object and recording; "
        f"{judges['machine']}; {judges['compiler']}.\n",
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
    head = ["object", "recording", "floor, %", *names, "auto took", "auto / best"]
    rows = [head, ["---"] * len(head)]
    for cell in cells:
        models, best = cell["models"], best_candidate(cell)
        rows.append([
            cell["object"], cell["structure"], floor_cell([cell]),
            *(model_cell(models.get(name), name == best) for name in names),
            models[AUTO].get("chosen", "-"), f"{auto_ratio(cell):.2f}",
        ])  # fmt: skip
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


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


def judges_summary(judges: Metadata) -> str:
    """Of the README: one row an object, geometric means over its recordings."""
    names = judges["candidates"]
    head = ["object", "recordings", "floor, %", *names, "auto / best, at most"]
    rows = [head, ["---"] * len(head)]
    for title, cells in grouped(judges):
        rows.append([f"*{title}*", *[""] * (len(head) - 1)])
        for name in dict.fromkeys(cell["object"] for cell in cells):
            of_it = [cell for cell in cells if cell["object"] == name]
            means = [
                geometric([percent(cell["models"].get(kind, {})) for cell in of_it])
                for kind in names
            ]
            worst = max(auto_ratio(cell) for cell in of_it)
            shown = [plain(mean) if np.isfinite(mean) else "failed" for mean in means]
            rows.append([name, str(len(of_it)), floor_cell(of_it), *shown, f"{worst:.2f}"])
    table = "\n".join(f"| {' | '.join(row)} |" for row in rows)
    return (
        "Error in % of the peak force, geometric mean over recordings that ask for what was not "
        "trained (a depth left out, a third repeat, minutes of memory, another speed, a preload), "
        "through the emitted C; floor: what the sensors leave. The five silicones are of the model "
        "class of `hammerstein` itself and come last; "
        "[results](docs/explanation/results.md#judges-that-are-no-kin) has every cell, "
        f"and what each judge is.\n\n{table}"
    )
