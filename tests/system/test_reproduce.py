"""examples/reproduce.py: every claim of the paper has a verdict, by the public names alone."""

import json
import re
import tomllib
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.paths import ROOT

FOLDER = ROOT / "examples"
STATED = tomllib.loads((FOLDER / "paper.toml").read_text("utf-8"))["claim"]
OF_SEVERAL = {  # or of another object
    "IV-C, figure 7, Ecoflex 00-10", "IV-C, figure 10, objects", "V, table 3, objects",
    "IV-C, figure 11, hard objects", "IV-C, figure 11, soft objects", "VI-B, figure 17, hardness",
}  # fmt: skip


@pytest.fixture
def module() -> Iterator[Any]:
    """Import one of the files beside each other."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(FOLDER))
        yield __import__


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning")  # few presses, few speeds
def test_little_work_is_written(tmp_path: Path, module: Any) -> None:
    work = {"every": 6, "n": 1, "trees": 5}
    claims = module("reproduce").reproduce(tmp_path / "out", ["dragon-skin-fx"], **work)
    found = json.loads((tmp_path / "out" / "claims.json").read_text())
    assert found == [vars(claim) for claim in claims]
    keys = ["section", "item", "paper", "criterion", "here", "verdict", "why"]
    assert all(list(claim) == keys for claim in found)
    for claim, stated in zip(found, STATED, strict=True):
        name = f"{claim['section']}, {claim['item']}"
        few = {"not shown"} if name in OF_SEVERAL else {"agrees", "differs"}
        assert claim["verdict"] in ({stated["verdict"]} if "verdict" in stated else few), name
        assert claim["here"] or "verdict" in stated or name in OF_SEVERAL, name
        assert not re.search(r"(?<![\de])-0(?![.\d])|nan|inf\b|e[+-]\d", claim["here"]), name
    page = (tmp_path / "out" / "page.html").read_text()
    assert all(escape(claim["paper"]) in page for claim in found)
    assert module("paper_page").headline(claims) in page
    assert page.count("<svg") == 9
    assert not re.search(r"(src|href)=\"(?!#)", page)  # nothing outside it


def test_claims_are_in_the_paper_s_order_and_every_figure_and_table_is_named() -> None:
    sections = ["I", "II", "III-A", "III-B", "III-C", "IV", "IV-A", "IV-B", "IV-C", "V", "VI-A",
                "VI-B", "VI-C", "VII", "A"]  # fmt: skip
    assert list(dict.fromkeys(claim["section"] for claim in STATED)) == sections
    for claim in STATED:
        assert claim.get("verdict", "") in {"", "by construction", "not shown"}
        assert ("criterion" in claim) == ("verdict" not in claim), claim["item"]
        assert claim.get("why") or claim.get("verdict") != "not shown", claim["item"]
    items = " ".join(claim["item"].replace(" and ", " figure ") for claim in STATED)
    for number in range(1, 21):
        assert re.search(rf"figures? {number}(?!\d)", items), number
    assert all(f"table {number}" in items for number in (1, 2, 3))


def test_only_public_names() -> None:
    texts = [file.read_text("utf-8") for file in FOLDER.glob("*.py")]
    assert len(texts) == 5
    assert not any(re.search(r"springpot\.(codegen|trainer|host)", text) for text in texts)


def test_formulas_of_the_text(module: Any) -> None:
    text = module("paper_formulas")
    assert text.change_of_step(0.05, 1.2e-3) < 0.02
    assert 0.05 < text.change_of_step(0.5, 1.2e-3) < 0.1
    assert text.change_of_step(1.0, 1.2e-3) == pytest.approx(0.2, abs=0.02)
    press = text.press()
    np.testing.assert_allclose(text.derivative(press, 1.0)[1:], np.diff(press) / 1e-3, atol=1e-9)
    limit = text.largest_damping_nspm()
    assert text.growth(0.99 * limit) < 1.0 < text.growth(1.01 * limit)
    assert text.growth(20e3) == pytest.approx(399.0, rel=0.01)
    tool_m = 0.003 * np.minimum(np.arange(2000) / 1000, 1.0)
    felt = [text.coupled_n(tool_m, lambda _, tool, proxy: 3080.0 * proxy)[-1],
            text.coupled_n(tool_m, lambda _, tool, proxy: 3080.0 * tool)[-1]]  # fmt: skip
    assert felt == pytest.approx([0.003 * 1008.7, 0.003 * 3080.0], rel=1e-3)
    assert text.coupled_n(tool_m, lambda _, tool, proxy: 500.0 * tool, 1.0)[-1] < -1.4  # as printed
