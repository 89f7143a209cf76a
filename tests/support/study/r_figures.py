"""What R's packages say of the designs below: stored in tests/data/r_figures.json.

`cd tests && python -m support.study.r_figures` makes that file anew; it needs R with afex, emmeans,
multcompView and jsonlite (Debian: r-cran-NAME).
"""

import hashlib
import json
import shutil
import subprocess
import tempfile
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from support.paths import TESTS

FILE = TESTS / "data" / "r_figures.json"
PACKAGES = ("afex", "emmeans", "multcompView", "jsonlite")
PREAMBLE = """
suppressMessages(library(jsonlite))
fromJSON <- function(x) jsonlite::fromJSON(x, simplifyDataFrame = FALSE, simplifyMatrix = FALSE)
"""
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
SCRIPTS = {"anova": AFEX, "pairs": TUKEY, "letters": LETTERS}


def anova_designs() -> list[dict[str, Any]]:
    """50 designs of one or two factors within people; scores[a][b][person], flat."""
    rng = np.random.default_rng(5)
    designs = []
    for i in range(50):
        # afex gives no corrections if there are fewer people than contrasts, of which up to 12
        people, a, b = int(rng.integers(14, 31)), int(rng.integers(2, 6)), int(rng.integers(2, 5))
        b = 1 if i % 3 == 0 else b
        scores = _correlated(rng, people, a * b).reshape(people, a, b).transpose(1, 2, 0)
        designs.append({"people": people, "a": a, "b": b, "scores": scores.ravel().tolist()})
    return designs


def pair_designs() -> list[dict[str, Any]]:
    """Ten designs of one factor; scores[a][person], flat."""
    rng = np.random.default_rng(6)
    designs = []
    for _ in range(10):
        people, a = int(rng.integers(8, 25)), int(rng.integers(3, 7))
        scores = _correlated(rng, people, a)
        designs.append({"people": people, "a": a, "scores": scores.T.ravel().tolist()})
    return designs


def letter_designs() -> list[dict[str, Any]]:
    """Twenty tables of which pairs of six conditions differ."""
    rng = np.random.default_rng(7)
    names = list("pqrstu")
    pairs = ["-".join(pair) for pair in combinations(names, 2)]
    tables = [rng.random(len(pairs)) < share for share in (0.1, 0.3, 0.5, 0.7) for _ in range(5)]
    return [{"names": names, "pairs": pairs, "told": told.tolist()} for told in tables]


DESIGNS = {"anova": anova_designs, "pairs": pair_designs, "letters": letter_designs}


def stored(what: str) -> tuple[list[dict[str, Any]], list[Any]]:
    """Return the designs, and what R said of each.

    Raises AssertionError if the designs are not those that R was asked.
    """
    designs, found = DESIGNS[what](), json.loads(FILE.read_text())[what]
    assert digest(designs) == found["designs"], f"other designs: make {FILE.name} anew"
    return designs, found["answers"]


def digest(designs: list[dict[str, Any]]) -> str:
    """Name the designs by a hash of their text."""
    return hashlib.sha256(json.dumps(designs).encode()).hexdigest()


def missing_r() -> str:
    """Return what of R is not installed here, or an empty text."""
    rscript = shutil.which("Rscript")
    if rscript is None:
        return "no Rscript: apt-get install r-cran-afex r-cran-emmeans r-cran-multcompview"
    asked = f"stopifnot({', '.join(f'requireNamespace({name!r})' for name in PACKAGES)})"
    failed = subprocess.run([rscript, "-e", asked], capture_output=True, check=False).returncode
    return "R lacks one of " + ", ".join(PACKAGES) if failed else ""


def ask_r(what: str) -> list[Any]:
    """Ask R itself. Raises CalledProcessError if it fails."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "designs.json").write_text(json.dumps(DESIGNS[what]()))
        (folder / "script.R").write_text(PREAMBLE + SCRIPTS[what])
        subprocess.run(["Rscript", "script.R"], cwd=folder, check=True, capture_output=True)
        answers: list[Any] = json.loads((folder / "out.json").read_text())
    return answers


def _correlated(rng: np.random.Generator, people: int, conditions: int) -> np.ndarray[Any, Any]:
    mixing = rng.normal(size=(conditions, conditions))
    scores = rng.normal(size=(people, conditions)) @ mixing + rng.normal(size=conditions)
    return np.round(scores, 6)  # the same text whatever the last bits of a product


if __name__ == "__main__":
    made = {what: {"designs": digest(DESIGNS[what]()), "answers": ask_r(what)} for what in SCRIPTS}
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_text(json.dumps(made, separators=(",", ":")) + "\n")
