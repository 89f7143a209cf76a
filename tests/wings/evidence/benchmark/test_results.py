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
FRONT = runpy.run_path(str(BENCH / "front_page.py"))


def stored() -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(SCRIPT["STORED"].read_text())
    return found


def cell(name: str, structure: str, chosen: str, **percents: float | str) -> dict[str, Any]:
    """A cell of errors; a text instead of one is a failure."""
    models = {
        kind.replace("_", "-"): {"failed": found}
        if isinstance(found, str)
        else {"percent": found, "tick_ns": 20.0}
        for kind, found in percents.items()
    }
    models["auto"] = {**models[chosen], "chosen": chosen}
    return {"object": name, "structure": structure, "floor_percent": 0.2,
            "spring_dashpot_percent": 5.0, "models": models}  # fmt: skip


JUDGES: dict[str, Any] = {
    "machine": "a machine",
    "compiler": "gcc",
    "candidates": ["hammerstein", "rf-fd", "auto"],
    "cells": [
        cell("ecoflex-00-30", "paper", "hammerstein", hammerstein=0.5, rf_fd=2.0),
        cell("mullins", "one-speed", "rf-fd", hammerstein=1.0, rf_fd=4.0),
        cell("mullins", "preload", "hammerstein", hammerstein=3.0, rf_fd="ValueError: no rows"),
        cell("mach1", "2Hz", "rf-fd", hammerstein=2.0, rf_fd=1.0),
    ],
}


def test_the_pages_are_written_from_the_benchmark() -> None:
    for path, text in SCRIPT["pages"](stored(), SCRIPT["stored_judges"]()).items():
        if path.suffix == ".svg":  # its curves are the library's of drawing, in its version
            shown = "<!-- .* % -->|<title>.*"  # the words of a text are a comment beside its curves
            assert re.findall(shown, path.read_text()) == re.findall(shown, text)
        else:
            assert path.read_text() == text, f"{path}: run python tests/bench/results.py"


def test_the_readme_s_bars_are_geometric_means_over_the_recordings() -> None:
    (_, one, real), (_, two, foreign) = FRONT["bars"](JUDGES)
    assert (one, two) == (1, 2)
    assert list(real.values()) == pytest.approx([1.0, 1.0, 5.0, 0.2])  # auto took the forest
    errors = {"springpot": (4.0 * 3.0) ** 0.5, "a spring and a dashpot": 5.0}
    assert {name: foreign[name] for name in errors} == pytest.approx(errors)
    assert foreign["the paper's random forest"] == float("inf")  # it failed once
    machines = [each for each in stored() if each["name"].startswith("Mach-1")]
    said = FRONT["sentence"](machines, SCRIPT["stored_judges"]())
    point = next(
        p for p in machines[0]["points"] if p["model"] == "hammerstein" and not p["options"]
    )
    assert f"{point['ram_bytes']} bytes of its RAM" in said
