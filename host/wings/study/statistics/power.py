"""How often a study of so many people finds what is there.

Differences are in units of the standard deviation of the paired differences, d_z. Nothing here is
simulated: the noncentral t distribution answers for the t test, and one integral over the deviation
that a study may happen to see answers for the test of equivalence.
"""

from bisect import bisect_left
from collections.abc import Callable

import numpy as np
from scipy import optimize, stats

from springpot import UsageError

_MAX_PEOPLE = 100_000


def difference_power(people: int, d_z: float, alpha: float = 0.05) -> float:
    """Return share of studies whose two-sided paired t test finds a true difference."""
    df, shift = people - 1, abs(d_z) * people**0.5
    edge = float(stats.t.ppf(1.0 - alpha / 2, df))
    found = stats.nct.sf(edge, df, shift)
    other_way = stats.nct.cdf(-edge, df, shift)  # nan where it is far below what a float holds
    return float(found + np.nan_to_num(other_way))


def equivalence_power(people: int, margin_z: float, d_z: float = 0.0, alpha: float = 0.05) -> float:
    """Return the share of studies that show equivalence within a margin, the truth being d_z."""
    df = people - 1
    edge = float(stats.t.ppf(1.0 - alpha, df))
    shares, weights = np.polynomial.legendre.leggauss(200)
    deviation = np.sqrt(stats.chi2.ppf((shares + 1.0) / 2, df) / df)  # seen over true
    room = np.maximum(margin_z - edge * deviation / people**0.5, 0.0)
    z = np.array([(room - d_z), (-room - d_z)]) * people**0.5
    within = stats.norm.cdf(z[0]) - stats.norm.cdf(z[1])
    return float(weights @ within / 2)


def people_needed(power: Callable[[int], float], target: float = 0.8) -> int:
    """Return the fewest people whose power reaches a target: of a function that grows with them."""
    if not 0.0 < target < 1.0:
        raise UsageError(f"power {target:g}: give a share between 0 and 1, as 0.8")
    people = bisect_left(range(_MAX_PEOPLE + 1), target, lo=2, key=power)
    if people > _MAX_PEOPLE:
        raise UsageError(
            f"more than {_MAX_PEOPLE} people for a power of {target:g}: the difference to find "
            "is too small, or the margin"
        )
    return people


def detectable(people: int, target: float = 0.8, alpha: float = 0.05) -> float:
    """Return the smallest d_z that a share of studies of so many people finds."""

    def beyond(d_z: float) -> float:
        return difference_power(people, d_z, alpha) - target

    return float(optimize.brentq(beyond, 0.0, 64.0))
