"""Error on recordings that a fit has not seen: held out whole, never single rows of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from springpot import Recording
from springpot.codegen.arrays import rms
from springpot.codegen.short_repr import short_repr
from springpot.trainer.kinds import fit_kind
from springpot.trainer.models.contact import contact_of
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import geometric_mean, repeats_apart
from springpot.trainer.models.predict import predict_each_n
from springpot.trainer.models.training_set import TrainingSet, training_set
from springpot.trainer.recordings.quality.spikes import hold_spikes

_SEPARATE = 5  # as many recordings, or fewer, are held out one by one
_BLOCKS = 3  # of each recording, where there are too few to hold any out
_HOLDOUT = 5  # one recording in so many is kept for validation


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
        errors.append(rms(predict_each_n(model, rows) - measured_n))
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
