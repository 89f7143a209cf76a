"""Adaptive methods: which pair of a series comes next, and which series are still open.

Levels are steps, from the standard to the comparison. Of two, the person names the greater one; the
share of right answers is that of two feelings with Gaussian noise, from one half at no step.
"""

from collections.abc import Sequence

import numpy as np

from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.methods.quest_plus import QuestPlus, cumulative_normal
from springpot.host.wings.study.methods.staircase import Staircase

History = Sequence[tuple[int, bool]]  # pair, and whether the answer was right
_LAPSES = (0.0, 0.02, 0.05)
_DEVIATIONS = 40  # of the difference of two feelings, from a quarter of the smallest step to twice
# the largest one


def next_pair(study: Study, series: str, history: History) -> int:
    """Return index of the pair to show next in an open series."""
    steps, right = _answers(study, series, history)
    found = (
        staircase(study, series).next_level(right)
        if study.method == "staircase"
        else quest_plus(study, series).next_level(steps, right)
    )
    assert found is not None, "the series is over"
    return next(k for k in study.pairs_of(series) if study.step(k) == found)


def open_series(study: Study, history: History) -> list[str]:
    """Return series that need more trials."""
    return [name for name in study.all_series if not _is_over(study, name, history)]


def staircase(study: Study, series: str) -> Staircase:
    """Return the staircase of a series."""
    rule = study.staircase
    levels = tuple(sorted(study.step(k) for k in study.pairs_of(series)))
    return Staircase(levels, rule.down, -1, rule.reversals, rule.skipped, rule.trials)


def quest_plus(study: Study, series: str) -> QuestPlus:
    """Return QUEST+ of a series, for the deviation of a difference of feelings and for lapses."""
    levels = tuple(sorted(study.step(k) for k in study.pairs_of(series)))
    deviations = np.geomspace(levels[0] / 4, 2 * levels[-1], _DEVIATIONS)
    grid = {"deviation": deviations.tolist(), "lapse": list(_LAPSES)}
    return QuestPlus(levels, grid, _share)


def _share(level: float, deviation: np.ndarray, lapse: np.ndarray) -> np.ndarray:
    none = np.zeros_like(deviation)
    return cumulative_normal(np.asarray(level), none, deviation, lapse / 2, lapse / 2)


def _is_over(study: Study, series: str, history: History) -> bool:
    _, right = _answers(study, series, history)
    if study.method == "staircase":
        return staircase(study, series).next_level(right) is None
    return len(right) >= study.quest.trials


def _answers(study: Study, series: str, history: History) -> tuple[list[float], list[bool]]:
    of = [(study.step(k), right) for k, right in history if study.pair[k].series == series]
    return [step for step, _ in of], [right for _, right in of]
