"""Layouts of public recordings: each imported as it is meant, or refused with what to do."""

import json
import shlex
import tomllib
from pathlib import Path
from typing import Any

import pytest
from support.files.recording_files import write_table
from support.in_process import spring
from support.paths import ROOT

LAYOUTS = tomllib.loads((ROOT / "tests/data/real.toml").read_text("utf-8"))["layout"]


@pytest.mark.parametrize("facts", LAYOUTS, ids=lambda facts: facts["name"])
def test_layout(facts: dict[str, Any], tmp_path: Path) -> None:
    file = tmp_path / "press.csv"
    write_table(file, facts)
    options = shlex.split(facts.get("options", ""))
    found = spring("import", file, *options, "--out", tmp_path / "out", "--json")
    for words in facts.get("says", []):
        assert words in found.stderr
    if facts.get("expect") == "refused":
        assert found.returncode == 3
        assert not (tmp_path / "out").exists()
        return
    assert found.returncode == 0, found.stderr
    (row,) = json.loads(found.stdout)["recordings"]
    (low_m, high_m), (_, peak_n) = row["position_m"], row["force_n"]
    assert high_m - low_m == pytest.approx(facts["stroke_mm"] * 1e-3, rel=0.02)
    assert peak_n == pytest.approx(facts["peak_n"], rel=0.02)
    assert row["rate_hz"] == pytest.approx(facts.get("rate_hz", 200.0), rel=0.02)
