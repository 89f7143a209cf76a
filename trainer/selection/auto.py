"""Kind `auto`: the fit of lowest cross-validated error; the validation data is never seen."""

import logging
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

from springpot.trainer.kinds import fit_kind
from springpot.trainer.models.fit import Fit, FitOptions
from springpot.trainer.models.folds import N_FOLDS, geometric_mean
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.selection.cross_validation import (
    fold_errors_n,
    recording_splits,
    whole_splits,
)

_LOG = logging.getLogger(__name__)
_ERROR_TOLERANCE = 1.005  # of the lowest error: the cheaper of two within it is taken
FORCE_TOLERANCE = 5e-4  # of the maximum force: below what a sensor or a hand resolves
_ROWS = 6_000  # of each fit under cross-validation


@dataclass(frozen=True)
class AutoCandidate:
    """One fit that a user could ask for; cost: rank of its time in C, the lower the cheaper."""

    name: str
    cost: int
    kind: str
    options: FitOptions


@dataclass(frozen=True)
class Score:
    """Geometric mean of a candidate's held-out RMSEs, N.

    recordings_n: repeats apart; conditions_n: each depth, and each speed, held out whole, where
    there are three of it, else the same; mean_n: of every such way to fold alike.
    """

    name: str
    cost: int
    recordings_n: float
    conditions_n: float
    mean_n: float


def fit_auto(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Fit the best candidate on all training recordings; the table of scores is in its metadata."""
    begin = time.perf_counter()
    families = [recording_splits(data.recordings, 0.0, options.seed, N_FOLDS)]
    families += whole_splits(data)
    known = candidates(data, options)
    scores = []
    for count, candidate in enumerate(known, 1):
        _LOG.info("%d of %d: %s", count, len(known), candidate.name)
        means = [
            geometric_mean(fold_errors_n(candidate.kind, splits, candidate.options, _ROWS))
            for splits in families
        ]
        whole_n = geometric_mean(means[1:] or means)
        scores.append(
            Score(candidate.name, candidate.cost, means[0], whole_n, geometric_mean(means))
        )
    best = choose_score(scores, max(abs(data.trained.max_n), abs(data.trained.min_n)))
    search_s = time.perf_counter() - begin
    chosen = next(candidate for candidate in known if candidate.name == best.name)
    fit = fit_kind(chosen.kind, name, data, chosen.options)
    metadata = {**fit.metadata, "chosen": best.name, "scores": [vars(score) for score in scores]}
    return replace(fit, search_s=search_s, metadata=metadata)


def choose_score(scores: list[Score], peak_n: float) -> Score:
    """The cheapest of those within half a per cent of the lowest error, or within what is felt."""
    minimum = min(score.mean_n for score in scores)
    most = max(_ERROR_TOLERANCE * minimum, minimum + FORCE_TOLERANCE * peak_n)
    near = [score for score in scores if score.mean_n <= most]
    return min(near, key=lambda score: (score.cost, score.mean_n))


def candidates(data: TrainingSet, options: FitOptions) -> list[AutoCandidate]:
    """The passive model, hybrids on both kinds of features, and the paper's models."""
    long = replace(options, engine="recursive", window_s=data.longest_s)
    return [
        AutoCandidate("hammerstein", 1, "hammerstein", options),
        AutoCandidate("hybrid lags", 4, "hybrid", options),
        AutoCandidate("hybrid derivatives", 4, "hybrid", long),
        AutoCandidate("rf-fd", 5, "rf-fd", options),
        AutoCandidate("rf-fd long", 6, "rf-fd", long),
        AutoCandidate("boosted", 3, "boosted", options),
        AutoCandidate("rbf-fd", 2, "rbf-fd", options),
    ]
