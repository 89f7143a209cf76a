"""Orders and sides: balanced, repeatable, and deaf to names."""

import collections
import itertools
from pathlib import Path

import pytest
from support.small_study import real_stimulus, real_study, study_text

from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.schedule import adaptive_trial, fixed_trials, williams_rows
from springpot.host.wings.study.study_file import read_study


def study_of(folder: Path, text: str) -> Study:
    (folder / "study.toml").write_text(text)
    return read_study(folder / "study.toml")


@pytest.mark.parametrize("conditions", range(2, 14))
def test_each_condition_follows_each_other_equally_often(conditions: int) -> None:
    rows = williams_rows(conditions)
    assert len(rows) == (2 * conditions if conditions % 2 else conditions)
    assert all(sorted(row) == list(range(conditions)) for row in rows)
    follows = collections.Counter(pair for row in rows for pair in itertools.pairwise(row))
    assert len(follows) == conditions * (conditions - 1)
    assert set(follows.values()) == {2 if conditions % 2 else 1}
    places = collections.Counter((place, one) for row in rows for place, one in enumerate(row))
    assert len(set(places.values())) == 1


def test_a_williams_study_is_balanced_over_its_sessions(tmp_path: Path) -> None:
    study = study_of(tmp_path, real_study(6, order="williams", sessions=2))
    follows = collections.Counter(
        pair
        for participant in range(1, 7)
        for session in (1, 2)
        for trials in [[trial.pair for trial in fixed_trials(study, participant, session)]]
        for pair in itertools.pairwise(trials)
    )
    assert set(follows.values()) == {2}
    assert len(follows) == 30


@pytest.mark.parametrize("repeats", [1, 2, 3, 5])
def test_sides_differ_by_one_at_most(tmp_path: Path, repeats: int) -> None:
    stimuli = [real_stimulus("a"), real_stimulus("b")]
    pairs = [{"left": "a", "right": "b", "repeats": repeats}]
    study = study_of(tmp_path, study_text("similarity", stimuli, pairs, sessions=3))
    whole = 0
    for participant in range(1, 8):
        sides = 0
        for session in range(1, 4):
            for trial in fixed_trials(study, participant, session):
                sides += 1 if trial.swapped else -1
                assert abs(sides) <= 1  # at every moment
        whole += sides
    assert abs(whole) <= 1  # of the group too


def test_abx_balances_sides_and_answers(tmp_path: Path) -> None:
    stimuli = [real_stimulus("a"), real_stimulus("b")]
    text = study_text("abx", stimuli, [{"left": "a", "right": "b", "repeats": 8}])
    trials = fixed_trials(study_of(tmp_path, text), 1, 1)
    combinations = collections.Counter((trial.swapped, trial.second) for trial in trials)
    assert combinations == dict.fromkeys([(False, False), (False, True), (True, False),
                                          (True, True)], 2)  # fmt: skip


def test_orders_are_random_and_repeat(tmp_path: Path) -> None:
    study = study_of(tmp_path, real_study(20, sessions=3))
    orders = {
        tuple(trial.pair for trial in fixed_trials(study, participant, session))
        for participant in range(1, 11)
        for session in (1, 2, 3)
    }
    assert len(orders) == 30
    assert fixed_trials(study, 4, 2) == fixed_trials(study, 4, 2)


def test_series_are_interleaved_and_sides_balanced(tmp_path: Path) -> None:
    stimuli = [real_stimulus("a")] + [
        {**real_stimulus(f"{name}{k}"), "level": 1.0 + k} for name in "xy" for k in (1, 2, 3)
    ]
    pairs = [{"left": "a", "right": f"{name}{k}", "series": name} for name in "xy"
             for k in (1, 2, 3)]  # fmt: skip
    study = study_of(tmp_path, study_text("staircase", stimuli, pairs))
    done: list[str] = []
    swapped = collections.Counter[str]()
    for _ in range(80):
        trial = adaptive_trial(study, 1, 1, ["x", "y"], done)
        done.append(trial.series)
        swapped[trial.series] += 1 if trial.swapped else -1
        assert abs(swapped[trial.series]) <= 1
    assert 25 < done.count("x") < 55
    assert {adaptive_trial(study, 1, 1, ["y"], done).series} == {"y"}
