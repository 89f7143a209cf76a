"""The same numbers as R's packages, where they are installed (Debian: r-cran-afex, -psych, ...)."""

import json
import shutil
import subprocess
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from springpot.host.wings.study.statistics.anova import repeated_measures
from springpot.host.wings.study.statistics.pairs import letters, pair_differences

AFEX = """
suppressMessages({library(afex); library(emmeans)})
x <- fromJSON(file("designs.json"))
rows <- function(d) {
  cells <- expand.grid(id = 1:d$people, b = 1:d$b, a = 1:d$a)
  cells[] <- lapply(cells, factor)
  cells$y <- d$scores
  suppressMessages(
    fit <- if (d$b == 1) aov_ez("id", "y", cells, within = "a")
           else aov_ez("id", "y", cells, within = c("a", "b")))
  s <- summary(fit)
  corrections <- s$pval.adjustments
  table <- as.data.frame(anova(fit, correction = "none", es = "ges"))
  result <- lapply(rownames(table), function(name) {
    has <- table[name, "num Df"] > 1  # two levels need no correction, and have none
    c(table[name, "num Df"], table[name, "den Df"], table[name, "F"], table[name, "Pr(>F)"],
      table[name, "ges"],
      if (has) corrections[name, c("GG eps", "Pr(>F[GG])", "HF eps", "Pr(>F[HF])")]
      else c(1, table[name, "Pr(>F)"], 1, table[name, "Pr(>F)"]))
  })
  list(effects = unname(result))
}
writeLines(toJSON(lapply(x, rows), digits = 15), "out.json")
"""
TUKEY = """
suppressMessages({library(afex); library(emmeans)})
x <- fromJSON(file("designs.json"))
pairs_of <- function(d) {
  cells <- expand.grid(id = 1:d$people, a = 1:d$a)
  cells[] <- lapply(cells, factor)
  cells$y <- d$scores
  fit <- suppressMessages(aov_ez("id", "y", cells, within = "a", include_aov = TRUE))
  common <- as.data.frame(summary(pairs(emmeans(fit, "a", model = "univariate")), adjust = "tukey"))
  own <- as.data.frame(summary(pairs(emmeans(fit, "a", model = "multivariate")),
                               adjust = "holm", infer = TRUE, level = 0.95))
  list(tukey = common$p.value, holm = own$p.value, t = own$t.ratio, d = own$estimate)
}
writeLines(toJSON(lapply(x, pairs_of), digits = 15), "out.json")
"""
LETTERS = """
suppressMessages(library(multcompView))
x <- fromJSON(file("designs.json"))
shared <- function(d) {
  told <- as.logical(d$told)
  names(told) <- d$pairs
  one <- multcompLetters(told)$Letters
  unname(one[d$names])
}
writeLines(toJSON(lapply(x, shared)), "out.json")
"""
# Debian's R has a JSON package in most set-ups only: these are enough for flat lists of numbers.
PREAMBLE = """
suppressMessages(library(jsonlite))
fromJSON <- function(x) jsonlite::fromJSON(x, simplifyDataFrame = FALSE, simplifyMatrix = FALSE)
"""


@cache
def missing(package: str) -> str:
    """Why a package of R cannot be asked, or nothing."""
    rscript = shutil.which("Rscript")
    if rscript is None:
        return "no Rscript: apt-get install r-cran-afex r-cran-psych r-cran-psyphy"
    asked = f'if (!requireNamespace("{package}", quietly = TRUE)) quit(status = 1)'
    if subprocess.run([rscript, "-e", asked], capture_output=True, check=False).returncode:
        return f"no {package} in R: apt-get install r-cran-{package.lower()}"
    return ""


def ask_r(script: str, designs: list[Any], folder: Path, *packages: str) -> list[Any]:
    for package in (*packages, "jsonlite"):
        if reason := missing(package):
            pytest.skip(reason)
    (folder / "designs.json").write_text(json.dumps(designs))
    (folder / "script.R").write_text(PREAMBLE + script)
    result = subprocess.run(
        ["Rscript", "script.R"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    answers: list[Any] = json.loads((folder / "out.json").read_text())
    return answers


def correlated(rng: np.random.Generator, people: int, conditions: int) -> np.ndarray[Any, Any]:
    mixing = rng.normal(size=(conditions, conditions))
    return rng.normal(size=(people, conditions)) @ mixing + rng.normal(size=conditions)


def test_anova_as_afex_on_50_random_designs(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    designs, found = [], []
    for i in range(50):
        # afex gives no corrections where there are fewer people than contrasts, of which up to 12
        people, a, b = int(rng.integers(14, 31)), int(rng.integers(2, 6)), int(rng.integers(2, 5))
        if i % 3 == 0:
            b = 1
        scores = correlated(rng, people, a * b).reshape(people, a, b)
        found.append(
            repeated_measures(scores[:, :, 0], ["a"])
            if b == 1
            else repeated_measures(scores, ["a", "b"])
        )
        order = scores.transpose(1, 2, 0).ravel()
        designs.append({"people": people, "a": a, "b": b, "scores": order.tolist()})
    for ours, theirs in zip(found, ask_r(AFEX, designs, tmp_path, "afex"), strict=True):
        assert len(ours) == len(theirs["effects"])
        for effect, row in zip(ours, theirs["effects"], strict=True):
            df1, df2, f, p, eta_g, eps_gg, p_gg, eps_hf, p_hf = np.ravel(row)
            assert (effect.df1, effect.df2) == (df1, df2)
            assert (effect.f, effect.p, effect.eta_g) == pytest.approx((f, p, eta_g), rel=1e-6)
            assert (effect.eps_gg, effect.p_gg) == pytest.approx((eps_gg, p_gg), rel=1e-6)
            assert (effect.eps_hf, effect.p_hf) == pytest.approx((min(eps_hf, 1.0), p_hf), rel=1e-6)


def test_pairs_as_emmeans(tmp_path: Path) -> None:
    rng = np.random.default_rng(6)
    designs, found = [], []
    for _ in range(10):
        people, a = int(rng.integers(8, 25)), int(rng.integers(3, 7))
        scores = correlated(rng, people, a)
        found.append(pair_differences(scores, [str(i) for i in range(a)]))
        designs.append({"people": people, "a": a, "scores": scores.T.ravel().tolist()})
    for ours, theirs in zip(found, ask_r(TUKEY, designs, tmp_path, "emmeans", "afex"), strict=True):
        assert [pair.t for pair in ours] == pytest.approx(theirs["t"], rel=1e-6)
        assert [pair.difference for pair in ours] == pytest.approx(theirs["d"], rel=1e-6)
        assert [pair.p_holm for pair in ours] == pytest.approx(theirs["holm"], rel=1e-6)
        assert [pair.p_tukey for pair in ours] == pytest.approx(theirs["tukey"], rel=1e-4, abs=1e-7)


def test_letters_as_multcompview(tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    names = list("pqrstu")
    pairs = list(combinations(names, 2))
    tables = [rng.random(len(pairs)) < share for share in (0.1, 0.3, 0.5, 0.7) for _ in range(5)]
    designs = [
        {"names": names, "pairs": ["-".join(pair) for pair in pairs], "told": told.tolist()}
        for told in tables
    ]
    answers = ask_r(LETTERS, designs, tmp_path, "multcompView")
    for told, theirs in zip(tables, answers, strict=True):
        ours = letters(names, [pair for pair, use in zip(pairs, told, strict=True) if use])
        groups = [
            {
                frozenset(n for n, s in table.items() if letter in s)
                for letter in set("".join(table.values()))
            }
            for table in (ours, dict(zip(names, theirs, strict=True)))
        ]
        assert groups[0] == groups[1]
