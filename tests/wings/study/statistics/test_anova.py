"""Repeated-measures analysis of variance against published tables of other programs."""

import numpy as np
import pytest

from springpot.codegen.errors import DataError, UsageError
from springpot.host.wings.study.statistics.anova import Effect, repeated_measures

# statsmodels, stats/tests/test_anova_rm.py, its first 48 numbers: (A, B, people)
EZ = [7, 3, 6, 6, 5, 8, 6, 7, 7, 11, 9, 11, 10, 10, 11, 11, 8, 14, 10, 11, 12, 10, 11, 12,
      16, 7, 11, 9, 10, 11, 8, 8, 16, 10, 13, 10, 10, 14, 11, 12, 24, 29, 10, 22, 25, 28, 22, 24,
      ]  # fmt: skip
# pingouin, datasets/rm_anova2.csv: (Time, Metric, people)
JAMOVI = [13, 12, 17, 12, 19, 6, 17, 18, 23, 18, 12, 19, 19, 25, 27, 12, 18, 29, 30, 12,
          17, 18, 24, 25, 19, 6, 30, 36, 24, 24, 18, 6, 21, 18, 18, 6, 24, 22, 18, 24,
          30, 18, 31, 39, 28, 18, 36, 36, 38, 25, 34, 30, 32, 40, 27, 23, 38, 40, 32, 34,
          ]  # fmt: skip
# R, datasets::ToothGrowth, its 60 lengths: (supp, dose, people as rstatix counts)
TEETH = [
    4.2, 11.5, 7.3, 5.8, 6.4, 10, 11.2, 11.2, 5.2, 7, 16.5, 16.5, 15.2, 17.3, 22.5, 17.3,
    13.6, 14.5, 18.8, 15.5, 23.6, 18.5, 33.9, 25.5, 26.4, 32.5, 26.7, 21.5, 23.3, 29.5,
    15.2, 21.5, 17.6, 9.7, 14.5, 10, 8.2, 9.4, 16.5, 9.7, 19.7, 23.3, 23.6, 26.4, 20,
    25.2, 25.8, 21.2, 14.5, 27.3, 25.5, 26.4, 22.4, 24.5, 24.8, 30.9, 26.4, 27.3, 29.4, 23
]  # fmt: skip


def table(values: list[float] | list[int], *levels: int) -> tuple[Effect, ...]:
    scores = np.moveaxis(np.array(values, dtype=float).reshape(*levels, -1), -1, 0)
    return repeated_measures(scores, ["A", "B"][: len(levels)])


def values_of(effects: tuple[Effect, ...], key: str) -> list[float]:
    return [getattr(effect, key) for effect in effects]


def test_one_factor_as_ezanova() -> None:
    (effect,) = table(EZ[:16], 2)
    assert (effect.effect, effect.df1, effect.df2) == ("A", 1, 7)
    assert effect.f == pytest.approx(22.4, rel=1e-5)
    assert effect.p == effect.p_gg == effect.p_hf == pytest.approx(0.002125452, rel=1e-5)


def test_two_factors_as_ezanova() -> None:
    effects = table(EZ, 2, 3)
    assert values_of(effects, "effect") == ["A", "B", "A:B"]
    assert values_of(effects, "df1") == [1, 2, 2]
    assert values_of(effects, "df2") == [7, 14, 14]
    assert values_of(effects, "f") == pytest.approx([40.14159, 29.21739, 17.10545], rel=1e-6)
    expected = [3.905263e-04, 1.007549e-05, 1.741322e-04]
    assert values_of(effects, "p") == pytest.approx(expected, rel=1e-6)


def test_two_factors_as_jamovi() -> None:
    effects = table(JAMOVI, 2, 3)
    assert values_of(effects, "f") == pytest.approx([33.85228, 26.95919, 12.63227], rel=1e-6)
    assert values_of(effects, "eps_gg") == pytest.approx([1.0, 0.96910, 0.72717], abs=5e-6)
    assert effects[2].eps_hf == pytest.approx(0.831161, abs=5e-7)  # ez


def test_teeth_as_rstatix() -> None:
    effects = table(TEETH, 2, 3)
    assert values_of(effects, "f") == pytest.approx([34.866, 106.470, 2.534], abs=5e-4)
    assert [(effect.df1, effect.df2) for effect in effects] == [(1, 9), (2, 18), (2, 18)]
    assert values_of(effects, "p") == pytest.approx([2.28e-4, 1.06e-10, 1.07e-1], rel=5e-3)
    assert values_of(effects, "eps_gg") == pytest.approx([1.0, 0.838, 0.938], abs=5e-4)
    assert values_of(effects, "eta_g") == pytest.approx([0.224, 0.773, 0.132], abs=5e-4)
    assert values_of(effects, "eps_hf") == [1.0, 1.0, 1.0]  # 1.008 and 1.176 are no shrinking


def test_epsilon_of_three_by_four_as_ez_and_afex() -> None:
    # pingouin, tests/test_distribution.py: normal numbers of the seed 123, 50 people
    numbers = np.random.RandomState(123).normal(scale=3, size=600)
    effects = repeated_measures(numbers.reshape(3, 4, 50).transpose(2, 0, 1), ["w1", "w2"])
    expected = [0.9963275, 0.9716288, 0.8562148]
    assert values_of(effects, "eps_gg") == pytest.approx(expected, abs=5e-8)
    assert effects[2].eps_hf == pytest.approx(0.9684172, abs=5e-8)


def test_degrees_of_freedom_are_counted_from_the_data() -> None:
    scores = np.random.default_rng(1).normal(size=(15, 4, 5))
    assert [(effect.df1, effect.df2) for effect in repeated_measures(scores, ["a", "b"])] == [
        (3, 42),
        (4, 56),
        (12, 168),
    ]


def test_order_of_levels_and_people_does_not_matter() -> None:
    rng = np.random.default_rng(2)
    scores = rng.normal(size=(9, 3, 4))
    plain = repeated_measures(scores, ["a", "b"])
    mixed = scores[rng.permutation(9)][:, rng.permutation(3)][:, :, rng.permutation(4)]
    for one, other in zip(plain, repeated_measures(mixed, ["a", "b"]), strict=True):
        assert one.f == pytest.approx(other.f)
        assert one.eps_gg == pytest.approx(other.eps_gg)


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
