"""Alike within a margin, and what a study of so many people can find."""

import numpy as np
import pytest
from scipy import stats

from springpot.codegen.errors import DataError, UsageError
from springpot.host.wings.study.statistics.equivalence import equivalence
from springpot.host.wings.study.statistics.power import (
    detectable,
    difference_power,
    equivalence_power,
    people_needed,
)


def test_equivalent_exactly_when_the_interval_is_within_the_margin() -> None:
    each = np.array([-2.0, 1.0, 0.5, 3.0, -1.0, 0.0])
    zero = ("b", np.zeros(6))
    found = equivalence(("a", each), zero, 1.0)
    widest = max(abs(found.low), abs(found.high))
    assert not equivalence(("a", each), zero, widest * 0.999).equivalent
    assert equivalence(("a", each), zero, widest * 1.001).equivalent


def test_equivalence_refuses_in_a_line() -> None:
    with pytest.raises(UsageError, match="margin 0"):
        equivalence(("a", np.arange(3.0)), ("b", np.zeros(3)), 0.0)
    with pytest.raises(DataError, match="2 people have scored both"):
        equivalence(("a", np.array([1.0, np.nan, 2.0])), ("b", np.zeros(3)), 5.0)
    with pytest.raises(DataError, match="equally far apart"):
        equivalence(("a", np.ones(3)), ("b", np.zeros(3)), 5.0)


def test_fifteen_people_find_a_difference_of_45_hundredths_in_37_percent_of_studies() -> None:
    assert difference_power(15, 0.45) == pytest.approx(0.3684922264, abs=1e-9)  # R's pwr.t.test
    assert people_needed(lambda n: difference_power(n, 0.45)) == 41  # 40.72 by pwr.t.test
    assert difference_power(15, detectable(15)) == pytest.approx(0.8, abs=1e-6)
    assert difference_power(15, 0.0) == pytest.approx(0.05, abs=1e-9)
    assert difference_power(80, 5.0) == 1.0


def test_power_of_equivalence_is_the_share_of_simulated_studies() -> None:
    studies = np.random.default_rng(2).normal(size=(100_000, 15))
    error = studies.std(axis=1, ddof=1) / 15**0.5 * stats.t.ppf(0.95, 14)
    for d_z in (0.0, 0.3):
        mean = studies.mean(axis=1) + d_z
        shown = np.mean((mean - error > -1.0) & (mean + error < 1.0))
        assert equivalence_power(15, 1.0, d_z) == pytest.approx(shown, abs=0.004)


def test_a_power_that_no_study_reaches_is_refused() -> None:
    with pytest.raises(UsageError, match="more than 100000 people"):
        people_needed(lambda n: difference_power(n, 1e-4))
    with pytest.raises(UsageError, match="power 1"):
        people_needed(lambda n: difference_power(n, 0.5), 1.0)


@pytest.mark.slow
def test_intervals_of_pairs_and_equivalence_hold_the_truth_in_93_to_97_percent() -> None:
    rng = np.random.default_rng(3)
    zero, held, alarms = np.zeros(15), 0, 0
    for _ in range(1000):
        each = rng.normal(10.0, 12.0, 15)  # the margin itself: equivalence would be an alarm
        found = equivalence(("a", each), ("b", zero), 10.0, alpha=0.025)
        held += found.low <= 10.0 <= found.high
        alarms += equivalence(("a", each), ("b", zero), 10.0).equivalent
    assert 930 <= held <= 970
    assert alarms <= 70
