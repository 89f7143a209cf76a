"""Held-out errors of the passive model and of the forest that `auto` compares with it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from springpot.codegen.arrays import Flags, Indices, Samples, rms
from springpot.codegen.messages import log_progress
from springpot.codegen.model.features import Features
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import Folds, build_cv_schemes, geometric_mean
from springpot.trainer.models.passive.passive_fit import PassiveChoice, select_passive
from springpot.trainer.models.rf_fd import compute_depth_scale, fit_forest
from springpot.trainer.models.training_set import TrainingSet

PASSIVE, FOREST = "hammerstein", "rf-fd"
_HOPELESS_RATIO = 1.25  # times the passive error in the first family: the others are not tried
_EARLY_FOLDS, _EARLY_RATIO = 2, 2.0  # folds after which as many times the passive error is given up
_PROBE_TREES, _PROBE_RATIO = 20, 4.0  # of a first look, and where nothing more is tried
_MIN_RMSE_N = 1e-12  # an exact model's: no ratio is taken to less


@dataclass(frozen=True)
class Score:
    """Geometric mean of a model's held-out RMSEs, N.

    recordings_n: repeats apart; conditions_n: each depth, and each speed, held out whole, where
    there are three of it, else the same; mean_n: of every such way to fold alike. folds: held out;
    fewer where the first ones left no hope. ratio: to the passive model's, over those folds;
    ratio_without_best: with the candidate's best fold left out.
    """

    name: str
    recordings_n: float
    conditions_n: float
    mean_n: float
    folds: int
    ratio: float
    ratio_without_best: float


class _Fold(NamedTuple):
    """Rows of a fit that are shown, those held out of the passive model's, and its RMSE there."""

    family: int
    train: Flags
    held_out: Flags
    passive_n: float


def find_scores(
    data: TrainingSet, options: FitOptions, forest_options: FitOptions, features: Features
) -> tuple[Score, Score]:
    """Score the passive model, and a forest, with progress in the log: steps done, and all.

    forest_options, features: of the forest.
    """
    passive, rows = select_passive(data, options)[0], data.rows(options.fraction, options.seed)
    folds = _folds(passive, build_cv_schemes(data, rows, options.seed))
    families = np.array([fold.family for fold in folds])
    passive_n = np.maximum([fold.passive_n for fold in folds], _MIN_RMSE_N)
    done, errors_n = len(folds), list[float]()
    log_progress(f"1 of 2: {PASSIVE}", done, 2 * done)
    for error_n in _forest_errors_n(data, rows, passive.rows.rows, folds, features, forest_options):
        errors_n.append(error_n)
        log_progress(f"2 of 2: {FOREST}", done + len(errors_n), 2 * done)
        if _is_hopeless(np.array(errors_n) / passive_n[: len(errors_n)], families):
            break
    forest = _build_score(FOREST, np.array(errors_n), passive_n, families)
    return _build_score(PASSIVE, passive_n, passive_n, families), forest


def _folds(passive: PassiveChoice, families: Sequence[Folds]) -> list[_Fold]:
    """Folds of rows in families; one without rows on either side is none."""
    folds = []
    for (family, number), error_n in zip(
        passive.rows.held_out, passive.folds_n.tolist(), strict=True
    ):
        train = families[family].number != number
        if train.any() and not np.isnan(error_n):
            held_out = passive.rows.families[family].number == number
            folds.append(_Fold(family, train, held_out, error_n))
    return folds


def _forest_errors_n(
    data: TrainingSet, rows: Indices, tested: Indices, folds: Sequence[_Fold], features: Features,
    options: FitOptions,
) -> Iterator[float]:  # fmt: skip
    """RMSE of a forest on each fold, N, one after another.

    Few trees on the first fold come before: if they err far too much, theirs is all that is given.
    """
    scale = compute_depth_scale(data.trained.max_m - min(data.trained.min_m, 0.0))
    values, test_values = (
        (scale * data.features(features, selected)).astype(np.float32)
        for selected in (rows, tested)
    )
    measured_n, test_n = data.force_n(rows), data.force_n(tested)

    def error_n(fold: _Fold, trees: int) -> float:
        some = replace(options, trees=trees)
        forest = fit_forest(some, values[fold.train], measured_n[fold.train])
        return rms(forest.predict(test_values[fold.held_out]) - test_n[fold.held_out])

    first_n = error_n(folds[0], min(options.trees, _PROBE_TREES))
    if first_n > _PROBE_RATIO * max(folds[0].passive_n, _MIN_RMSE_N):
        yield first_n
    else:
        yield from (error_n(fold, options.trees) for fold in folds)


def _is_hopeless(ratios: Samples, families: Indices) -> bool:
    """Return True if the folds so far leave no hope of an error below the passive model's."""
    tried = len(ratios)
    mean = geometric_mean(ratios.tolist())
    first_done = tried < len(families) and families[tried - 1] == 0 < families[tried]
    return (first_done and mean > _HOPELESS_RATIO) or (
        tried == _EARLY_FOLDS and mean > _EARLY_RATIO
    )


def _build_score(name: str, errors_n: Samples, passive_n: Samples, families: Indices) -> Score:
    """Summarise the errors of a candidate by folds, and its ratio to the passive model's."""
    count = len(errors_n)
    used_families, ratios = families[:count], errors_n / passive_n[:count]
    is_condition = used_families > 0  # depths and speeds held out whole
    condition_folds = (
        is_condition if is_condition.any() else ~is_condition
    )  # where there are such folds
    not_best = np.arange(count) != np.argmin(ratios)
    return Score(
        name=name,
        recordings_n=_family_mean(errors_n[~is_condition], used_families[~is_condition]),
        conditions_n=_family_mean(errors_n[condition_folds], used_families[condition_folds]),
        mean_n=_family_mean(errors_n, used_families),
        folds=count,
        ratio=_family_mean(ratios, used_families),
        ratio_without_best=_family_mean(ratios[not_best], used_families[not_best])
        if count > 1
        else 1.0,
    )


def _family_mean(values: Samples, families: Indices) -> float:
    """Geometric mean within each family of folds, then over families.

    So families with many folds do not dominate.
    """
    means = [geometric_mean(values[families == one].tolist()) for one in np.unique(families)]
    return geometric_mean(means)
