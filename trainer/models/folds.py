"""Folds of cross-validation that do not leak: whole recordings, blocks, or conditions."""

from dataclasses import dataclass

import numpy as np
from sklearn.cluster import KMeans

from springpot.codegen.arrays import Indices
from springpot.trainer.models.training_set import TrainingSet

N_FOLDS = 5
_CONDITIONS = 5


@dataclass(frozen=True, eq=False)
class Folds:
    """A fold number for each row, shape (rows,); folds in `tested` are held out in turn."""

    number: Indices
    tested: tuple[int, ...]


def recording_numbers(n: int, folds: int, seed: int) -> Indices:
    """A fold for each of n recordings, shape (n,)."""
    return np.random.default_rng(seed).permutation(n) % folds


def recording_folds(data: TrainingSet, rows: Indices, seed: int) -> Folds:
    """Five folds of whole recordings; of one recording, five contiguous blocks."""
    n = len(data.recordings)
    if n == 1:
        number = rows * N_FOLDS // data.rows_total
        return Folds(number, tuple(range(N_FOLDS)))
    count = min(N_FOLDS, n)
    return Folds(recording_numbers(n, count, seed)[data.owner(rows)], tuple(range(count)))


def condition_numbers(data: TrainingSet, seed: int) -> tuple[Indices, tuple[int, ...]]:
    """Recordings clustered on range and speed: each one's cluster, shape (n,), and those to test.

    The cluster with the maximum force is never held out, because that measures extrapolation
    only; with fewer than three recordings none is.
    """
    n = len(data.recordings)
    if n < 3:
        return np.zeros(n, dtype=np.intp), ()
    metadata = np.array(
        [
            (np.ptp(depth), np.percentile(np.abs(np.diff(depth)), 95) / data.dt_s)
            for depth in data.depths_m
        ]
    )
    logs = np.log(np.maximum(metadata, 1e-12))
    spread = np.maximum(logs.std(axis=0), 1e-9)
    points = np.round(logs / spread, 3)
    clusters = min(_CONDITIONS, len(np.unique(points, axis=0)))  # repeats may be one point
    fold = KMeans(clusters, n_init=10, random_state=seed).fit_predict(points)
    strongest = fold[int(np.argmax([rec.force_n.max() for rec in data.recordings]))]
    tested = tuple(int(number) for number in np.unique(fold) if number != strongest)
    return fold.astype(np.intp), tested


def condition_folds(data: TrainingSet, rows: Indices, seed: int) -> Folds | None:
    """Folds of rows by `condition_numbers`; None where no cluster can be held out."""
    number, tested = condition_numbers(data, seed)
    return Folds(number[data.owner(rows)], tested) if tested else None


def geometric_mean(errors: list[float]) -> float:
    """Mean that one fold of extrapolation does not decide by itself."""
    return float(np.exp(np.mean(np.log(np.maximum(errors, 1e-12)))))
