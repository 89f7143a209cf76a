"""Error on recordings that a fit has not seen: held out whole, never single rows of them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from springpot.trainer.fit import FitOptions
from springpot.trainer.kinds import fit_model
from springpot.trainer.predict import predict_n
from springpot.trainer.recording import Recording

FOLDS = 3
_ROWS = 4000  # of each fit, and of all predictions
_SHARE = 5  # one recording in so many is set aside for validation


def cross_validated_rmse_n(
    kind: str, recordings: Sequence[Recording], options: FitOptions
) -> float:
    """RMSE over all recordings, each predicted by a model that was fitted without it, N.

    The same few rows for every kind: the figure ranks models, and is no forecast of their error.
    Fewer than three recordings are cut into blocks. Raises DataError as `fit_model` does.
    """
    pieces = blocks(recordings)
    fold = np.random.default_rng(options.seed).permutation(len(pieces)) % FOLDS
    total = sum(len(piece.force_n) for piece in pieces)
    options = replace(options, fraction=_fraction(total * (FOLDS - 1) // FOLDS, options))
    step = -(-total // _ROWS)
    squares, samples = 0.0, 0
    for number in range(FOLDS):
        kept = [piece for piece, its in zip(pieces, fold, strict=True) if its != number]
        held = [piece for piece, its in zip(pieces, fold, strict=True) if its == number]
        model = fit_model(kind, "held out", kept, options).model
        for piece in held:
            rows = np.arange(0, len(piece.force_n), step)
            squares += float(np.sum(np.square(predict_n(model, piece, rows) - piece.force_n[rows])))
            samples += len(rows)
    return float(np.sqrt(squares / samples))


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
