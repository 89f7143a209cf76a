"""The paper's own study from end to end: its fifteen models, 18 simulated people, its report."""

import csv
from pathlib import Path

import pytest

from springpot.host.simulation.objects import OBJECTS
from springpot.host.wings.evidence.paper.evidence import STUDY, write_study_files
from springpot.host.wings.evidence.paper.reproduce import (
    PAPER_KINDS,
    Work,
    begin_object,
    fit_object,
    simulated,
    validators,
)
from springpot.host.wings.study.folder import write_study
from springpot.host.wings.study.observers.simulate import simulate
from springpot.host.wings.study.report.page import write_study_report

SMALL = Work(kinds=PAPER_KINDS, trees=20, presses=4, signals=1)


@pytest.mark.slow
def test_the_papers_study_runs_to_its_report(tmp_path: Path) -> None:
    with validators() as pool:
        for name in OBJECTS:
            data = simulated(name, "a", SMALL)
            fits = fit_object(data, SMALL)
            begin_object(data, fits, tmp_path / "models" / name, SMALL, pool)
    written = write_study_files(tmp_path / "study", tmp_path / "models", OBJECTS)
    assert written[-1].name == STUDY
    assert len(written) == 16
    folder = write_study(written[-1], 18, tmp_path / "plan", lambda _done, _of: None)
    found = simulate(folder, 18, 1, tmp_path / "people", lambda _done, _of: None)
    assert found.trials == 18 * (3 * 24 + 4)
    result = write_study_report(tmp_path / "people")
    assert result["trials"] == 18 * 3 * 24
    effects = {row["effect"]: (row["df1"], row["df2"]) for row in result["anova"]}
    assert effects == {"Method": (3, 51), "Material": (4, 68), "Method:Material": (12, 204)}
    assert len(result["pairs"]) == len(result["equivalence"]) == 5 * 6
    report = tmp_path / "people" / "report"
    with (report / "conditions.csv").open(newline="") as table:
        means = {row["condition"]: float(row["mean"]) for row in csv.DictReader(table)}
    assert len(means) == 21
    lowest = min(means, key=lambda condition: means[condition])
    assert "Ecoflex 00-10" in lowest
    assert "Dragon Skin 10" in lowest
    assert means[lowest] < 45 < min(mean for name, mean in means.items() if name != lowest)
    page = (report / "report.html").read_text()
    assert "Nobody was asked" in page
    assert "No condition could be double-blind" in page
