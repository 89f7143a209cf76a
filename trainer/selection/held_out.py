"""Errors on folds that a fit has not seen, on one choice of rows: how `auto` compares its kinds.

Features, passive terms and rows are made once for all folds: what a fold leaves out is rows.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.model.features import Features
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import Folds, fold_families
from springpot.trainer.models.forests import depth_scale, fitted_forest
from springpot.trainer.models.passive.passive_fit import PassiveChoice, passive_choice, term_columns
from springpot.trainer.models.training_set import TrainingSet

_TEST_ROWS = 12_000


@dataclass(frozen=True, eq=False)
class TreeFit:
    """A forest of the automatic list; adds: on what the passive part leaves over."""

    features: Features
    trees: int
    leaf: int
    adds: bool


@dataclass(frozen=True, eq=False)
class HeldOut:
    """The rows of a fit, `fitted`, and those that folds are judged on, `tested`."""

    data: TrainingSet
    options: FitOptions
    fitted: Indices
    tested: Indices

    @cached_property
    def families(self) -> list[tuple[Folds, Folds]]:
        """Each family's folds of `fitted` and of `tested`."""
        seed = self.options.seed
        of_rows = (fold_families(self.data, rows, seed) for rows in (self.fitted, self.tested))
        return list(zip(*of_rows, strict=True))

    @cached_property
    def folds(self) -> list[tuple[int, int]]:
        """Family and number of every fold that has rows on both sides."""
        return [
            (family, fold)
            for family, (of_fitted, of_tested) in enumerate(self.families)
            for fold in of_fitted.tested
            if (of_tested.number == fold).any() and (of_fitted.number != fold).any()
        ]

    @cached_property
    def _passive(self) -> PassiveChoice:
        return passive_choice(self.data, self.options)[0]

    @cached_property
    def _terms(self) -> list[Samples]:
        """Values of the passive terms at both sorts of rows."""
        terms = self._passive.terms
        return [term_columns(terms, self.data, rows) for rows in (self.fitted, self.tested)]

    @cached_property
    def _left_over(self) -> list[tuple[Samples, Samples]]:
        """What the passive part, fitted without each fold, leaves over at both sorts of rows, N."""
        measured_n = [self.data.force_n(rows) for rows in (self.fitted, self.tested)]
        found = []
        for family, fold in self.folds:
            weights = self._passive.weights_without(family, fold)
            fitted_n, tested_n = (
                force_n - values @ weights
                for force_n, values in zip(measured_n, self._terms, strict=True)
            )
            found.append((fitted_n, tested_n))
        return found

    def passive_errors_n(self) -> list[float]:
        """RMSE of the passive part alone on each of `folds`, N."""
        return [
            _rms(left_n[self.families[family][1].number == fold])
            for (family, fold), (_, left_n) in zip(self.folds, self._left_over, strict=True)
        ]

    def tree_errors_n(self, wanted: TreeFit) -> Iterator[float]:
        """RMSE of a forest on each of `folds`, N, one after another."""
        trained = self.data.trained
        scale = depth_scale(trained.max_m - min(trained.min_m, 0.0))
        values, test_values = (
            (scale * self.data.features(wanted.features, rows)).astype(np.float32)
            for rows in (self.fitted, self.tested)
        )
        measured_n = tuple(self.data.force_n(rows) for rows in (self.fitted, self.tested))
        for (family, fold), left_n in zip(self.folds, self._left_over, strict=True):
            target_n, test_n = left_n if wanted.adds else measured_n
            kept = self.families[family][0].number != fold
            held = self.families[family][1].number == fold
            forest = fitted_forest(
                wanted.trees, wanted.leaf, self.options.seed, values[kept], target_n[kept]
            )
            yield _rms(forest.predict(test_values[held]) - test_n[held])


def held_out(data: TrainingSet, options: FitOptions) -> HeldOut:
    """The rows that a fit of these options takes, and evenly spaced ones to judge on."""
    count = min(data.rows_total, _TEST_ROWS)
    tested = np.linspace(0, data.rows_total - 1, count).astype(np.intp)
    return HeldOut(data, options, data.rows(options.fraction, options.seed), tested)


def _rms(error_n: Samples) -> float:
    return float(np.sqrt(np.mean(np.square(error_n))))
