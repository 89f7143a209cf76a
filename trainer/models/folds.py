"""Folds of cross-validation that do not leak: repeats apart, each depth or speed held out whole.

What is held out is a press: from one turn at the top to the next, in whatever recording it is.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Indices, Samples, rms
from springpot.codegen.messages import short_repr
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.signals import turning_points

N_FOLDS = 5
MIN_GROUPS = 3  # recordings, or ranges, of which one can be held out
_REPEAT_DEPTH_TOLERANCE = 0.03  # of the stroke: repeats of one press
_SPEED_GROUP_RATIO = 1.25
_DEPTH_GROUP_RATIO = 1.15  # presses with depths that differ by less are of one range
_MIN_TURN_FRACTION = 0.1  # of the trained depth: what turns by less is one press


@dataclass(frozen=True, eq=False)
class Folds:
    """A fold number for each row, or each recording, shape (n,); those in `tested` are held out."""

    number: Indices
    tested: tuple[int, ...]
    __repr__ = short_repr


def split_repeats(depths_m: Sequence[Samples], dt_s: float, folds: int, seed: int) -> Folds:
    """Split recordings into folds, so that repeats of one press are in different ones.

    Depth within 3 % of the stroke and rms speed within 25 % make a repeat.
    """
    condition = _group_conditions(depths_m, dt_s)
    shuffled = np.random.default_rng(seed).permutation(len(depths_m))
    order = np.argsort(shuffled[condition], kind="stable")
    count = min(folds, len(depths_m))
    number = np.empty(len(depths_m), dtype=np.intp)
    number[order] = np.arange(len(depths_m)) % count
    return Folds(number, tuple(range(count)))


def _find_presses(data: TrainingSet) -> tuple[Indices, Samples, Samples]:
    """Find each press: its first row, its depth, m, and its rms speed, m/s, (presses,) each.

    Recordings are cut where the tool turns back into the object.
    """
    min_m, presses = _MIN_TURN_FRACTION * (data.trained.max_m - data.trained.min_m), []
    for first, depth_m in zip(data.bounds.tolist(), data.depths_m, strict=False):
        turns = turning_points(depth_m, min_m)[1:-1]
        # Turns alternate: those at which the tool goes in again begin a press.
        inward = turns[1::2] if turns and depth_m[turns[0]] > depth_m[0] else turns[0::2]
        for begin, part in zip([0, *inward], np.split(depth_m, inward), strict=True):
            presses.append((first + begin, part.max(), rms(np.diff(part)) / data.dt_s))
    begins, depths_m, speeds_mps = map(np.array, zip(*presses, strict=True))
    return begins, depths_m, speeds_mps


def split_by_condition(data: TrainingSet, rows: Indices) -> list[Folds]:
    """Split rows into folds by depth and by speed of their press, if there are three groups.

    A fold then holds a whole depth, or a whole speed, out: what the model does between and beyond.
    """
    begins, depths_m, speeds_mps = data.cached("presses", lambda: _find_presses(data))[0]
    press = np.searchsorted(begins, rows, side="right") - 1
    deepest_m, schemes = depths_m - data.trained.min_m, []
    for values, ratio in ((deepest_m, _DEPTH_GROUP_RATIO), (speeds_mps, _SPEED_GROUP_RATIO)):
        number = _group_by_ratio(values, ratio)
        groups = int(number.max()) + 1
        if groups >= MIN_GROUPS:
            schemes.append(Folds(number[press], tuple(range(groups))))
    return schemes


def split_by_recording(data: TrainingSet, rows: Indices, seed: int) -> Folds:
    """Split rows into five folds of whole recordings; of under three, into blocks of each."""
    if len(data.recordings) < MIN_GROUPS:
        owner = data.recording_index(rows)
        begin, end = data.bounds[owner], data.bounds[owner + 1]
        return Folds((rows - begin) * N_FOLDS // (end - begin), tuple(range(N_FOLDS)))
    folds = split_repeats(data.depths_m, data.dt_s, N_FOLDS, seed)
    return Folds(folds.number[data.recording_index(rows)], folds.tested)


def build_cv_schemes(data: TrainingSet, rows: Indices, seed: int) -> list[Folds]:
    """Build the cross-validation schemes: `split_by_recording`, each `split_by_condition`, once.

    What is as deep as nothing else is never held out: that measures extrapolation only.
    """
    depth_m = np.concatenate([
        depth[local_rows] for depth, local_rows in zip(data.depths_m, data.split(rows), strict=True)
    ])  # fmt: skip
    deepest_m = (
        depth_m
        > data.trained.min_m + (data.trained.max_m - data.trained.min_m) / _DEPTH_GROUP_RATIO
    )
    schemes: list[Folds] = []
    for folds in (split_by_recording(data, rows, seed), *split_by_condition(data, rows)):
        tested = tuple(k for k in folds.tested if (deepest_m & (folds.number != k)).any())
        is_duplicate = any(_is_same_partition(folds.number, scheme.number) for scheme in schemes)
        if tested and not is_duplicate:
            schemes.append(Folds(folds.number, tested))
    return schemes or [split_by_recording(data, rows, seed)]


def _is_same_partition(one: Indices, other: Indices) -> bool:
    """Tell if two numberings part the rows alike."""
    pairs = len(np.unique(one * (1 + other.max()) + other))
    return pairs == len(np.unique(one)) == len(np.unique(other))


def compute_fold_cells(families: Sequence[Folds]) -> Indices:
    """Number the piece of each row, (rows,): rows that are in one fold in every family."""
    code = np.zeros(len(families[0].number), dtype=np.intp)
    for folds in families:
        code = code * N_FOLDS + folds.number
    return np.unique(code, return_inverse=True)[1]


def geometric_mean(errors: Sequence[float] | Samples) -> float:
    """Mean that one fold of extrapolation does not decide by itself."""
    return float(np.exp(np.mean(np.log(np.maximum(errors, 1e-12)))))


def _group_conditions(depths_m: Sequence[Samples], dt_s: float) -> Indices:
    """Number the recordings with the same number for equal depth and speed, (recordings,)."""
    conditions: list[tuple[float, float, float]] = []
    number = np.empty(len(depths_m), dtype=np.intp)
    for i, depth in enumerate(depths_m):
        low, high, speed = float(depth.min()), float(depth.max()), rms(np.diff(depth)) / dt_s
        for k, (known_low, known_high, known_speed) in enumerate(conditions):
            near_m = _REPEAT_DEPTH_TOLERANCE * (known_high - known_low)
            same_speed = max(speed, known_speed) <= _SPEED_GROUP_RATIO * min(speed, known_speed)
            if same_speed and abs(low - known_low) <= near_m and abs(high - known_high) <= near_m:
                number[i] = k
                break
        else:
            number[i] = len(conditions)
            conditions.append((low, high, speed))
    return number


def _group_by_ratio(values: Samples, ratio: float) -> Indices:
    """Number groups of values, (n,): those up to `ratio` times the lowest of a group are one.

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
