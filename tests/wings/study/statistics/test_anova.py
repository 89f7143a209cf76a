"""Repeated-measures analysis of variance; its figures are compared in test_against_r.py."""

import numpy as np
import pytest

from springpot.codegen.errors import DataError, UsageError
from springpot.host.wings.study.statistics.anova import repeated_measures


def test_what_cannot_be_analysed_is_refused_in_a_line() -> None:
    scores = np.random.default_rng(3).normal(size=(5, 2, 3))
    with pytest.raises(UsageError, match="one or two factors"):
        repeated_measures(scores, ["a"])
    with pytest.raises(DataError, match="2 people"):
        repeated_measures(scores[:2], ["a", "b"])
    with pytest.raises(DataError, match="one level"):
        repeated_measures(scores[:, :1], ["a", "b"])
    with pytest.raises(DataError, match=r"everybody's scores differ alike"):
        repeated_measures(np.add.outer(np.arange(4.0), np.arange(3.0)), ["a"])
    scores[3, 1, 2] = np.nan
    with pytest.raises(DataError, match=r"1 scores are missing, the first of person 4 .* 2 x 3"):
        repeated_measures(scores, ["a", "b"])


@pytest.mark.slow
def test_greenhouse_geisser_alarms_in_at_most_6_percent_of_null_studies() -> None:
    rng = np.random.default_rng(4)
    alarms = np.zeros(2)
    for _ in range(2000):
        loading = rng.normal(size=(5, 5)) * np.array([4.0, 2.0, 1.0, 0.5, 0.25])
        (effect,) = repeated_measures(rng.normal(size=(15, 5)) @ loading.T, ["a"])
        alarms += [effect.p_gg < 0.05, effect.p < 0.05]
    assert alarms[0] <= 0.06 * 2000
    assert alarms[1] > 0.06 * 2000  # what the correction is for
