"""The documents run: their commands give what the page says, in its order; so do the notebooks."""

import json
import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from support.pages.notebooks import QUICK_START, code_cells, run_cells
from support.pages.prepared_pages import PREPARED
from support.pages.run_pages import run_page
from support.paths import ROOT

MACH_1 = ROOT / "examples" / "mach1.ipynb"


@pytest.mark.slow
def test_the_readme_runs(tmp_path: Path) -> None:
    printed = " ".join(run_page("README.md", tmp_path).split())
    assert "0 ticks differ" in printed
    assert (tmp_path / "c" / "report.html").exists()


@pytest.mark.slow
def test_the_tutorial_of_a_material_scientist(tmp_path: Path) -> None:
    run_page("tutorials/material-scientist.md", tmp_path)


@pytest.mark.realtime
def test_the_tutorial_of_a_haptics_researcher(tmp_path: Path) -> None:
    run_page("tutorials/haptics-researcher.md", tmp_path)


@pytest.mark.realtime
def test_the_tutorial_of_an_embedded_engineer(tmp_path: Path) -> None:
    needs = ["arm"] if shutil.which("arm-none-eabi-gcc") else []
    run_page("tutorials/embedded-engineer.md", tmp_path, *needs)


@pytest.mark.slow
@pytest.mark.parametrize("name", PREPARED)
def test_a_page_runs(tmp_path: Path, name: str) -> None:
    PREPARED[name](tmp_path)
    run_page(name, tmp_path)


@pytest.mark.slow
def test_the_public_recording_runs(
    tmp_path: Path, mach1_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copyfile(mach1_file, "Dynamic_data.txt")
    names, outputs = run_cells(MACH_1)
    assert names["percent"] < 1.0
    difference, measured = (axes.lines[-1].get_ydata() for axes in (names["below"], names["above"]))
    assert abs(difference).max() < 0.05 * measured.max()
    assert "image/png" in outputs[-1][-1]["data"]


def shown(outputs: list[dict[str, Any]]) -> list[tuple[str, list[str]]]:
    """Of each output its text, without the digits, and the forms that it has."""
    found = []
    for one in outputs:
        data = one.get("data", {})
        text = "".join(one.get("text", data.get("text/plain", "")))
        found.append((re.sub(r"\d[\d.e+-]*", "#", text), sorted(data)))
    return found


@pytest.mark.slow
def test_the_quick_start_shows_what_is_stored(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`make notebook` renews it."""
    monkeypatch.chdir(tmp_path)
    names, outputs = run_cells(QUICK_START)
    stored = [cell["outputs"] for cell in code_cells(json.loads(QUICK_START.read_text()))]
    assert list(map(shown, outputs)) == list(map(shown, stored))
    assert names["found"].mismatches == 0
    assert names["found"].accuracy.rmse_percent_of_peak < 1.0
    assert QUICK_START.stat().st_size < 300_000
