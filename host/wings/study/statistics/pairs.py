"""All pairs of conditions of one person-by-condition table: differences, tests, letters.

Two ways of not being fooled by many comparisons stand side by side: Holm's on the p of each pair's
own t test, which needs no equal variances, and Tukey's on the error that all conditions share.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from scipy import stats

from springpot import DataError
from springpot.basics import Samples
from springpot.host.wings.study.statistics.anova import contrasts, require_complete

_CONFIDENCE = 0.95
_ROUNDING = 1e-12  # of the largest score


@dataclass(frozen=True)
class PairDifference:
    """first minus second, its 95 % interval, and its tests; d_z: difference over its deviation."""

    first: str
    second: str
    difference: float
    low: float
    high: float
    t: float
    df: int
    p: float
    p_holm: float
    p_tukey: float
    d_z: float


def pair_differences(scores: Samples, conditions: Sequence[str]) -> tuple[PairDifference, ...]:
    """Compare every pair of columns of scores (people, conditions), in the columns' order."""
    require_complete(scores)
    people, k = scores.shape
    error_df = (people - 1) * (k - 1)
    z = scores @ contrasts(k)
    error = float(np.sum((z - z.mean(axis=0)) ** 2)) / error_df
    rows: list[dict[str, Any]] = []
    for i, j in combinations(range(k), 2):
        each = scores[:, i] - scores[:, j]
        mean, deviation = float(each.mean()), float(each.std(ddof=1))
        if deviation <= _ROUNDING * float(np.abs(scores).max()):
            raise DataError(
                f"{conditions[i]} and {conditions[j]}: everybody scores them equally far apart, "
                "so that there is no scatter to test against"
            )
        test = stats.ttest_1samp(each, 0.0)
        low, high = map(float, test.confidence_interval(_CONFIDENCE))
        p = p_tukey = float(test.pvalue)
        if k > 2:
            q = abs(mean) / (error / people) ** 0.5
            p_tukey = max(0.0, float(stats.studentized_range.sf(q, k, error_df)))
        rows.append({
            "first": conditions[i], "second": conditions[j], "difference": mean, "low": low,
            "high": high, "t": float(test.statistic), "df": people - 1, "p": p,
            "p_tukey": p_tukey, "d_z": mean / deviation,
        })  # fmt: skip
    adjusted = holm([row["p"] for row in rows])
    return tuple(
        PairDifference(**row, p_holm=p_holm) for row, p_holm in zip(rows, adjusted, strict=True)
    )


def holm(p_values: Sequence[float]) -> list[float]:
    """Adjust p values as Holm does (1979)."""
    order = np.argsort(p_values)
    steps = np.arange(len(p_values), 0, -1) * np.asarray(p_values)[order]
    adjusted = np.empty(len(p_values))
    adjusted[order] = np.minimum(1.0, np.maximum.accumulate(steps))
    return [float(p) for p in adjusted]


def letters(conditions: Sequence[str], different: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Letter conditions: those that share one are not shown to differ; the first has an `a`.

    Piepho's insertion and absorption (2004): every group that holds a pair that differs is split in
    two, one without each of them, and a group within another is dropped."""
    groups = [frozenset(conditions)]
    for pair in different:
        split = [
            part
            for group in groups
            for part in ([group - {one} for one in pair] if group.issuperset(pair) else [group])
        ]
        unique = list(dict.fromkeys(split))
        groups = [group for group in unique if not any(group < other for other in unique)]
    place = {condition: i for i, condition in enumerate(conditions)}
    groups.sort(key=lambda group: sorted(place[c] for c in group))
    return {
        condition: "".join(_letter(i) for i, group in enumerate(groups) if condition in group)
        for condition in conditions
    }


def _letter(i: int) -> str:
    return chr(ord("a") + i) if i < 26 else f"({i + 1})"
