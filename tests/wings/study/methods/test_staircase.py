"""Staircases: their steps, their end, and where they settle."""

import numpy as np
import pytest

from springpot.codegen.errors import UsageError
from springpot.host.wings.study.methods.staircase import Staircase

LEVELS = tuple(float(level) for level in range(10))


def test_harder_after_two_right_easier_after_one_wrong() -> None:
    staircase = Staircase(LEVELS)
    shown = []
    right = [True, True, True, True, False, True, False, True, True]
    for trial in range(len(right) + 1):
        shown.append(staircase.next_level(right[:trial]))
    assert shown == [9, 9, 8, 8, 7, 8, 8, 9, 9, 8]


def test_ends_after_its_reversals_or_trials() -> None:
    staircase = Staircase(LEVELS, down=1, start=5, reversals=4, skipped=2)
    assert staircase.next_level([True, False, True]) is not None
    assert staircase.next_level([True, False, True, False, True]) is None
    assert staircase.threshold([True, False, True, False, True]) == 4.5
    assert staircase.threshold([True, False]) is None
    assert Staircase(LEVELS, max_trials=3).next_level([False] * 3) is None


def test_settings_that_make_no_staircase_are_refused() -> None:
    with pytest.raises(UsageError, match="two levels or more, rising"):
        Staircase((2.0, 1.0))
    with pytest.raises(UsageError, match="no such step"):
        Staircase(LEVELS, down=0)
    with pytest.raises(UsageError, match="more reversals"):
        Staircase(LEVELS, reversals=4, skipped=4)


@pytest.mark.slow
@pytest.mark.parametrize(("down", "share"), [(2, 0.5**0.5), (3, 0.5 ** (1 / 3))])
def test_settles_where_n_right_in_a_row_are_as_likely_as_not(down: int, share: float) -> None:
    rng = np.random.default_rng(1)
    levels = tuple(np.linspace(-3.0, 3.0, 61))
    staircase = Staircase(levels, down, reversals=40, skipped=10, max_trials=1000)
    settled = []
    for _ in range(1000):
        middle, steep = rng.uniform(-0.5, 0.5), rng.uniform(1.5, 3.0)
        answers: list[bool] = []
        while (level := staircase.next_level(answers)) is not None:
            answers.append(
                bool(rng.random() < 0.5 + 0.5 / (1.0 + np.exp(-steep * (level - middle))))
            )
        threshold = staircase.threshold(answers)
        settled.append(0.5 + 0.5 / (1.0 + np.exp(-steep * (threshold - middle))))
    assert np.mean(settled) == pytest.approx(share, abs=0.01)
