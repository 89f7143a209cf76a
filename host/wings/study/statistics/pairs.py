"""All pairs of conditions of one person-by-condition table: differences, tests, letters.

Two ways of not being fooled by many comparisons stand side by side: Holm's on the p of each pair's
own t test, which needs no equal variances, and Tukey's on the error that all conditions share.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

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
    """Every pair of columns of scores (people, conditions), in the columns' order."""
    require_complete(scores)
    people, k = scores.shape
    df = people - 1
    error_df = df * (k - 1)
    z = scores @ contrasts(k)
    error = float(np.sum((z - z.mean(axis=0)) ** 2)) / error_df
    quantile = float(stats.t.ppf(0.5 + _CONFIDENCE / 2, df))
    places = list(combinations(range(k), 2))
    rows = []
    for i, j in places:
        each = scores[:, i] - scores[:, j]
        mean, deviation = float(each.mean()), float(each.std(ddof=1))
        if deviation <= _ROUNDING * float(np.abs(scores).max()):
            raise DataError(
                f"{conditions[i]} and {conditions[j]}: everybody scores them equally far apart, "
                "so that there is no scatter to test against"
            )
        half = quantile * deviation / people**0.5
        t = mean / deviation * people**0.5
        q = abs(mean) / (error / people) ** 0.5
        tukey = max(0.0, float(stats.studentized_range.sf(q, k, error_df))) if k > 2 else None
        rows.append((mean, mean - half, mean + half, t, tukey, mean / deviation))
    p_values = [float(2.0 * stats.t.sf(abs(row[3]), df)) for row in rows]
    return tuple(
        PairDifference(
            conditions[i], conditions[j], mean, low, high, t, df, p, p_holm,
            p if tukey is None else tukey, d_z,
        )
        for (i, j), (mean, low, high, t, tukey, d_z), p, p_holm in zip(
            places, rows, p_values, holm(p_values), strict=True
        )
    )  # fmt: skip


def simple_effects(
    scores: Samples, conditions: Sequence[str], levels: Sequence[str]
) -> dict[str, tuple[PairDifference, ...]]:
    """Pairs of conditions within each level of the second factor: scores (people, a, b)."""
    return {
        level: pair_differences(scores[:, :, place], conditions)
        for place, level in enumerate(levels)
    }


def holm(p_values: Sequence[float]) -> list[float]:
    """Holm's adjusted p of each (1979)."""
    order = np.argsort(p_values)
    steps = np.arange(len(p_values), 0, -1) * np.asarray(p_values)[order]
    adjusted = np.empty(len(p_values))
    adjusted[order] = np.minimum(1.0, np.maximum.accumulate(steps))
    return [float(p) for p in adjusted]


def letters(conditions: Sequence[str], different: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Conditions that share a letter are not shown to differ; the first condition has an `a`.

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
