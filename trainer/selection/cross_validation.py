"""Error of forests on rows that a fit has not seen; features are made once for all folds."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Flags, Indices, Samples, rms
from springpot.codegen.model.features import Features
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import fold_families
from springpot.trainer.models.passive.passive_fit import passive_choice
from springpot.trainer.models.passive.term_values import term_columns
from springpot.trainer.models.rf_fd import depth_scale, fitted_forest
from springpot.trainer.models.training_set import TrainingSet

_TEST_ROWS = 12_000


@dataclass(frozen=True, eq=False)
class RowFold:
    """One fold of a family: the fitted rows that are shown, the tested ones that are held out.

    left_n: what the passive part, fitted without this fold, leaves over at all tested rows, N.
    """

    family: int
    shown: Flags
    held: Flags
    left_n: Samples


@dataclass(frozen=True, eq=False)
class FoldedRows:
    """The rows of a fit, `fitted`, those that folds are judged on, `tested`, and the folds."""

    data: TrainingSet
    fitted: Indices
    tested: Indices
    folds: tuple[RowFold, ...]

    def tree_errors_n(self, features: Features, options: FitOptions) -> Iterator[float]:
        """RMSE of a forest on each fold, N, one after another."""
        data, trained = self.data, self.data.trained
        scale = depth_scale(trained.max_m - min(trained.min_m, 0.0))
        values, test_values = (
            (scale * data.features(features, rows)).astype(np.float32)
            for rows in (self.fitted, self.tested)
        )
        measured_n, test_n = data.force_n(self.fitted), data.force_n(self.tested)
        for fold in self.folds:
            forest = fitted_forest(options, values[fold.shown], measured_n[fold.shown])
            yield rms(forest.predict(test_values[fold.held]) - test_n[fold.held])


def folded_rows(data: TrainingSet, options: FitOptions) -> FoldedRows:
    """The rows that a fit of these options takes, evenly spaced ones to judge on, and their folds.

    A fold without rows on either side is none.
    """
    fitted, tested = data.rows(options.fraction, options.seed), data.even_rows(_TEST_ROWS)
    passive = passive_choice(data, options)[0]
    test_values = term_columns(passive.terms, data, tested)
    test_n = data.force_n(tested)
    families = (fold_families(data, rows, options.seed) for rows in (fitted, tested))
    folds = []
    for family, (of_fitted, of_tested) in enumerate(zip(*families, strict=True)):
        for number in of_fitted.tested:
            shown, held = of_fitted.number != number, of_tested.number == number
            if shown.any() and held.any():
                weights = passive.weights_without(family, number)
                if weights is not None:
                    left_n = test_n - passive.rows.given_n(test_values @ weights)
                    folds.append(RowFold(family, shown, held, left_n))
    return FoldedRows(data, fitted, tested, tuple(folds))
