"""The same numbers as R's packages: stored ones always, R itself if it is installed."""

import numpy as np
import pytest
from support.study.r_figures import SCRIPTS, ask_r, missing_r, stored

from springpot.host.wings.study.statistics.anova import repeated_measures
from springpot.host.wings.study.statistics.pairs import letters, pair_differences


@pytest.mark.slow
@pytest.mark.parametrize("what", SCRIPTS)
def test_stored_figures_are_what_r_says(what: str) -> None:
    if reason := missing_r():
        pytest.skip(reason)
    now, before = ask_r(what), stored(what)[1]
    if what == "letters":
        assert now == before
        return
    for ours, theirs in zip(now, before, strict=True):
        assert list(ours) == list(theirs)
        for key in ours:
            np.testing.assert_allclose(
                np.ravel(ours[key]), np.ravel(theirs[key]), rtol=1e-9, atol=1e-12
            )


def test_anova_as_afex_on_50_random_designs() -> None:
    for design, theirs in zip(*stored("anova"), strict=True):
        shape = design["a"], design["b"], design["people"]
        scores = np.reshape(design["scores"], shape).transpose(2, 0, 1)
        ours = (
            repeated_measures(scores[:, :, 0], ["a"])
            if design["b"] == 1
            else repeated_measures(scores, ["a", "b"])
        )
        assert len(ours) == len(theirs["effects"])
        for effect, row in zip(ours, theirs["effects"], strict=True):
            df1, df2, f, p, eta_g, eps_gg, p_gg, eps_hf, p_hf = np.ravel(row)
            assert (effect.df1, effect.df2) == (df1, df2)
            assert (effect.f, effect.p, effect.eta_g) == pytest.approx((f, p, eta_g), rel=1e-6)
            assert (effect.eps_gg, effect.p_gg) == pytest.approx((eps_gg, p_gg), rel=1e-6)
            assert (effect.eps_hf, effect.p_hf) == pytest.approx((min(eps_hf, 1.0), p_hf), rel=1e-6)


def test_pairs_as_emmeans() -> None:
    for design, theirs in zip(*stored("pairs"), strict=True):
        scores = np.reshape(design["scores"], (design["a"], design["people"])).T
        ours = pair_differences(scores, [str(i) for i in range(design["a"])])
        assert [pair.t for pair in ours] == pytest.approx(theirs["t"], rel=1e-6)
        assert [pair.difference for pair in ours] == pytest.approx(theirs["d"], rel=1e-6)
        assert [pair.p_holm for pair in ours] == pytest.approx(theirs["holm"], rel=1e-6)
        assert [pair.p_tukey for pair in ours] == pytest.approx(theirs["tukey"], rel=1e-4, abs=1e-7)


def test_letters_as_multcompview() -> None:
    for design, theirs in zip(*stored("letters"), strict=True):
        names, pairs = design["names"], [tuple(pair.split("-")) for pair in design["pairs"]]
        ours = letters(
            names, [pair for pair, use in zip(pairs, design["told"], strict=True) if use]
        )
        groups = [
            {
                frozenset(n for n, s in table.items() if letter in s)
                for letter in set("".join(table.values()))
            }
            for table in (ours, dict(zip(names, theirs, strict=True)))
        ]
        assert groups[0] == groups[1]
