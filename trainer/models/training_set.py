"""Training recordings, prepared: what they have in common, and the rows that a fit uses."""

import time
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any, TypeVar

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.messages import short_repr
from springpot.codegen.model.features import Features
from springpot.codegen.model.model import Contact, TrainedRange
from springpot.trainer.features import depth_features
from springpot.trainer.models.depths import (
    DepthMotion,
    classify_contact,
    compute_depth_m,
    join_motions,
)
from springpot.trainer.recordings.formats.importing import join_session
from springpot.trainer.recordings.formats.sampling import MAX_UPSAMPLING
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import MAX_SMOOTHED_FRACTION, find_smoothing_s, smooth

_PAPER_SMOOTH_S = 0.025  # 25 samples at 1 kHz, section III-C
PAPER_FRACTION = 0.2  # of the rows, section IV-B
MIN_SUBSAMPLED_ROWS = 20_000
MAX_ROWS = 50_000
_UNIT_ERROR_RATIO = (
    1e4  # times another rate: of time in another unit, or of a rate given as a time step
)
_STEP_TOLERANCE = 1e-3
_Result = TypeVar("_Result")


@dataclass(frozen=True, eq=False)
class TrainingSet:
    """Recordings smoothed for a fit. `rows` index the samples of all recordings in a row.

    smooth_s: length of the moving average, s; 0 for none.
    continues: each recording goes on with the memory of the one before it.
    """

    recordings: tuple[Recording, ...]
    depths_m: tuple[Samples, ...]
    dt_s: float
    contact: Contact
    trained: TrainedRange
    smooth_s: float
    warnings: tuple[str, ...] = ()
    continues: bool = False
    # Of this set alone: `dataclasses.replace` begins with none, as another set has other answers.
    _results: dict[Hashable, tuple[Any, float]] = field(
        default_factory=dict, init=False, repr=False
    )
    __repr__ = short_repr

    def cached(self, key: Hashable, work: Callable[[], _Result]) -> tuple[_Result, float]:
        """Return the result of `work` and its seconds, computed once for a key.

        For what fits of many options on the same data share: the passive part, the pairs of orders.
        """
        if key not in self._results:
            begin = time.perf_counter()
            result = work()
            self._results[key] = result, time.perf_counter() - begin
        return self._results[key]

    @cached_property
    def bounds(self) -> Indices:
        """First row of each recording, and the number of all rows: (recordings + 1,)."""
        return np.concatenate([[0], np.cumsum([len(depth) for depth in self.depths_m])])

    @property
    def rows_total(self) -> int:
        return int(self.bounds[-1])

    @property
    def longest_s(self) -> float:
        return max(len(depth) for depth in self.depths_m) * self.dt_s

    def rows(self, fraction: float | None, seed: int) -> Indices:
        """Rows of a fit, ascending, (rows,); fraction as in `select_rows`."""
        return select_rows(self.rows_total, fraction, np.random.default_rng(seed))

    def even_rows(self, most: int = MAX_ROWS) -> Indices:
        """Return all rows, or `most` evenly spaced ones, (rows,): a fit costs little a row."""
        return np.linspace(0, self.rows_total - 1, min(self.rows_total, most)).astype(np.intp)

    def force_n(self, rows: Indices) -> Samples:
        """Measured force at rows, (rows,), N."""
        forces = [recording.force_n for recording in self.recordings]
        return np.concatenate([f[local] for f, local in zip(forces, self.split(rows), strict=True)])

    def features(self, features: Features, rows: Indices) -> Samples:
        """Features at rows, shape (rows, features)."""
        return self.along(rows, lambda depth, at: depth_features(features, depth, self.dt_s, at))

    def along(self, rows: Indices, values: Callable[[Samples, Indices], Samples]) -> Samples:
        """`values` of each recording's depths, (n,), m, at its rows; all of them end to end."""
        parts = zip(self.depths_m, self.split(rows), strict=True)
        return np.concatenate([values(depth, local) for depth, local in parts])

    def split(self, rows: Indices) -> list[Indices]:
        """Rows (ascending) of each recording, (its rows,), counted from its first sample."""
        cuts = np.searchsorted(rows, self.bounds)
        return [
            rows[begin:end] - first
            for begin, end, first in zip(cuts[:-1], cuts[1:], self.bounds[:-1], strict=True)
        ]

    @cached_property
    def motions(self) -> tuple[DepthMotion, ...]:
        """Join the recordings as the object met them: those of a session one after another."""
        recordings = join_session(self.recordings, 0.0) if self.continues else self.recordings
        return join_motions(recordings, self.depths_m, self.contact == "surface")

    def rows_by_motion(self, rows: Indices) -> list[Indices]:
        """Split row numbers of all recordings by motion: samples of each, (its rows,).

        A motion is the recordings of one session and place, joined (`DepthMotion`).
        """
        by_recording = self.split(rows)
        return [
            np.concatenate([
                start + by_recording[number]
                for number, start in zip(motion.recordings, motion.starts, strict=True)
            ])
            for motion in self.motions
        ]  # fmt: skip

    def to_row_order(self, rows: Indices, values_by_motion: Sequence[Samples]) -> Samples:
        """Sort values of motions, at `rows_by_motion`, into the order of the rows: (rows, ...)."""
        count = np.searchsorted(rows, self.bounds)
        values = np.empty((len(rows), *values_by_motion[0].shape[1:]))
        for motion, motion_values in zip(self.motions, values_by_motion, strict=True):
            done = 0
            for begin, end in ((count[number], count[number + 1]) for number in motion.recordings):
                values[begin:end] = motion_values[done : done + end - begin]
                done += end - begin
        return values

    def map_motions(
        self, rows: Indices, values: Callable[[DepthMotion, Indices], Samples]
    ) -> Samples:
        """`values` of each motion at its samples, (samples, ...), in the order of the rows."""
        pairs = zip(self.motions, self.rows_by_motion(rows), strict=True)
        return self.to_row_order(rows, [values(motion, at) for motion, at in pairs])

    def recording_index(self, rows: Indices) -> Indices:
        """Index of the recording of each row, (rows,)."""
        return np.searchsorted(self.bounds, rows, side="right") - 1


def select_rows(rows_total: int, fraction: float | None, rng: np.random.Generator) -> Indices:
    """Rows to fit on, (rows,), ascending, without repetition.

    fraction None: the paper's 0.2 from 20 000 rows on, all of them below; never more than 50 000.
    """
    if fraction is None:
        fraction = PAPER_FRACTION if rows_total >= MIN_SUBSAMPLED_ROWS else 1.0
    wanted = min(max(1, round(fraction * rows_total)), MAX_ROWS)
    return np.sort(rng.choice(rows_total, size=wanted, replace=False))


def build_training_set(recordings: Sequence[Recording], smooth_s: float | None) -> TrainingSet:
    """Prepare recordings. Raises DataError where they do not fit together.

    smooth_s: of the moving average, s; None: the paper's, or less where it would bend the force.
    The last set is kept: models of several kinds on the same recordings share what is `cached`.
    """
    return _build_training_set(tuple(recordings), smooth_s)


@lru_cache(maxsize=1)
def _build_training_set(recordings: tuple[Recording, ...], smooth_s: float | None) -> TrainingSet:
    """Smooth the recordings, decide on contact, and turn positions into depths."""
    dt_s = find_common_time_step(recordings)
    contact, warning = classify_contact(recordings)
    if smooth_s is None:
        smooth_s = find_smoothing_s(recordings, _PAPER_SMOOTH_S)
    shortest = min(recordings, key=lambda recording: len(recording.force_n))
    if smooth_s > MAX_SMOOTHED_FRACTION * shortest.duration_s:
        raise UsageError(
            f"--smooth-s {smooth_s:g}: {shortest.name} lasts {shortest.duration_s:g} s: smooth "
            "over a quarter of that at most"
        )
    smoothed_set = tuple(smooth(recording, smooth_s) for recording in recordings)
    depths_m = tuple(compute_depth_m(recording, contact) for recording in smoothed_set)
    return TrainingSet(
        recordings=smoothed_set,
        depths_m=depths_m,
        dt_s=dt_s,
        contact=contact,
        trained=_compute_trained_range(smoothed_set, depths_m, contact),
        smooth_s=smooth_s,
        warnings=(warning,) if warning else (),
    )


def find_common_time_step(recordings: Sequence[Recording]) -> float:
    """Time step of all recordings, s. Raises DataError where there are none, or two."""
    if not recordings:
        raise DataError("no recordings: give files or folders of recordings")
    first, rates = recordings[0], dict[str, list[str]]()
    for recording in recordings:
        rates.setdefault(f"{recording.rate_hz:.5g}", []).append(recording.name)
    if any(abs(other.dt_s / first.dt_s - 1.0) > _STEP_TOLERANCE for other in recordings):
        rates_hz = [recording.rate_hz for recording in recordings]
        fewest_first = sorted(rates.items(), key=lambda item: (len(item[1]), first.name in item[1]))
        sampled = ", ".join(
            f"{names[0]}{f' and {len(names) - 1} more' if names[1:] else ''}"
            f"{' is sampled' if k == 0 else ''} at {rate} Hz"
            for k, (rate, names) in enumerate(fewest_first)
        )
        if max(rates_hz) > _UNIT_ERROR_RATIO * min(rates_hz):
            raise DataError(f"{sampled}: one has a wrong unit: give time, or dt_s, in s")
        raise DataError(
            f"{sampled}: import all again with one rate, --resample-hz "
            f"{min(max(rates_hz), MAX_UPSAMPLING * min(rates_hz)):.6g}"
        )
    return first.dt_s


def _compute_trained_range(
    recordings: Sequence[Recording], depths: Sequence[Samples], contact: Contact
) -> TrainedRange:
    """Return the least and greatest depth, speed and force of all recordings.

    Raises DataError where nothing moved.
    """
    min_m = min(float(depth.min()) for depth in depths)
    max_m = max(float(depth.max()) for depth in depths)
    if max_m <= (0.0 if contact == "surface" else min_m):
        raise DataError(
            f"{recordings[0].name}: positions never go deeper than {max_m:g} m: position must "
            "grow into the object; check the sign and the unit on import"
        )
    if contact == "surface" and max(float(rec.force_n.max()) for rec in recordings) <= 0.0:
        raise DataError(
            f"{recordings[0].name}: the force never pushes out (all at or below 0): turn its sign "
            "round on import, for example --map force=COL:-1N"
        )
    speeds = [
        float(np.abs(np.diff(depth)).max()) / recording.dt_s
        for depth, recording in zip(depths, recordings, strict=True)
    ]
    return TrainedRange(
        min_m=min_m,
        max_m=max_m,
        max_mps=max(speeds),
        min_n=min(float(recording.force_n.min()) for recording in recordings),
        max_n=max(float(recording.force_n.max()) for recording in recordings),
    )
