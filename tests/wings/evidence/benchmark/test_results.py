"""The README's figures and docs/explanation/results.md are what the stored benchmarks say."""

import json
import re
import runpy
import sys
from typing import Any

import pytest
from support.paths import BENCH

sys.path.append(str(BENCH))  # as where the script is run
SCRIPT = runpy.run_path(str(BENCH / "results.py"))
TABLE = runpy.run_path(str(BENCH / "judges_table.py"))


def stored() -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(SCRIPT["STORED"].read_text())
    return found


def cell(name: str, structure: str, chosen: str, **percents: float | str) -> dict[str, Any]:
    """A cell of errors; a text instead of one is a failure."""
    models = {
        kind: {"failed": found} if isinstance(found, str) else {"percent": found, "tick_ns": 20.0}
        for kind, found in percents.items()
    }
    models["auto"] = {**models[chosen], "chosen": chosen}
    return {"object": name, "structure": structure, "floor_percent": 0.2, "models": models}


JUDGES = {
    "machine": "a machine",
    "compiler": "gcc",
    "candidates": ["hammerstein", "forest", "auto"],
    "cells": [
        cell("ecoflex-00-30", "paper", "hammerstein", hammerstein=0.5, forest=2.0),
        cell("mullins", "one-speed", "forest", hammerstein=1.0, forest=4.0),
        cell("mullins", "preload", "hammerstein", hammerstein=3.0, forest="ValueError: no rows"),
        cell("mach1", "2Hz", "forest", hammerstein=2.0, forest=1.0),
    ],
}


def test_the_pages_are_written_from_the_benchmark() -> None:
    for path, text in SCRIPT["pages"](stored(), SCRIPT["stored_judges"]()).items():
        if path.suffix == ".svg":  # its curves are the library's of drawing, in its version
            assert re.findall("<title>.*", path.read_text()) == re.findall("<title>.*", text)
        else:
            assert path.read_text() == text, f"{path}: run python tests/bench/results.py"


def test_a_changed_figure_shows() -> None:
    changed = stored()
    changed[0]["points"][0]["rmse_n"] *= 2.0
    front = [p for p in changed[0]["points"] if p["pareto"]]
    front[0]["tick_ns_hot"] *= 3.0
    page = SCRIPT["ROOT"] / "docs" / "explanation" / "results.md"
    assert SCRIPT["pages"](changed, None)[page] != SCRIPT["pages"](stored(), None)[page]
    assert "in 2 s" in SCRIPT["readme_results"](stored()[0] | {"cpu_s": 2.0})


def test_judges_that_are_no_kin_come_first_and_failures_are_told() -> None:
    lines = TABLE["judges_section"](JUDGES)
    page = "\n".join(lines)
    titles = [line for line in page.splitlines() if line.startswith("### ")]
    assert titles == [f"### {title}" for title, _ in TABLE["GROUPS"]]
    tick = "<br>20&nbsp;ns"
    row = f"| 0.2 | **1**{tick} | 4{tick} | 4{tick} | forest | 4.00 |"
    assert f"| mullins | one-speed {row}" in page
    assert "- mullins, preload, forest: ValueError: no rows" in page
    # Of all four cells auto takes the best but once: the fourth root of 4.
    assert "| all: 4 | 1.41 | 4.00 | mullins, one-speed |" in page


def test_an_object_s_row_is_the_geometric_mean_of_its_recordings() -> None:
    rows = TABLE["judges_summary"](JUDGES).splitlines()
    names = [row.split(" | ")[0].removeprefix("| ") for row in rows if row.startswith("| ")]
    assert [name for name in names if not name.startswith("*")][1:] == [
        "---", "mach1", "mullins", "ecoflex-00-30",
    ]  # fmt: skip
    row = next(row for row in rows if row.startswith("| mullins"))
    assert row == "| mullins | 2 | 0.2 | 1.73 | failed | 3.46 | 4.00 |"


def test_benchmarks_of_hammerstein_s_own_class_come_last() -> None:
    benches = stored()
    kin = next(result for result in benches if "ecoflex" in result["name"])
    foreign = kin | {"name": "simulated mullins"}
    text = SCRIPT["pages"]([kin, foreign, *benches], None)
    titles = re.findall(
        "^## (.*)", text[SCRIPT["ROOT"] / "docs" / "explanation" / "results.md"], re.MULTILINE
    )
    assert titles == [
        "Mach-1 tester (Dynamic_data.txt)",
        "Simulated mullins",
        *2 * ["Simulated ecoflex-00-30"],
        "WebAssembly",
    ]


@pytest.mark.parametrize("name", ["ecoflex-00-10?variant=b", "dragon-skin-10"])
def test_the_silicones_are_hammerstein_s_kin(name: str) -> None:
    own_class = SCRIPT["own_class"]
    assert own_class(f"sim://{name}")
    assert not own_class("sim://mullins")
    assert not own_class("Dynamic_data.txt")
