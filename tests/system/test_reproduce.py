"""examples/reproduce.py: the paper's claims are judged both ways, by the public names alone."""

import importlib.util
import json
import re
import sys
from dataclasses import replace
from html import escape
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
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
    assert "springpot&#x27;s own: 35 % of" in page
    assert "<svg" in page
    assert not re.search(r"(src|href)=\"(?!#)", page)  # nothing outside it


def important(order: float) -> Any:
    return np.where(np.isclose(paper.ORDERS, order), 0.82, 0.02)


def result(name: str, **changed: Any) -> Any:
    """An object with which every claim that depends on it agrees."""
    rmse_n = {"rf-fd": 0.1, "rbf-fd": 0.1, "rbf-pv": 0.2}
    validated = {
        kind: {
            "mean_recording_rmse_n": error_n, "p99_abs_error_n": 0.3,
            "ape_below_jnd": 1.0 - 0.01 * error_n,
            "tick_ns": {"hot_median": tick_ns},
        }
        for (kind, error_n), tick_ns in zip(rmse_n.items(), (900.0, 300.0, 100.0), strict=True)
    }  # fmt: skip
    soft = name == "ecoflex-00-10"
    hands = {paper.PAST: paper.Hands(9, 8.0, 3), "rf-fd": paper.Hands(0, -2.0, 0)}
    return replace(
        paper.Result(
            name, paper.DEPTHS_MM[name], {"paper": paper.PAIRS[name], "cv": (0.1, 0.3)},
            important(0.30 if soft else 0.05),
            {"rf-fd": 0.1, "rbf-fd": 1.5, "rbf-pv": 2.0}, validated, hands, 0.01,
            dict.fromkeys(paper.KINDS, 1.0), dict.fromkeys(paper.KINDS, 2.0), {},
        ),
        **changed,
    )  # fmt: skip


def verdicts(**changed: Any) -> dict[str, list[str]]:
    """By item, of two objects: one that agrees, and one that is changed."""
    found: dict[str, list[str]] = {}
    for claim in paper.claims([result("ecoflex-00-10"), result("dragon-skin-fx", **changed)]):
        found.setdefault(claim.item, []).append(claim.verdict)
    return found


def swapped(first: str, second: str) -> dict[str, Any]:
    validated = dict(result("dragon-skin-fx").validated)
    validated[first], validated[second] = validated[second], validated[first]
    return {"validated": validated}


@pytest.mark.parametrize(
    ("changed", "differs"),
    [
        ({"hands": {paper.PAST: paper.Hands(9, 8.0, 3), "rf-fd": paper.Hands(1, -2.0, 0)}},
         {"negative damping"}),
        ({"hands": {paper.PAST: paper.Hands(9, 8.0, 0), "rf-fd": paper.Hands(0, -2.0, 0)}},
         {"rendering"}),
        ({"row_ratio": {"rf-fd": 1.2, "rbf-fd": 1.0, "rbf-pv": 1.0}}, {"rows"}),
        ({"pairs": {"paper": (0.1, 0.25), "cv": (0.1, 0.15)}}, {"table 2"}),
        (swapped("rbf-fd", "rbf-pv"), {"figure 8", "figure 9"}),
        ({"modelling_s": {"rf-fd": 1.5, "rbf-fd": 0.1, "rbf-pv": 0.1}}, {"figure 10"}),
        ({"importance": important(0.5)}, {"figure 11"}),
        ({"slow_change": 0.2}, {"figure 14"}),
    ],
)  # fmt: skip
def test_what_does_not_hold_of_one_object_differs(
    changed: dict[str, Any], differs: set[str]
) -> None:
    assert {item for item, found in verdicts(**changed).items() if "differs" in found} == differs


def test_sampling_times() -> None:
    assert paper.change_of_step(0.05, 1.2e-3) < 0.02
    assert 0.05 < paper.change_of_step(0.5, 1.2e-3) < 0.1
    assert paper.change_of_step(1.0, 1.2e-3) == pytest.approx(0.2, abs=0.02)
