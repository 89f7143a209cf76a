"""examples/reproduce.py: the paper's claims are judged both ways, by the public names alone."""

import importlib.util
import json
import re
import sys
from html import escape
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from support.paths import ROOT

FILE = ROOT / "examples" / "reproduce.py"


def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location("reproduce", FILE)
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules["reproduce"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


paper: Any = example()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning")  # few presses, few speeds
def test_little_work_is_written(tmp_path: Path) -> None:
    claims = paper.reproduce(tmp_path / "out", ["dragon-skin-fx"], every=6, n=1, trees=5)
    stored = json.loads((tmp_path / "out" / "claims.json").read_text())
    assert stored == [vars(claim) for claim in claims]
    keys = ["section", "item", "paper", "criterion", "here", "verdict", "why"]
    assert all(list(claim) == keys for claim in stored)
    assert {claim["verdict"] for claim in stored} <= {
        "agrees", "differs", "by construction", "not shown",
    }  # fmt: skip
    page = (tmp_path / "out" / "page.html").read_text()
    assert all(escape(claim["paper"]) in page for claim in stored)
    assert paper.headline(claims) in page
    assert "springpot&#x27;s default: 35 % of" in page
    assert "<svg" in page
    assert not re.search(r"(src|href)=\"(?!#)", page)  # nothing outside it


def test_sampling_times() -> None:
    assert paper.change_of_step(0.05, 1.2e-3) < 0.02
    assert 0.05 < paper.change_of_step(0.5, 1.2e-3) < 0.1
    assert paper.change_of_step(1.0, 1.2e-3) == pytest.approx(0.2, abs=0.02)
