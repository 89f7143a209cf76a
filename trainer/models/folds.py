"""Folds of cross-validation that do not leak: repeats apart, each depth or speed held out whole."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.trainer.models.training_set import TrainingSet

N_FOLDS = 5
FEWEST = 3  # recordings, or ranges, of which one can be held out
_SAME_DEPTH = 0.03  # of the stroke: repeats of one press
_SAME_SPEED = 1.25
_DEPTH_RANGE = 1.15  # recordings whose depths differ by less are of one range


@dataclass(frozen=True, eq=False)
class Folds:
    """A fold number for each row, or each recording, shape (n,); those in `tested` are held out."""

    number: Indices
    tested: tuple[int, ...]


def repeats_apart(depths_m: Sequence[Samples], dt_s: float, folds: int, seed: int) -> Folds:
    """Folds of recordings: repeats of one press go to different ones.

    Depth within 3 % of the stroke and rms speed within 25 % make a repeat.
    """
    condition = _conditions(depths_m, dt_s)
    shuffled = np.random.default_rng(seed).permutation(len(depths_m))
    order = np.argsort(shuffled[condition], kind="stable")
    count = min(folds, len(depths_m))
    number = np.empty(len(depths_m), dtype=np.intp)
    number[order] = np.arange(len(depths_m)) % count
    return Folds(number, tuple(range(count)))


def held_out_whole(data: TrainingSet) -> list[Folds]:
    """Folds of recordings by depth and by speed, each if there are three groups or more.

    The depth with the greatest force is never held out, because that measures extrapolation only.
    """
    deepest_m = np.array([depth.max() for depth in data.depths_m]) - data.trained.min_m
    speeds_mps = np.array([_rms_speed(depth, data.dt_s) for depth in data.depths_m])
    strongest = int(np.argmax([recording.force_n.max() for recording in data.recordings]))
    depth, speed = _grouped(deepest_m, _DEPTH_RANGE), _grouped(speeds_mps, _SAME_SPEED)
    found = []
    for number, never in ((depth, int(depth[strongest])), (speed, None)):
        groups = range(int(number.max()) + 1)
        if len(groups) >= FEWEST:
            found.append(Folds(number, tuple(group for group in groups if group != never)))
    return found


def recording_folds(data: TrainingSet, rows: Indices, seed: int) -> Folds:
    """Five folds of rows, by whole recordings; of fewer than three, contiguous blocks of each."""
    if len(data.recordings) < FEWEST:
        owner = data.owner(rows)
        begin, end = data.bounds[owner], data.bounds[owner + 1]
        return Folds((rows - begin) * N_FOLDS // (end - begin), tuple(range(N_FOLDS)))
    folds = repeats_apart(data.depths_m, data.dt_s, N_FOLDS, seed)
    return Folds(folds.number[data.owner(rows)], folds.tested)


def fold_families(data: TrainingSet, rows: Indices, seed: int) -> list[Folds]:
    """Every honest way to fold the rows: `recording_folds`, and each of `held_out_whole`."""
    found = [recording_folds(data, rows, seed)]
    if len(data.recordings) >= FEWEST:
        owner = data.owner(rows)
        found += [Folds(folds.number[owner], folds.tested) for folds in held_out_whole(data)]
    return found


def pieces(families: Sequence[Folds]) -> Indices:
    """Number of the piece of each row, (rows,): rows that are in one fold in every family."""
    code = np.zeros(len(families[0].number), dtype=np.intp)
    for folds in families:
        code = code * N_FOLDS + folds.number
    return np.unique(code, return_inverse=True)[1]


def geometric_mean(errors: list[float]) -> float:
    """Mean that one fold of extrapolation does not decide by itself."""
    return float(np.exp(np.mean(np.log(np.maximum(errors, 1e-12)))))


def _conditions(depths_m: Sequence[Samples], dt_s: float) -> Indices:
    """Number of each recording's condition, (recordings,): that of the first one like it."""
    found: list[tuple[float, float, float]] = []
    number = np.empty(len(depths_m), dtype=np.intp)
    for i, depth in enumerate(depths_m):
        low, high, speed = float(depth.min()), float(depth.max()), _rms_speed(depth, dt_s)
        for k, (its_low, its_high, its_speed) in enumerate(found):
            near_m = _SAME_DEPTH * (its_high - its_low)
            alike = max(speed, its_speed) <= _SAME_SPEED * min(speed, its_speed)
            if alike and abs(low - its_low) <= near_m and abs(high - its_high) <= near_m:
                number[i] = k
                break
        else:
            number[i] = len(found)
            found.append((low, high, speed))
    return number


def _rms_speed(depth_m: Samples, dt_s: float) -> float:
    return float(np.sqrt(np.mean(np.square(np.diff(depth_m))))) / dt_s


def _grouped(values: Samples, ratio: float) -> Indices:
    """Number of each value's group, (n,): those up to `ratio` times the lowest are one group.

    Of more than five groups, neighbours are joined.
    """
    order = np.argsort(values, kind="stable")
    lowest: list[float] = []
    number = np.empty(len(values), dtype=np.intp)
    for i in order.tolist():
        if not lowest or values[i] > ratio * lowest[-1]:
            lowest.append(float(values[i]))
        number[i] = len(lowest) - 1
    return number * min(N_FOLDS, len(lowest)) // len(lowest)
