"""Pairs of conditions, and the letters over a box plot."""

from itertools import combinations, product

import numpy as np
import pytest
from scipy import stats

from springpot.codegen.errors import DataError
from springpot.host.wings.study.statistics.pairs import holm, letters, pair_differences


def test_pairs_come_in_the_columns_order_with_holm_s_p() -> None:
    scores = np.random.default_rng(1).normal(size=(12, 3)).cumsum(axis=1)
    pairs = pair_differences(scores, ["x", "y", "z"])
    assert [(pair.first, pair.second) for pair in pairs] == [("x", "y"), ("x", "z"), ("y", "z")]
    for pair, (i, j) in zip(pairs, combinations(range(3), 2), strict=True):
        assert pair.p == pytest.approx(stats.ttest_rel(scores[:, i], scores[:, j]).pvalue)
        assert pair.d_z == pytest.approx(pair.t / 12**0.5)
    assert [pair.p_holm for pair in pairs] == pytest.approx(holm([pair.p for pair in pairs]))


def test_letters_are_shared_exactly_by_what_is_not_told_apart() -> None:
    names = ["p", "q", "r", "s"]
    pairs = list(combinations(names, 2))
    for told in product(
        [False, True], repeat=len(pairs)
    ):  # every possible outcome of four conditions
        different = [pair for pair, use in zip(pairs, told, strict=True) if use]
        found = letters(names, different)
        for one, other in pairs:
            assert bool(set(found[one]) & set(found[other])) == ((one, other) not in different)
        assert found["p"].startswith("a")


def test_no_scatter_is_refused() -> None:
    with pytest.raises(DataError, match="equally far apart"):
        pair_differences(np.add.outer(np.arange(4.0), np.array([0.1, 0.7])), ["x", "y"])
