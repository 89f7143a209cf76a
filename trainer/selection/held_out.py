"""Error on recordings that a fit has not seen: held out whole, never single rows of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from springpot.trainer.kinds import fit_kind
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import geometric_mean
from springpot.trainer.models.predict import predict_each_n
from springpot.trainer.models.training_set import TrainingSet, training_set
from springpot.trainer.recordings.recording import Recording

FOLDS = 3
_EACH = 5  # as many recordings, or fewer, are held out one by one
_ROWS = 4000  # of each fit, and of all predictions
_SHARE = 5  # one recording in so many is set aside for validation


@dataclass(frozen=True, eq=False)
class Split:
    """One fold: what a fit sees, and the recordings that it does not."""

    data: TrainingSet
    held: tuple[Recording, ...]


def splits(recordings: Sequence[Recording], smooth_s: float, seed: int) -> tuple[Split, ...]:
    """Three folds of whole recordings; each alone where there are few, blocks of one or two.

    Raises DataError where the recordings do not fit together.
    """
    pieces = blocks(recordings)
    count = FOLDS if len(pieces) > _EACH else len(pieces)
    fold = np.random.default_rng(seed).permutation(len(pieces)) % count
    found = []
    for number in range(count):
        kept = [piece for piece, its in zip(pieces, fold, strict=True) if its != number]
        held = [piece for piece, its in zip(pieces, fold, strict=True) if its == number]
        found.append(Split(training_set(kept, smooth_s), tuple(held)))
    return tuple(found)


def cross_validated_rmse_n(kind: str, folds: Sequence[Split], options: FitOptions) -> float:
    """Geometric mean over the folds of the RMSE of models that were fitted without them, N.

    A fold that lies beyond all others does not decide alone. The same few rows for every kind: the
    figure ranks models, and is no forecast of their error. Raises DataError as `fit_model` does.
    """
    total = sum(len(piece.force_n) for fold in folds for piece in fold.held)
    options = replace(options, fraction=_fraction(total * (len(folds) - 1) // len(folds), options))
    step = -(-total // _ROWS)
    errors = []
    for fold in folds:
        model = fit_kind(kind, "held out", fold.data, options).model
        rows = [(piece, np.arange(0, len(piece.force_n), step)) for piece in fold.held]
        measured_n = np.concatenate([piece.force_n[::step] for piece in fold.held])
        error_n = predict_each_n(model, rows) - measured_n
        errors.append(float(np.sqrt(np.mean(np.square(error_n)))))
    return geometric_mean(errors)


def _fraction(rows: int, options: FitOptions) -> float:
    """Share of the rows that a fold is fitted on: fewer than the model itself, for time."""
    stated = 1.0 if options.fraction is None else options.fraction
    return min(stated, _ROWS / rows)


def blocks(recordings: Sequence[Recording]) -> list[Recording]:
    """The recordings, or where there are too few to hold any out, contiguous blocks of them."""
    if len(recordings) >= FOLDS:
        return list(recordings)
    return [
        part_of(recording, block / FOLDS, (block + 1) / FOLDS)
        for recording in recordings
        for block in range(FOLDS)
    ]


def set_aside(
    recordings: Sequence[Recording], seed: int
) -> tuple[list[Recording], list[Recording]]:
    """Split into training and validation: a fifth of the recordings, or the end of a single one.

    The recording with the greatest force stays: without it, validation measures extrapolation.
    """
    if len(recordings) == 1:
        cut = 1.0 - 1.0 / _SHARE
        return [part_of(recordings[0], 0.0, cut)], [part_of(recordings[0], cut, 1.0)]
    strongest = int(np.argmax([recording.force_n.max() for recording in recordings]))
    others = [i for i in range(len(recordings)) if i != strongest]
    count = max(1, len(recordings) // _SHARE)
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
    )
