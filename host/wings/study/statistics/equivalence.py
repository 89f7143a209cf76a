"""Whether two conditions are shown to be alike: two one-sided tests against a margin.

A large p of a test for a difference shows nothing. Alike is shown when the difference is
significantly above the lower margin and significantly below the upper one (Schuirmann 1987), which
is when its 90 % interval lies within the margin.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from springpot import DataError, UsageError
from springpot.basics import Samples


@dataclass(frozen=True)
class Equivalence:
    """first minus second, its interval of 1 - 2 alpha, and the larger p of the two tests."""

    first: str
    second: str
    difference: float
    low: float
    high: float
    margin: float
    df: int
    p: float
    equivalent: bool


def equivalence(
    first: tuple[str, Samples], second: tuple[str, Samples], margin: float, alpha: float = 0.05
) -> Equivalence:
    """Test names and scores of two conditions, one score a person and in the same order."""
    if not margin > 0.0:
        raise UsageError(
            f"margin {margin:g}: give the largest difference that does not matter, > 0"
        )
    each = first[1] - second[1]
    people = len(each)
    if people < 2 or not np.all(np.isfinite(each)):
        raise DataError(
            f"{first[0]} and {second[0]}: {int(np.sum(np.isfinite(each)))} people have scored "
            "both; equivalence needs two, and no score missing"
        )
    if not np.ptp(each):
        raise DataError(f"{first[0]} and {second[0]}: everybody scores them equally far apart")
    above = stats.ttest_1samp(each, -margin, alternative="greater")
    below = stats.ttest_1samp(each, margin, alternative="less")
    low, high = map(float, stats.ttest_1samp(each, 0.0).confidence_interval(1.0 - 2.0 * alpha))
    p = float(max(above.pvalue, below.pvalue))
    return Equivalence(
        first[0], second[0], float(each.mean()), low, high, margin, people - 1, p, p < alpha
    )
