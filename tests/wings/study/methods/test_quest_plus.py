"""QUEST+ against the sequences that Watson published (2017), as questplus's tests hold them."""

from itertools import product

import numpy as np
import pytest

from springpot.basics import Samples
from springpot.codegen.errors import UsageError
from springpot.host.wings.study.methods.quest_plus import QuestPlus

DB = tuple(float(level) for level in range(-40, 1))


def weibull_db(
    level: Samples, threshold: Samples, slope: Samples, guess: Samples, lapse: Samples
) -> Samples:
    """Weibull's function with level and threshold in decibel."""
    wrong = np.exp(-(10.0 ** (slope * (level - threshold) / 20.0)))
    return np.asarray(1.0 - lapse - (1.0 - guess - lapse) * wrong)


def levels(text: str) -> list[float]:
    """`-18 -19*3`: a level, and how often in a row."""
    pairs = ([*item.split("*"), "1"][:2] for item in text.split())
    return [float(level) for level, times in pairs for _ in range(int(times))]


def watson(slopes: list[float], lapses: list[float]) -> QuestPlus:
    grid = {"threshold": DB, "slope": slopes, "guess": [0.5], "lapse": lapses}
    return QuestPlus(DB, grid, weibull_db)


# Watson's last example: levels and answers, with four slopes and five lapses
SHOWN = (
    "-18 -22 -25 -28 -30 -21 -12 -14 -15 -16 -18 -19 -20 -22 -23 -18 -19 -16 -17*2 -18*3 -19*2 "
    "-17*2 -18*4 -19*2 -20 -18*5 -19*4 -20 -18*9 -19*3 -20 -18*4 -19*3 -18*4 -19*8 -20 -21 "
    "-19*7 -18 -19*2 -16*6 0*2 -19*14 -21*2 -19*16"
)
RIGHT = (
    "1111001111111101011111110111111110111111111011101111111101111110"
    "1111111111111010111101101111111011111111111111101110100111101111"
)
MODES = {"threshold": -20.0, "slope": 5.0, "lapse": 0.04}


def test_a_sequence_of_watson() -> None:
    quest = watson([2.0, 3.0, 4.0, 5.0], [0.0, 0.01, 0.02, 0.03, 0.04])
    expected, right = levels(SHOWN), [letter == "1" for letter in RIGHT]
    assert len(expected) == len(right)
    for trial, level in enumerate(expected):
        assert quest.next_level(expected[:trial], right[:trial]) == level
    place = int(quest.posterior(expected, right).argmax())
    point = list(product(*quest.parameters.values()))[place]
    found = dict(zip(quest.parameters, point, strict=True))
    assert {name: found[name] for name in MODES} == MODES


def test_nothing_but_the_history_counts() -> None:
    quest, shown, right = watson([3.5], [0.02]), [-18.0, -22.0, -25.0], [True, True, False]
    after = quest.next_level(shown, right)
    watson([3.5], [0.02]).next_level([], [])
    assert quest.next_level([], []) == -18.0
    assert quest.next_level(shown, right) == after
    assert quest.posterior(shown, right).sum() == pytest.approx(1.0)
    # the order of the answers does not matter
    assert quest.next_level(shown[::-1], right[::-1]) == after


def test_impossible_histories_are_refused() -> None:
    sure = QuestPlus((1.0, 2.0), {"edge": [1.5]}, lambda level, edge: 1.0 * (level > edge))
    with pytest.raises(UsageError, match="no parameters of the grid"):
        sure.next_level([2.0], [False])
    with pytest.raises(UsageError, match="7 is no level"):
        sure.next_level([7.0], [False])
    with pytest.raises(UsageError, match="not between 0 and 1"):
        QuestPlus((1.0,), {"edge": [1.5]}, lambda level, edge: level + edge)
