"""A study file, its orders and sides, its tables: as written, or refused."""

from collections import Counter
from pathlib import Path

import pytest
from support.paths import ROOT
from support.small_study import planned_study

from springpot.codegen.errors import DataError, UsageError
from springpot.host.study.definition import LOWER_BOUND, RENDERED, UPPER_BOUND, read_study
from springpot.host.study.plan import append_only_table, make_orders, read_plan, write_plan

PAPER = ROOT / "examples" / "paper_study.toml"


def test_every_session_has_every_condition_in_an_order_of_its_own() -> None:
    study = read_study(PAPER)
    people = [f"{k:02d}" for k in range(1, 19)]
    trials = make_orders(study, people)
    wanted = Counter(condition[:2] for condition in study.session_trials())
    orders = set()
    for person in people:
        for session in ("1", "2", "3"):
            own = [one for one in trials if (one.participant, one.session) == (person, session)]
            assert [one.trial for one in own] == [str(k) for k in range(1, 25)]
            assert Counter((one.method, one.material) for one in own) == wanted
            orders.add(tuple((one.method, one.material) for one in own))
        assert sum((one.participant, one.session) == (person, "0") for one in trials) == 4
    assert len(orders) == 18 * 3
    for one in trials:
        names = [f"real {name}" for name in one.material.split(" | ")]
        second = RENDERED if one.method not in (UPPER_BOUND, LOWER_BOUND) else names[-1]
        assert {one.left, one.right} == {names[0], second}
    rendered = [one for one in trials if RENDERED in (one.left, one.right)]
    left = sum(one.left == RENDERED for one in rendered)
    assert abs(left - len(rendered) / 2) < 3 * len(rendered) ** 0.5 / 2  # three deviations


@pytest.mark.filterwarnings("ignore:.*not as springpot emitted it:UserWarning")
def test_a_plan_that_was_changed_is_refused(tmp_path: Path) -> None:
    plan = planned_study(tmp_path)
    orders = tuple(make_orders(plan.study, ["01", "02"]))
    assert read_plan(plan.path).trials == plan.trials == orders
    for name in ("study.toml", "orders.csv", "scenes/1-passive/sp.c"):
        before = (plan.path / name).read_bytes()
        (plan.path / name).write_bytes(before + b"\n")
        with pytest.raises(DataError, match=Path(name).parts[-2] if "scenes" in name else name):
            read_plan(plan.path)
        (plan.path / name).write_bytes(before)
    scenes = plan.path / "scenes"
    (scenes / "1-passive").rename(scenes / "kept")
    (scenes / "2-passive").rename(scenes / "1-passive")
    (scenes / "kept").rename(scenes / "2-passive")
    with pytest.raises(DataError, match="scenes/1-passive: changed since the plan: restore it"):
        read_plan(plan.path)
    with pytest.raises(UsageError, match="plan: exists and is not overwritten: give a new folder"):
        write_plan(tmp_path / "study.toml", 2, plan.path)
    with pytest.raises(DataError, match="no planned study: `springpot study plan` makes one"):
        read_plan(tmp_path)


COLUMNS = ("who", "said")
ROWS = [["01", 'a "word", and\u00e9'], ["01", "70"]]


def test_a_table_cut_at_any_byte_loses_no_whole_row(tmp_path: Path) -> None:
    file = tmp_path / "t.csv"
    with append_only_table(file, COLUMNS) as (rows, append):
        assert rows == []
        for row in ROWS:
            append(row)
            assert file.read_bytes().endswith(b"\n")  # on the disk when `append` is back
    whole = file.read_bytes()
    for cut in range(len(whole) + 1):
        file.write_bytes(whole[:cut])
        left = max(0, whole[:cut].count(b"\n") - 1)
        with append_only_table(file, COLUMNS) as (rows, append):
            assert [list(row.values()) for row in rows] == ROWS[:left]
            for row in ROWS[left:]:
                append(row)
        assert file.read_bytes() == whole
