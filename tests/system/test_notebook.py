"""The notebook runs, cell by cell, on the real recording that it names."""

import json
import shutil
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest
from support.paths import ROOT

NOTEBOOK = json.loads((ROOT / "examples" / "mach1.ipynb").read_text())
CODE = ["".join(cell["source"]) for cell in NOTEBOOK["cells"] if cell["cell_type"] == "code"]


def test_it_is_stored_as_written() -> None:
    assert len(CODE) >= 5
    for cell in NOTEBOOK["cells"]:
        assert not cell.get("outputs")


@pytest.mark.slow
def test_it_runs(tmp_path: Path, shared_data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    mpl.use("Agg")
    shutil.copyfile(shared_data / "mach1" / "Dynamic_data.txt", "Dynamic_data.txt")
    names: dict[str, Any] = {}
    for source in CODE:
        exec(compile(source, "mach1.ipynb", "exec"), names)
    assert names["percent"] < 1.0
    difference, measured = (axes.lines[-1].get_ydata() for axes in (names["below"], names["above"]))
    assert abs(difference).max() < 0.05 * measured.max()
    names["plt"].close("all")
