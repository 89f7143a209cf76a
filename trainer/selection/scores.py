"""Held-out errors of the kinds that `auto` compares: every one beside the passive model's."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Indices, Samples, rms
from springpot.codegen.messages import at_step
from springpot.codegen.model.features import Features
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import geometric_mean
from springpot.trainer.selection.cross_validation import FoldedRows

PASSIVE = "hammerstein"
_HOPELESS = 1.25  # times the passive error in the first family: the others are not tried
_EARLY, _FAR = 2, 2.0  # folds after which as many times the passive error is given up
_NO_ERROR_N = 1e-12  # an exact model's: no ratio is taken to less


@dataclass(frozen=True, eq=False)
class AutoCandidate:
    """One fit that a user could ask for; cost: rank of its time in C, the lower the cheaper.

    features: of its trees; None for the passive model alone.
    """

    name: str
    cost: int
    kind: str
    options: FitOptions
    features: Features | None


@dataclass(frozen=True)
class Score:
    """Geometric mean of a candidate's held-out RMSEs, N.

    recordings_n: repeats apart; conditions_n: each depth, and each speed, held out whole, where
    there are three of it, else the same; mean_n: of every such way to fold alike. folds: held out;
    fewer where the first ones left no hope. ratio: to the passive model's, over those folds;
    ratio_without_best: with the candidate's best fold left out.
    """

    name: str
    cost: int
    recordings_n: float
    conditions_n: float
    mean_n: float
    folds: int
    ratio: float
    ratio_without_best: float


def find_scores(known: Sequence[AutoCandidate], rows: FoldedRows) -> list[Score]:
    """Every candidate's, with progress in the log: steps done, and all steps."""
    families = np.array([fold.family for fold in rows.folds])
    total = len(known) * len(families)
    passive_n = np.array([rms(fold.left_n[fold.held]) for fold in rows.folds])
    passive_n = np.maximum(passive_n, _NO_ERROR_N)
    scores = []
    for number, candidate in enumerate(known):
        text = f"{number + 1} of {len(known)}: {candidate.name}"
        errors_n: list[float] = []
        at_step(text, number * len(families), total)
        trees = candidate.features
        tried_n = passive_n if trees is None else rows.tree_errors_n(trees, candidate.options)
        for error_n in tried_n:
            errors_n.append(float(error_n))
            tried = len(errors_n)
            at_step(text, number * len(families) + tried, total)
            if _hopeless(np.array(errors_n) / passive_n[:tried], families):
                break
        scores.append(_score(candidate, np.array(errors_n), passive_n, families))
    return scores


def _hopeless(ratios: Samples, families: Indices) -> bool:
    """Whether the folds so far leave no hope of an error below the passive one."""
    tried = len(ratios)
    mean = geometric_mean(ratios.tolist())
    first_done = tried < len(families) and families[tried - 1] == 0 < families[tried]
    return (first_done and mean > _HOPELESS) or (tried == _EARLY and mean > _FAR)


def _score(
    candidate: AutoCandidate, errors_n: Samples, passive_n: Samples, families: Indices
) -> Score:
    count = len(errors_n)
    its, ratios = families[:count], errors_n / passive_n[:count]
    whole = its > 0  # depths and speeds held out whole
    some = whole if whole.any() else ~whole  # where there are such folds
    without = np.arange(count) != np.argmin(ratios)
    return Score(
        name=candidate.name,
        cost=candidate.cost,
        recordings_n=_mean(errors_n[~whole], its[~whole]),
        conditions_n=_mean(errors_n[some], its[some]),
        mean_n=_mean(errors_n, its),
        folds=count,
        ratio=_mean(ratios, its),
        ratio_without_best=_mean(ratios[without], its[without]) if count > 1 else 1.0,
    )


def _mean(values: Samples, families: Indices) -> float:
    """Geometric mean within each family of folds, then over families.

    So families with many folds do not dominate.
    """
    means = [geometric_mean(values[families == one].tolist()) for one in np.unique(families)]
    return geometric_mean(means)
