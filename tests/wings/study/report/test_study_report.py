"""`springpot study report` on a study that simulated people did, and its files."""

import csv
import json
import re
from pathlib import Path

import pytest
from support.small_study import real_stimulus, study_text
from support.study_answers import rating_study, ratings, replies

from springpot.codegen.errors import DataError, UsageError
from springpot.host.cli import springpot
from springpot.host.wings.study.folder import copy_study, read_folder, write_study
from springpot.host.wings.study.observers.simulate import simulate
from springpot.host.wings.study.report.analysis import analyse
from springpot.host.wings.study.report.bids import write_bids
from springpot.host.wings.study.report.figures import psychometric_figure, rating_boxes
from springpot.host.wings.study.report.page import write_study_report
from springpot.host.wings.study.report.tables import write_tables

BLOCKS = {"soft": "ecoflex-00-10", "middle": "ecoflex-00-50", "hard": "dragon-skin-10"}
REAL = study_text(
    "similarity",
    [real_stimulus(name, simulated) for name, simulated in BLOCKS.items()],
    [{"left": "soft", "right": name, "factors": {"step": name}} for name in BLOCKS],
    sessions=2,
    equivalence={"margin": 8},
    sections={"question": [{"text": "Was it <hard>?", "choices": ["yes", "no"]}]},
)


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("study")
    (place / "study.toml").write_text(REAL)
    planned = write_study(place / "study.toml", 5, place / "plan", lambda *_: None)
    return simulate(planned, 5, 1, place / "data", lambda *_: None).folder.path


def rows_of(file: Path, delimiter: str = ",") -> list[dict[str, str]]:
    with file.open(newline="") as text:
        return list(csv.DictReader(text, delimiter=delimiter))


def test_the_page_says_what_the_tables_hold(simulated: Path, tmp_path: Path) -> None:
    result = write_study_report(simulated, tmp_path / "report")
    assert result["trials"] == 5 * 2 * 3
    page = (tmp_path / "report" / "report.html").read_text()
    assert result["out"] == str(tmp_path / "report" / "report.html")
    (effect,) = rows_of(tmp_path / "report" / "anova.csv")
    assert float(effect["f"]) == pytest.approx(result["anova"][0]["f"])
    assert f'<td class="n">{float(effect["f"]):.2f}</td>' in page
    for row in rows_of(tmp_path / "report" / "pairs.csv"):
        assert f"{float(row['difference']):+.1f} (" in page
    for row in rows_of(tmp_path / "report" / "conditions.csv"):
        assert float(row["min"]) <= float(row["median"]) <= float(row["max"])
    assert len(rows_of(tmp_path / "report" / "trials.csv")) == 30
    assert "Was it &lt;hard&gt;?" in page
    assert "no difference" not in page.replace("there is no difference</td>", "")
    assert "http" not in re.sub(r"http://www\.w3\.org|http://purl\.org|http://creativecommons\.org",
                                "", page)  # fmt: skip  # nothing is fetched
    for name in result["tables"]:
        assert (tmp_path / "report" / name).exists()


def test_the_command_prints_the_contract(
    simulated: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str(simulated)
    springpot.main(["study", "report", folder, "--out", str(tmp_path), "--json"],
                   standalone_mode=False)  # fmt: skip
    result = json.loads(capsys.readouterr().out)
    assert {"out", "trials", "excluded", "anova", "pairs", "equivalence", "power",
            "psychometric"} <= set(result)  # fmt: skip
    springpot.main(["study", "report", folder, "--out", str(tmp_path)], standalone_mode=False)
    assert "report.html" in "".join(capsys.readouterr().out.split())  # folded to the width


def test_bids(simulated: Path, tmp_path: Path) -> None:
    result = write_study_report(simulated, tmp_path / "report", tmp_path / "bids")
    bids = tmp_path / "bids"
    assert result["bids"]["files"] == 3 + 5 * 2 * 2
    assert json.loads((bids / "dataset_description.json").read_text())["Name"] == "a small study"
    assert [row["participant_id"] for row in rows_of(bids / "participants.tsv", "\t")] == [
        f"sub-0{k}" for k in range(1, 6)
    ]
    stem = bids / "sub-03" / "ses-2" / "beh" / "sub-03_ses-2_task-ASmallStudy_beh"
    table = rows_of(stem.with_suffix(".tsv"), "\t")
    sidecar = json.loads(stem.with_suffix(".json").read_text())
    assert len(table) == 3
    assert set(table[0]) <= set(sidecar)  # every column is explained
    assert {row["correct"] for row in table} == {"n/a"}
    with pytest.raises(UsageError, match="exists: give a new folder for --bids"):
        write_study_report(simulated, tmp_path / "report", bids)


def test_nothing_done_yet_is_said(simulated: Path, tmp_path: Path) -> None:
    empty = copy_study(read_folder(simulated), 2, tmp_path / "empty").path
    with pytest.raises(DataError, match="no finished trial yet: `springpot study run"):
        write_study_report(empty)
    with pytest.raises(DataError, match="no planned study"):
        write_study_report(tmp_path)


def test_the_same_answers_give_the_same_files(tmp_path: Path) -> None:
    study = rating_study()
    answers = ratings(study, 8)
    for name in ("one", "two"):
        found = analyse(study, answers, replies(study, 8))
        (tmp_path / name).mkdir()
        write_tables(found, answers, tmp_path / name)
        write_bids(found, answers, "participant_id\n", "0", tmp_path / name / "bids")
        (tmp_path / name / "boxes.svg").write_text(rating_boxes(found))
    files = sorted(file.relative_to(tmp_path / "one") for file in (tmp_path / "one").rglob("*.*"))
    assert len(files) > 20
    for file in files:
        if (tmp_path / "one" / file).is_file():
            assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


def test_excluded_people_stand_in_the_trials_and_in_both_tables(tmp_path: Path) -> None:
    study = rating_study()
    answers = ratings(study, 8)
    write_tables(analyse(study, answers, []), answers, tmp_path)
    trials = rows_of(tmp_path / "trials.csv")
    assert {row["participant"] for row in trials if row["excluded"] == "true"} == {"07", "08"}
    assert [row["people"] for row in rows_of(tmp_path / "anova.csv")] == ["kept"] * 3 + [
        "everybody"
    ] * 3


def test_a_figure_without_a_fit_still_shows_the_answers() -> None:
    from support.study_answers import choice_study, response

    study = choice_study("constant", (1.1, 1.2), 3)
    answers = [
        response("01", 1, k + 1, k % 2, ("standard", f"x1.{k % 2 + 1}"), False, "right", True)
        for k in range(6)
    ]
    found = analyse(study, answers, [])
    assert found.psychometric[0]["threshold"] is None
    assert "needs answers at 3" in found.psychometric[0]["why"]
    assert "<svg" in psychometric_figure(found.curves)
