"""Error on recordings that a fit has not seen: held out whole, never single rows of them.

By fits of their own on the recordings that are left; or, where kinds are compared, on rows whose
features and passive terms are made once for all folds.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.model.features import Features
from springpot.codegen.short_repr import short_repr
from springpot.trainer.kinds import fit_kind
from springpot.trainer.models.contact import contact_of
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import fold_families, geometric_mean, repeats_apart
from springpot.trainer.models.forests import depth_scale, fitted_forest
from springpot.trainer.models.passive.passive_fit import passive_choice, term_columns
from springpot.trainer.models.predict import predict_each_n
from springpot.trainer.models.training_set import TrainingSet, training_set
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.spikes import hold_spikes

_SEPARATE = 5  # as many recordings, or fewer, are held out one by one
_BLOCKS = 3  # of each recording, where there are too few to hold any out
_HOLDOUT = 5  # one recording in so many is kept for validation
_TEST_ROWS = 12_000


@dataclass(frozen=True, eq=False)
class Split:
    """One fold: what a fit sees, and the recordings that it does not."""

    data: TrainingSet
    held: tuple[Recording, ...]
    __repr__ = short_repr


def recording_splits(
    recordings: Sequence[Recording], smooth_s: float, seed: int, folds: int = 3
) -> tuple[Split, ...]:
    """Folds of whole recordings, repeats apart: one by one where there are few, else `folds`.

    One or two recordings are folded in blocks.

    Raises DataError where the recordings do not fit together.
    """
    recordings = [hold_spikes(recording)[0] for recording in recordings]
    pieces = blocks(recordings)
    count = folds if len(pieces) > _SEPARATE else len(pieces)
    depths_m = [piece.position_m for piece in pieces]
    folds_of = repeats_apart(depths_m, pieces[0].dt_s, count, seed)
    contact = contact_of(recordings)
    found = []
    for number in folds_of.tested:
        kept = [piece for piece, its in zip(pieces, folds_of.number, strict=True) if its != number]
        held = [piece for piece, its in zip(pieces, folds_of.number, strict=True) if its == number]
        found.append(Split(training_set(kept, smooth_s, contact), tuple(held)))
    return tuple(found)


def cross_validated_rmse_n(
    kind: str, splits: Sequence[Split], options: FitOptions, max_rows: int = 4000
) -> float:
    """Geometric mean of the RMSEs on each split's held recordings, N.

    A fold beyond all others does not decide by itself. max_rows: of each fit, and of all
    predictions: the errors rank models, and are no forecast. Raises DataError as `fit_model` does.
    """
    total = sum(len(piece.force_n) for split in splits for piece in split.held)
    step = -(-total // max_rows)
    errors = []
    for split in splits:
        stated = 1.0 if options.fraction is None else options.fraction
        fraction = min(stated, max_rows / split.data.rows_total)
        model = fit_kind(kind, "held out", split.data, replace(options, fraction=fraction)).model
        rows = [(piece, np.arange(0, len(piece.force_n), step)) for piece in split.held]
        measured_n = np.concatenate([piece.force_n[::step] for piece in split.held])
        errors.append(_rms(predict_each_n(model, rows) - measured_n))
    return geometric_mean(errors)


def blocks(recordings: Sequence[Recording]) -> list[Recording]:
    """The recordings, or where there are too few to hold any out, contiguous blocks of them."""
    if len(recordings) >= _BLOCKS:
        return list(recordings)
    return [
        part_of(recording, block / _BLOCKS, (block + 1) / _BLOCKS)
        for recording in recordings
        for block in range(_BLOCKS)
    ]


def holdout(recordings: Sequence[Recording], seed: int) -> tuple[list[Recording], list[Recording]]:
    """Split into training and validation: a fifth of the recordings, or the end of a single one.

    The recording with the maximum force stays: without it, validation measures extrapolation.
    """
    if len(recordings) == 1:
        cut = 1.0 - 1.0 / _HOLDOUT
        return [part_of(recordings[0], 0.0, cut)], [part_of(recordings[0], cut, 1.0)]
    strongest = int(np.argmax([recording.force_n.max() for recording in recordings]))
    others = [i for i in range(len(recordings)) if i != strongest]
    count = max(1, len(recordings) // _HOLDOUT)
    chosen = set(np.random.default_rng(seed).choice(others, size=count, replace=False).tolist())
    kept = [recording for i, recording in enumerate(recordings) if i not in chosen]
    return kept, [recording for i, recording in enumerate(recordings) if i in chosen]


def part_of(recording: Recording, begin: float, end: float) -> Recording:
    """The samples between two shares of a recording's length."""
    n = len(recording.force_n)
    rows = slice(round(begin * n), round(end * n))
    return replace(
        recording,
        name=f"{recording.name}, {100 * begin:.0f} to {100 * end:.0f} %",
        position_m=recording.position_m[rows],
        force_n=recording.force_n[rows],
        channels={},
        session="",  # what is left of a session has gaps
    )


@dataclass(frozen=True, eq=False)
class TreeFit:
    """A forest to be judged; adds: on what the passive part leaves over."""

    features: Features
    trees: int
    leaf: int
    adds: bool


@dataclass(frozen=True, eq=False)
class RowFold:
    """One fold of a family: which of the fitted rows it keeps, which of the tested ones it holds.

    fitted_n, tested_n: what the passive part, fitted without this fold, leaves over at all rows of
    either sort, N.
    """

    family: int
    kept: NDArray[np.bool_]
    held: NDArray[np.bool_]
    fitted_n: Samples
    tested_n: Samples


@dataclass(frozen=True, eq=False)
class FoldedRows:
    """The rows of a fit, `fitted`, those that folds are judged on, `tested`, and the folds."""

    data: TrainingSet
    seed: int
    fitted: Indices
    tested: Indices
    folds: tuple[RowFold, ...]

    def passive_errors_n(self) -> list[float]:
        """RMSE of the passive part alone on each fold, N."""
        return [_rms(fold.tested_n[fold.held]) for fold in self.folds]

    def tree_errors_n(self, wanted: TreeFit) -> Iterator[float]:
        """RMSE of a forest on each fold, N, one after another."""
        data, trained = self.data, self.data.trained
        scale = depth_scale(trained.max_m - min(trained.min_m, 0.0))
        values, test_values = (
            (scale * data.features(wanted.features, rows)).astype(np.float32)
            for rows in (self.fitted, self.tested)
        )
        measured_n, test_n = data.force_n(self.fitted), data.force_n(self.tested)
        for fold in self.folds:
            target_n = fold.fitted_n if wanted.adds else measured_n
            wanted_n = fold.tested_n if wanted.adds else test_n
            kept, held = fold.kept, fold.held
            forest = fitted_forest(
                wanted.trees, wanted.leaf, self.seed, values[kept], target_n[kept]
            )
            yield _rms(forest.predict(test_values[held]) - wanted_n[held])


def folded_rows(data: TrainingSet, options: FitOptions) -> FoldedRows:
    """The rows that a fit of these options takes, evenly spaced ones to judge on, and their folds.

    A fold without rows on either side is none.
    """
    count = min(data.rows_total, _TEST_ROWS)
    fitted = data.rows(options.fraction, options.seed)
    tested = np.linspace(0, data.rows_total - 1, count).astype(np.intp)
    passive = passive_choice(data, options)[0]
    values, test_values = (term_columns(passive.terms, data, rows) for rows in (fitted, tested))
    measured_n, test_n = data.force_n(fitted), data.force_n(tested)
    families = (fold_families(data, rows, options.seed) for rows in (fitted, tested))
    folds = []
    for family, (of_fitted, of_tested) in enumerate(zip(*families, strict=True)):
        for number in of_fitted.tested:
            kept, held = of_fitted.number != number, of_tested.number == number
            if kept.any() and held.any():
                weights = passive.weights_without(family, number)
                if weights is not None:
                    left_n = measured_n - passive.rows.given_n(values @ weights)
                    test_left_n = test_n - passive.rows.given_n(test_values @ weights)
                    folds.append(RowFold(family, kept, held, left_n, test_left_n))
    return FoldedRows(data, options.seed, fitted, tested, tuple(folds))


def _rms(error_n: Samples) -> float:
    return float(np.sqrt(np.mean(np.square(error_n))))
