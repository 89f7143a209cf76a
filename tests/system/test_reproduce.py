"""examples/reproduce.py: every claim of the paper has a verdict, by the public names alone."""

import json
import re
from html import escape
from pathlib import Path

import numpy as np
import paper_formulas as text
import pytest
from paper_claims import WORDS
from paper_page import TITLES, headline
from reproduce import reproduce
from support.paths import ROOT

STATED = WORDS["claim"]
SECTIONS = "I II III-A III-B III-C IV IV-A IV-B IV-C V VI-A VI-B VI-C VII A"
OF_SEVERAL = {  # or of another object
    "figure 7, Ecoflex 00-10", "figure 10, objects", "table 3, objects", "figure 11, hard objects",
    "figure 11, soft objects", "figure 17, hardness",
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning")  # few presses, few speeds
def test_little_work_is_written(tmp_path: Path) -> None:
    claims = reproduce(tmp_path / "out", ["dragon-skin-fx"], every=6, n=1, trees=5)
    found = json.loads((tmp_path / "out" / "claims.json").read_text())
    assert found == [vars(claim) for claim in claims]
    keys = ["section", "item", "paper", "criterion", "here", "verdict", "why"]
    assert all(list(claim) == keys for claim in found)
    for claim, stated in zip(found, STATED, strict=True):
        measured = {"not shown"} if claim["item"] in OF_SEVERAL else {"agrees", "differs"}
        assert claim["verdict"] in ({stated["verdict"]} if "verdict" in stated else measured), claim
        assert claim["here"] or "verdict" in stated or claim["item"] in OF_SEVERAL, claim
        assert not re.search(r"(?<![\de])-0(?![.\d])|nan|inf\b|e[+-]\d", claim["here"]), claim
    page = (tmp_path / "out" / "page.html").read_text()
    assert all(escape(claim["paper"]) in page for claim in found)
    assert headline(claims) in page and page.count("<svg") == 9
    assert all(f"<!-- {title} -->" in page for titles in TITLES.values() for title in titles)
    assert not re.search(r"(src|href)=\"(?!#)", page)  # nothing outside it


def test_claims_are_in_the_paper_s_order_and_every_figure_and_table_is_named() -> None:
    assert list(dict.fromkeys(claim["section"] for claim in STATED)) == SECTIONS.split()
    for claim in STATED:
        assert claim.get("verdict", "") in {"", "by construction", "not shown"}
        assert ("criterion" in claim) == ("verdict" not in claim), claim["item"]
        assert claim.get("why") or claim.get("verdict") != "not shown", claim["item"]
    items = " ".join(claim["item"].replace(" and ", " figure ") for claim in STATED)
    for number in range(1, 21):
        assert re.search(rf"figures? {number}(?!\d)", items), number
    assert all(f"table {number}" in items for number in (1, 2, 3))


def test_only_public_names() -> None:
    files = [file.read_text("utf-8") for file in (ROOT / "examples").glob("*.py")]
    assert len(files) == 7
    assert not any(re.search(r"springpot\.(codegen|trainer|host)", file) for file in files)


def test_formulas_of_the_text() -> None:
    assert text.change_of_step(0.05, 1.2e-3) < 0.02
    assert 0.05 < text.change_of_step(0.5, 1.2e-3) < 0.1
    assert text.change_of_step(1.0, 1.2e-3) == pytest.approx(0.2, abs=0.02)
    rate = text.derivative(text.press(), 1.0)[1:]
    np.testing.assert_allclose(rate, np.diff(text.press()) / 1e-3, atol=1e-9)
    limit = text.largest_damping_nspm()
    assert text.growth(0.99 * limit) < 1.0 < text.growth(1.01 * limit)
    assert text.growth(20e3) == pytest.approx(399.0, rel=0.01)
    tool_m = 0.003 * np.minimum(np.arange(2000) / 1000, 1.0)
    at_proxy, at_tool, printed = (
        text.coupled_n(tool_m, model, sign)[-1] / 0.003
        for model, sign in ((lambda _, tool, proxy: 3080.0 * proxy, -1.0),
                            (lambda _, tool, proxy: 3080.0 * tool, -1.0),
                            (lambda _, tool, proxy: 3080.0 * tool, 1.0))
    )  # fmt: skip
    assert (at_proxy, at_tool, printed) == pytest.approx((1008.7, 3080.0, -3080.0), rel=1e-3)
