"""The report: figures of R, the paper's design, its rules of exclusion."""

import json
from pathlib import Path

import numpy as np
import pytest
from support.paths import ROOT, TESTS
from support.small_study import rate_study

from springpot.host.study.definition import LOWER_BOUND, UPPER_BOUND, read_study
from springpot.host.study.plan import StudyPlan, make_orders, read_table
from springpot.host.study.report import anova, study_report, tukey
from springpot.host.study.session import RESPONSE_COLUMNS

R = json.loads((TESTS / "data" / "r_figures.json").read_text())


def test_analysis_of_variance_as_r_s_afex() -> None:
    found = {row.pop("effect"): list(row.values())
             for row in anova(np.array(R["afex"]["scores"]), ["a", "b"])}  # fmt: skip
    assert list(found) == ["a", "b", "a:b"]
    for effect, figures in R["afex"]["effects"].items():  # df1, df2, F, p
        assert found[effect] == pytest.approx(figures, rel=1e-9)


def test_tukey_s_test_as_r_s_emmeans() -> None:
    found = {row["first"] + row["second"]: row
             for row in tukey(np.array(R["emmeans"]["scores"]), "pqrs")}  # fmt: skip
    assert list(found) == list(R["emmeans"]["pairs"])
    for pair, (estimate, p) in R["emmeans"]["pairs"].items():
        row = found[pair]
        assert row["difference"] == pytest.approx(estimate, rel=1e-9)
        assert row["p_tukey"] == pytest.approx(p, rel=1e-4)
        assert row["low"] < row["difference"] < row["high"]
        assert (row["low"] < 0.0 < row["high"]) == (p > 0.05)


@pytest.fixture
def paper(tmp_path: Path) -> StudyPlan:
    """The paper's study with 18 people; scenes are not needed for its report."""
    study = read_study(ROOT / "host" / "scenes" / "paper-study.toml")
    people = tuple(f"{k:02d}" for k in range(1, 19))
    return StudyPlan(tmp_path, study, people, tuple(make_orders(study, people)))


def rows_of(plan: StudyPlan, person: str) -> list[dict[str, str]]:
    rows = read_table(plan.folder(person) / "responses.csv", RESPONSE_COLUMNS)
    return [row for row in rows if row["session"] != "0"]


def test_the_paper_s_design(paper: StudyPlan) -> None:
    rate_study(paper, {"RF-FD": -12.0, LOWER_BOUND: -75.0})
    found = study_report(paper)
    assert found["trials"] == 18 * 72
    assert (found["people"], found["unfinished"], found["notes"]) == (15, [], [])
    assert [(one["participant"], one["broken"]) for one in found["excluded"]] == [
        ("04", ["repeat_sd"]), ("06", ["side_difference"]),
        ("13", ["repeat_sd", "side_difference"]),
    ]  # fmt: skip
    anova_df = {row["effect"]: (row["df1"], row["df2"]) for row in found["anova"]}
    assert anova_df == {"Method": (3, 42), "Material": (4, 56), "Method:Material": (12, 168)}
    assert [(row["df1"], row["df2"]) for row in found["simple"]] == [(3, 42)] * 5  # as the paper's
    p = {row["effect"]: row["p"] for row in found["anova"]}
    assert p["Method"] < 1e-6
    assert min(p["Material"], p["Method:Material"]) > 0.01
    assert len(found["pairs"]) == 5 * 6
    for row in found["pairs"]:
        assert (row["p_tukey"] < 0.01) == ("RF-FD" in (row["first"], row["second"])), row
    assert len(found["conditions"]) == 21
    means = [np.mean([float(row["rating"]) for row in rows_of(paper, person)
                      if (row["method"], row["material"]) == (UPPER_BOUND, "Ecoflex 00-10")])
             for person in paper.participants if person not in ("04", "06", "13")]  # fmt: skip
    row = found["conditions"][3]
    assert (row["method"], row["material"]) == (UPPER_BOUND, "Ecoflex 00-10")
    assert row["mean"] == pytest.approx(np.mean(means))
    assert row["se"] == pytest.approx(np.std(means, ddof=1) / 15**0.5)
    assert found["conditions"][-1]["mean"] < 10.0
    counts = [(row["answer"], row["count"]) for row in found["questions"]]
    assert counts == [("no", 4), ("yes", 14)]
