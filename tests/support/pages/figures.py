"""README's figures: docs/figures.json, that tests/bench/judges.py writes, as a table."""

import json
import re
from pathlib import Path
from typing import Any

from springpot.host.simulation.objects import FOREIGN_OBJECTS
from springpot.trainer.models.folds import geometric_mean
from support.paths import ROOT

FILE = ROOT / "docs/figures.json"
README = ROOT / "README.md"
PASSIVE, PAPER = "hammerstein", "the paper's random forest"
MACH1 = "mach1"
COMMAND = "python tests/bench/judges.py OUT --write"
# A cell that a test measures again: another fit, and README's figures are no longer true.
AGAIN = ("ecoflex-00-30", "paper")
_MARKED = re.compile(r"(<!-- figures: [^\n]* -->\n).*?(<!-- end -->\n)", re.S)

Cell = dict[str, Any]


def write_measured(page: Path, name: str, table: str) -> None:
    """Replace a table of a page that a script of tests/bench measures, between its marks."""
    mark = rf"(<!-- measured: {name} -->\n).*?(?=<!-- end -->)"
    before = page.read_text(encoding="utf-8")
    text, replaced = re.subn(mark, rf"\g<1>{table}\n", before, flags=re.S)
    assert replaced == 1, f"{page} has no table {name}"
    page.write_text(text, encoding="utf-8")


def groups(cells: list[Cell]) -> dict[str, list[Cell]]:
    """Cells of each bar chart, by its title."""
    return {
        "a real machine on a real material": [c for c in cells if c["object"] == MACH1],
        "objects of other laws than our models'": [
            c for c in cells if c["object"] in FOREIGN_OBJECTS
        ],
    }


def errors_percent(cells: list[Cell]) -> dict[str, float]:
    """Geometric means over cells, % of the peak force, as they are drawn."""
    return {
        "springpot": geometric_mean([c["models"][PASSIVE]["percent"] for c in cells]),
        PAPER: geometric_mean([c["models"][PAPER]["percent"] for c in cells]),
        "a spring and a dashpot": geometric_mean([c["spring_dashpot_percent"] for c in cells]),
        "noise of the sensors": geometric_mean([c["floor_percent"] for c in cells]),
    }


def table(figures: dict[str, Any]) -> str:
    """Return README's table of the figures, and how they were measured."""
    real, foreign = (errors_percent(cells) for cells in groups(figures["cells"]).values())
    models = next(c for c in figures["cells"] if (c["object"], c["structure"]) == AGAIN)["models"]
    ours, paper = models[PASSIVE], models[PAPER]

    def error_row(where: str, errors: dict[str, float]) -> str:
        times = errors[PAPER] / errors["springpot"]
        return (
            f"| error {where} | {errors['springpot']:.3g} % | {errors[PAPER]:.3g} % "
            f"| {times:.1f} times |\n"
        )

    return (
        f"| | springpot | {PAPER} | less by |\n| --- | --- | --- | --- |\n"
        + error_row("on a real testing machine", real)
        + error_row("on simulated objects of laws that no model here has", foreign)
        + f"| a step on a PC | {ours['tick_ns'] / 1e3:.2f} µs | {paper['tick_ns'] / 1e3:.2g} µs "
        f"| {paper['tick_ns'] / ours['tick_ns']:.0f} times |\n"
        f"| flash of a Cortex-M4 | {ours['flash_bytes']} bytes "
        f"| {paper['flash_bytes'] / 1e3:.0f} kB "
        f"| {paper['flash_bytes'] / ours['flash_bytes']:.0f} times |\n\n"
        f"RAM: {ours['ram_bytes']} bytes. Error: RMS of the emitted C in % of the peak force, "
        "geometric mean over recordings of other depths, speeds or frequencies than the trained "
        f"ones, of repeats and of minutes of memory (`{COMMAND}`). `springpot bench` measures the "
        "same on yours.\n"
    )


def written(page: str, figures: dict[str, Any]) -> str:
    """The page with the table of these figures."""
    return _MARKED.sub(lambda marked: marked[1] + table(figures) + marked[2], page)


def stored() -> dict[str, Any]:
    """The figures as the last run of `COMMAND` left them."""
    figures: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    return figures
