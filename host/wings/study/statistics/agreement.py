"""How far sessions agree: intraclass correlations with their intervals.

Shrout and Fleiss (1979): each target (a condition of a person) is scored once in each of k
sessions. icc_2_1 counts a shift of a whole session as disagreement, icc_3_1 does not, icc_3_k is
icc_3_1 of the average over the sessions. Intervals as in McGraw and Wong (1996); that of icc_2_1
holds the truth in less than 93 % of studies where three sessions are shifted by more than a score's
noise.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from springpot import DataError
from springpot.basics import Samples


@dataclass(frozen=True)
class Agreement:
    """One coefficient: its name, value and 95 % interval."""

    name: str
    value: float
    low: float
    high: float


def intraclass(scores: Samples, alpha: float = 0.05) -> tuple[Agreement, Agreement, Agreement]:
    """Return ICC(2,1), ICC(3,1) and ICC(3,k) of scores (targets, sessions)."""
    n, k = scores.shape
    if n < 3 or k < 2 or not np.all(np.isfinite(scores)):
        raise DataError(
            f"{n} targets in {k} sessions: agreement needs three targets scored in two sessions, "
            "and no score missing"
        )
    mean = scores.mean()
    rows = k * float(np.sum((scores.mean(axis=1) - mean) ** 2)) / (n - 1)
    columns = n * float(np.sum((scores.mean(axis=0) - mean) ** 2)) / (k - 1)
    left = scores - scores.mean(axis=1, keepdims=True) - scores.mean(axis=0) + mean
    df_error = (n - 1) * (k - 1)
    error = float(np.sum(left**2)) / df_error
    if rows <= 0.0 or error <= 0.0:
        raise DataError("no target differs from another, or no session: agreement has no meaning")
    f = rows / error
    f_low = f / float(stats.f.ppf(1.0 - alpha / 2, n - 1, df_error))
    f_high = f * float(stats.f.ppf(1.0 - alpha / 2, df_error, n - 1))
    return (
        _absolute(n, k, rows, columns, error, alpha),
        Agreement("icc_3_1", *((x - 1.0) / (x + k - 1.0) for x in (f, f_low, f_high))),
        Agreement("icc_3_k", *(1.0 - 1.0 / x for x in (f, f_low, f_high))),
    )


def _absolute(n: int, k: int, rows: float, columns: float, error: float, alpha: float) -> Agreement:
    value = (rows - error) / (rows + (k - 1) * error + k * (columns - error) / n)
    # Satterthwaite's degrees of freedom of what is not the targets' own variance
    ratio = columns / error
    numerator = k * value * ratio + n * (1.0 + (k - 1) * value) - k * value
    denominator = (n - 1) * (k * value * ratio) ** 2 + (
        n * (1.0 + (k - 1) * value) - k * value
    ) ** 2
    df = (n - 1) * (k - 1) * numerator**2 / denominator
    upper = float(stats.f.ppf(1.0 - alpha / 2, n - 1, df))
    lower = float(stats.f.ppf(1.0 - alpha / 2, df, n - 1))
    rest = k * columns + (k * n - k - n) * error
    low = n * (rows - upper * error) / (upper * rest + n * rows)
    high = n * (lower * rows - error) / (rest + n * lower * rows)
    return Agreement("icc_2_1", value, low, high)
