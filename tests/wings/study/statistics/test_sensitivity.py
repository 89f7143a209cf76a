"""d' of three methods against R's psyphy, and intervals whose coverage is summed exactly."""

import numpy as np
import pytest
from scipy import stats

from springpot.codegen.errors import DataError, UsageError
from springpot.host.wings.study.statistics.sensitivity import (
    abx_correct,
    different_rate,
    sensitivity,
)


def many(method: str, hit_rate: float, false_alarm_rate: float) -> float:
    """d' of so many trials that the correction is nothing."""
    n = 10**9
    found = sensitivity(method, round(hit_rate * n), n, round(false_alarm_rate * n), n)
    return found.d_prime


def test_d_prime_as_psyphy() -> None:
    assert many("2afc", 0.75, 0.25) == pytest.approx(0.9538726011, abs=1e-5)  # dprime.mAFC
    assert many("abx", 0.75, 0.25) == pytest.approx(2.0200381344, abs=1e-4)  # dprime.ABX, "diff"
    assert many("abx", 0.9, 0.1) == pytest.approx(3.2631079618, abs=1e-4)
    assert many("same-different", 0.642, 0.3) == pytest.approx(1.9506046697, abs=1e-4)  # dprime.SD
    assert many("same-different", 0.9, 0.1) == pytest.approx(4.1385622127, abs=1e-4)


def test_no_difference_is_d_prime_zero() -> None:
    for method in ("2afc", "abx", "same-different"):
        found = sensitivity(method, 12, 30, 12, 30)
        assert found.d_prime == pytest.approx(0.0, abs=1e-6)
        assert found.low <= 0.0 < found.high < 3.0


def test_all_right_answers_bound_d_prime_from_below() -> None:
    for method in ("2afc", "abx", "same-different"):
        found = sensitivity(method, 30, 30, 0, 30)
        assert 2.0 < found.low < found.d_prime < found.high
    assert sensitivity("abx", 30, 30, 0, 30).high == np.inf
    assert sensitivity("2afc", 0, 30, 30, 30).d_prime < -2.0  # sides taken for each other


def test_what_cannot_be_counted_is_refused() -> None:
    with pytest.raises(UsageError, match="method triangle"):
        sensitivity("triangle", 1, 2, 1, 2)
    with pytest.raises(DataError, match="31 of 30"):
        sensitivity("abx", 31, 30, 0, 30)
    with pytest.raises(DataError, match="both kinds"):
        sensitivity("abx", 0, 0, 0, 30)


@pytest.mark.slow
@pytest.mark.parametrize("d", [0.5, 1.0, 1.5, 2.0])
@pytest.mark.parametrize("method", ["2afc", "abx", "same-different"])
def test_95_percent_intervals_hold_the_truth(method: str, d: float) -> None:
    n = 30  # trials of each kind: every outcome, weighted by how likely it is
    place = np.array(d)
    if method == "same-different":
        rates = different_rate(place, np.array(1.3)), different_rate(0.0 * place, np.array(1.3))
    else:
        right = stats.norm.cdf(place / 2**0.5) if method == "2afc" else abx_correct(place)
        rates = right, 1.0 - right
    yes, alarms = (stats.binom.pmf(np.arange(n + 1), n, float(rate)) for rate in rates)
    held = 0.0
    for hits in range(n + 1):
        for false_alarms in range(n + 1):
            found = sensitivity(method, hits, n, false_alarms, n)
            if found.low <= d <= found.high:
                held += yes[hits] * alarms[false_alarms]
    # near zero the truth has no room below: of a d' that cannot be negative, one side never errs
    assert 0.93 <= held <= (0.97 if method == "2afc" or d > 1.0 else 0.985)
