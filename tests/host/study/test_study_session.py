"""Sessions of a study on a simulated device: what is felt and written; the report on them."""

import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from support.paths import ROOT, TESTS
from support.peer import CLI, wait_until
from support.small_study import DEVICE, Typist, planned_study, rate_study

from springpot import read_recordings
from springpot.codegen.errors import UsageError
from springpot.host.native.c_library import NONE
from springpot.host.study import session as study_session
from springpot.host.study.definition import LOWER_BOUND, RENDERED, UPPER_BOUND, read_study
from springpot.host.study.plan import StudyPlan, Trial, make_orders, read_table
from springpot.host.study.report import anova, consistency, study_report, tukey
from springpot.host.study.session import RESPONSE_COLUMNS, run_session


@pytest.fixture
def plan(tmp_path: Path) -> StudyPlan:
    return planned_study(tmp_path, 1)


def types(monkeypatch: pytest.MonkeyPatch, *lines: str, seconds: float = 0.18) -> None:
    monkeypatch.setattr("sys.stdin", Typist(list(lines), seconds))


@pytest.mark.slow
def test_sessions_to_the_last_question(plan: StudyPlan, monkeypatch: pytest.MonkeyPatch) -> None:
    """Practice, two sessions, of which one is stopped and goes on; the questions; the report."""
    types(monkeypatch, "l", "r", "50")
    assert run_session(plan, "01", DEVICE) == {
        "out": str(plan.folder("01")), "participant": "01", "session": 0, "done": 1,
        "stopped": "the session is over",
    }  # fmt: skip
    types(monkeypatch, "l", "70", "r", "101", "nan", "70", "r", "l", "71.5", "l", "q")
    stopped = run_session(plan, "01", DEVICE)
    assert (stopped["done"], stopped["stopped"]) == (2, "stopped: the same command goes on")
    types(monkeypatch, *("l", "r", "72") * 4)
    assert run_session(plan, "01", DEVICE)["done"] == 4
    types(monkeypatch, *("r", "l", "73") * 6, "no, never", "")
    last = run_session(plan, "01", DEVICE)
    assert (last["session"], last["done"]) == (2, 6)
    with pytest.raises(UsageError, match="participant 01 has finished all sessions"):
        run_session(plan, "01", DEVICE)

    rows, felt_n = read_table(plan.folder("01") / "responses.csv", RESPONSE_COLUMNS), []
    assert [Trial(*list(row.values())[:7]) for row in rows] == list(plan.trials)
    assert [row["rating"] for row in rows] == ["50", "70", "71.5", *["72"] * 4, *["73"] * 6]
    answers = (plan.folder("01") / "answers.csv").read_text().splitlines()
    assert answers[1:] == ['01,Did it shake?,"no, never"', "01,What else?,"]
    assert {file.suffix for file in plan.folder("01").iterdir()} == {".csv", ".h5"}

    found = study_report(plan)
    assert (found["trials"], found["people"], found["excluded"]) == (len(rows) - 1, 1, [])
    for one in found["conditions"]:
        condition = {"method": one["method"], "material": one["material"]}
        ratings = [float(row["rating"]) for row in rows[1:] if condition.items() <= row.items()]
        assert one["mean"] == pytest.approx(np.mean(ratings))

    # On a real object the force is zero; on the rendered side it is felt: in the log of each trial.
    for row in rows:
        (log,) = read_recordings(plan.folder("01") / row["log"])
        called = (log.channels["call"].astype(int) & NONE) == 0
        pressing = log.position_m > 1e-3
        assert not log.force_n[~called].any() and (pressing & ~called).any()
        if "rendered" in (row["left"], row["right"]):
            felt_n.append(log.force_n[called & pressing].max(initial=0.0))
        else:
            assert called.sum() < 100  # until the pause
        assert float(row["seconds"]) > 0.45
    assert np.median(felt_n) > 0.2  # a busy machine may take one from the hand


def test_killed_in_a_trial_and_a_row_cut_it_goes_on(plan: StudyPlan) -> None:
    command = [*CLI, "study", "run", str(plan.path), "--participant", "01", "--device", DEVICE]
    file = plan.folder("01") / "responses.csv"
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.DEVNULL) as host:
        journal = plan.folder("01") / "session-0-trial-01.journal"
        wait_until(lambda: journal.exists() and journal.stat().st_size > 2 * 4096, 60, "no log")
        host.kill()
    assert file.read_text() == ",".join(RESPONSE_COLUMNS) + "\n"
    with file.open("a") as torn:
        torn.write("01,0,1,REAL,so")
    again = plan.folder("01") / "session-0-trial-01-again-2.journal"
    typed = (
        "import pathlib, sys, time\n"
        "while not pathlib.Path(sys.argv[1]).exists(): time.sleep(0.1)\n"
        "for line in ('l', 'r', '60'): time.sleep(0.3), print(line, flush=True)"
    )
    with subprocess.Popen([sys.executable, "-c", typed, again], stdout=subprocess.PIPE) as typist:
        done = subprocess.run([*command, "--json"], stdin=typist.stdout, capture_output=True,
                              text=True, check=False)  # fmt: skip
    assert json.loads(done.stdout)["done"] == 1, done.stderr
    (row,) = read_table(file, RESPONSE_COLUMNS)
    assert row["log"] == "session-0-trial-01-again-2.h5"


def test_no_side_is_felt_after_the_watchdog_until_reset(monkeypatch: pytest.MonkeyPatch) -> None:
    called: list[str] = []
    state = SimpleNamespace(latched=False, tripped=False)
    session = SimpleNamespace(
        state=state, over=False,
        pause=lambda: called.append("pause"), resume=lambda: called.append("resume"),
        reset=lambda: (called.append("reset"), setattr(state, "tripped", False)),
    )  # fmt: skip
    trial = SimpleNamespace(left="rendered", right="real soft")
    types(monkeypatch, "l", "r", "30", seconds=0.0)
    assert study_session._ask(trial, session) == 30.0 and called == ["resume", "pause"]
    state.tripped = True
    types(monkeypatch, "l", "r", "50", "reset", "l", "r", "40", seconds=0.0)
    assert study_session._ask(trial, session) == 40.0 and called[2:] == ["reset", "resume", "pause"]
    session.over = True
    types(monkeypatch, "50", seconds=0.0)
    assert study_session._ask(trial, session) is None


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
    study = read_study(ROOT / "examples" / "paper_study.toml")
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
    assert p["Method"] < 1e-6 and min(p["Material"], p["Method:Material"]) > 0.01
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


@pytest.mark.parametrize(("more_left", "broken"), [(30, True), (-30, True), (20, False)])
def test_a_person_who_prefers_a_side_is_left_out_whichever_it_is(
    more_left: int, broken: bool
) -> None:
    study = SimpleNamespace(exclude_repeat_sd_above=None, exclude_side_difference_above=25.0)
    answers = [
        {"left": RENDERED, "right": "real", "method": "a", "material": "m",
         "rating": str(50 + more_left)},
        {"left": "real", "right": RENDERED, "method": "a", "material": "m", "rating": "50"},
    ]  # fmt: skip
    figures = consistency(study, answers)
    assert figures["side_difference"] == more_left
    assert figures["broken"] == (["side_difference"] if broken else [])
