"""Figures of a prediction against a measurement: of force, and of the stiffness along presses."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Flags, Samples, rms
from springpot.codegen.errors import DataError
from springpot.codegen.messages import short_repr
from springpot.codegen.notes import RAMPED
from springpot.codegen.types import JsonObject
from springpot.trainer.recordings.quality.repeats import NoiseFloor
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import turning_points

# Weber fraction of force: 10 % at and above 2 N (the paper's figure 8); below it rises, and is
# drawn, not scored.
WEBER_FRACTION = 0.10
SCORED_ABOVE_N = 2.0
JND_WORDS = (
    f"a hand can tell {100 * WEBER_FRACTION:g} % of the force from {SCORED_ABOVE_N:g} N on, "
    f"{WEBER_FRACTION * SCORED_ABOVE_N:g} N below"
)
_BOOTSTRAPS = 2000
STIFFNESS_JND = 0.15  # just noticeable difference, of the stiffness: about so much
_MIN_REVERSAL = 0.1  # of the range of positions: what turns by less is one way in
_WINDOWS_PER_STROKE = (16, 8, 4, 2)  # of a way in: as many as noise allows
_MAX_MEDIAN_SLOPE_SE = 0.03  # median standard error of the measured slopes, of the slope
_UNKNOWN, _FLAT = 0.1, 0.05  # standard error of a slope, and share of the greatest: not counted
_MIN_WINDOW_SAMPLES = 8  # samples of a window
_QUADRATIC = 3  # numbers of a parabola


@dataclass(frozen=True)
class Accuracy:
    """Error of forces over several recordings.

    samples: all of them. ramped: those of the start-up ramp, where a recording begins in contact:
    the force rises from zero there whatever the model says, and no error counts them.
    rmse_n: over the others. mean_error_n: predicted less measured, averaged: the one-sided part of
    the error. mean_recording_rmse_n: RMSE of each recording, averaged (the paper's
    figure 9), and interval_n its 95 % bootstrap interval over recordings (None for one recording).
    ape_below_jnd: share of samples above 2 N with an absolute percentage error below the just
    noticeable difference (None where no sample is). error_per_jnd: RMS of the errors, each over the
    just noticeable difference of its measured force, that below 2 N included. contact_below_jnd:
    share of the samples in contact whose error is below that (None without contact): an RMS falls
    with the time in the air, this does not.
    """

    samples: int
    ramped: int
    rmse_n: float
    rmse_percent_of_peak: float
    mean_error_n: float
    mean_recording_rmse_n: float
    interval_n: tuple[float, float] | None
    max_abs_error_n: float
    p99_abs_error_n: float
    ape_below_jnd: float | None
    error_per_jnd: float
    contact_below_jnd: float | None
    __repr__ = short_repr


def start_up_ramp(notes: NDArray[np.int32]) -> int:
    """Ticks at the beginning of a replay while the force still rose from zero; notes: (n,)."""
    settled = np.flatnonzero((notes & RAMPED) == 0)
    return int(settled[0]) if len(settled) else 0


def accuracy(
    measured_n: Sequence[Samples],
    predicted_n: Sequence[Samples],
    ramps: Sequence[int] | None = None,
    contacts: Sequence[Flags] | None = None,
) -> Accuracy:
    """Compare recordings with predictions, one array a recording.

    ramps: samples of each that are not counted, from the beginning; none by default. contacts:
    which samples are in contact, of `find_contacts`; all by default.
    """
    ramps = [0] * len(measured_n) if ramps is None else ramps
    counted = [
        (measured[ramp:], np.asarray(predicted, dtype=np.float64)[ramp:])
        for measured, predicted, ramp in zip(measured_n, predicted_n, ramps, strict=True)
    ]
    errors = [predicted - measured for measured, predicted in counted]
    error = np.concatenate(errors)
    measured = np.concatenate([measured for measured, _ in counted])
    if not measured.any():
        raise DataError(
            "the measured force is 0 everywhere, as in a session that a watchdog ended at once: "
            "there is nothing to compare with"
        )
    rmse_each_n = np.array([rms(values) for values in errors])
    interval_n, ape_below_jnd = None, None
    if len(rmse_each_n) > 1:
        draws = np.random.default_rng(0).choice(rmse_each_n, size=(_BOOTSTRAPS, len(rmse_each_n)))
        low_n, high_n = np.percentile(draws.mean(axis=1), [2.5, 97.5]).tolist()
        interval_n = low_n, high_n
    if (scored := np.abs(measured) >= SCORED_ABOVE_N).any():
        share = np.abs(error[scored]) / np.abs(measured[scored])
        ape_below_jnd = float(np.mean(share < WEBER_FRACTION))
    touched = np.ones(len(error), dtype=bool)
    if contacts is not None:
        touched = np.concatenate([c[r:] for c, r in zip(contacts, ramps, strict=True)])
    below = (np.abs(error) < just_noticeable_n(measured))[touched]
    rmse_n = rms(error)
    return Accuracy(
        samples=len(error) + sum(ramps),
        ramped=sum(ramps),
        rmse_n=rmse_n,
        rmse_percent_of_peak=100.0 * rmse_n / float(np.abs(measured).max()),
        mean_error_n=float(error.mean()),
        mean_recording_rmse_n=float(rmse_each_n.mean()),
        interval_n=interval_n,
        max_abs_error_n=float(np.abs(error).max()),
        p99_abs_error_n=float(np.percentile(np.abs(error), 99)),
        ape_below_jnd=ape_below_jnd,
        error_per_jnd=rms(error / just_noticeable_n(measured)),
        contact_below_jnd=float(below.mean()) if len(below) else None,
    )


def find_contacts(recordings: Sequence[Recording], has_surface: bool) -> list[Flags]:
    """Mark the samples of each recording in contact: below the surface; all without a surface."""
    return [
        np.asarray(recording.position_m > 0.0)
        if has_surface
        else np.ones(len(recording.position_m), dtype=bool)
        for recording in recordings
    ]


def contact_sentence(below: float | None) -> str:
    """Say how much of the contact has an error that no hand can tell."""
    return "no contact" if below is None else f"{100 * below:.1f} % of contact ({JND_WORDS})"


def error_ratio_keys(error: Accuracy, floor: NoiseFloor) -> JsonObject:
    """Return JSON keys: the floor and what it is from, the RMSE over it, the error over the JND."""
    per_floor = error.rmse_n / floor.rms_n if floor.rms_n else None
    return {
        "noise_floor_n": floor.rms_n,
        "noise_floor_from": floor.source,
        "noise_floor": floor.words,
        "error_per_floor": per_floor,
        "error_per_jnd": error.error_per_jnd,
        "contact_below_jnd": error.contact_below_jnd,
    }


def format_start_errors(by_start_n: Mapping[str, float | None]) -> str:
    """Say how the model itself errs where recordings begin at rest, or go on from the training.

    "" for a model that has no state, whose features begin at rest.
    """
    if not by_start_n or by_start_n["continues"] is None:
        return ""
    rested_n, continues_n = by_start_n["rested"], by_start_n["continues"]
    return f"rested {rested_n:.4g} N, continues {continues_n:.4g} N where the training ended"


def ratio_rows(ratios: JsonObject) -> dict[str, str]:
    """Two rows under an error; ratios: of `error_ratios`."""
    floor_n, words = ratios["noise_floor_n"], ratios["noise_floor"]
    ratio = ratios["error_per_floor"]
    if floor_n is None:
        of_floor = f"not known: {words}"
    elif ratio is None:
        of_floor = f"0 N, {words}: no ratio"
    else:
        of_floor = f"{ratio:.3g} (floor {floor_n:.3g} N, {words})"
    return {
        "error / noise floor": of_floor,
        "below the JND": contact_sentence(ratios["contact_below_jnd"]),
    }


def just_noticeable_n(force_n: Samples) -> Samples:
    """Just noticeable difference, N: 10 % of the force from 2 N on, 0.2 N below."""
    return WEBER_FRACTION * np.maximum(np.abs(force_n), SCORED_ABOVE_N)


@dataclass(frozen=True)
class SlopeErrors:
    """Error of dF/dx on the way in, percent of the measured slope, over windows of the depth.

    windows: so many. floor_percent: median standard error of the measured slopes themselves.
    """

    windows: int
    median_percent: float
    p95_percent: float
    floor_percent: float


def slope_errors(
    recordings: Sequence[Recording],
    predicted_n: Sequence[Samples],
    ramps: Sequence[int] | None = None,
) -> SlopeErrors | None:
    """Compare the slopes of recordings with those of predictions, one array (n,), N, a recording.

    A window's slope is that of a parabola through its samples, at their mean depth. A way in has
    as many windows as keep its measured slopes known to 3 %. None where no slope is known.
    ramps: samples of each that are not counted, from the beginning; none by default.
    """
    ramps = [0] * len(recordings) if ramps is None else ramps
    ways = [
        _resolved_slopes(recording, force_n, slice(max(way.start, ramp), way.stop))
        for recording, force_n, ramp in zip(recordings, predicted_n, ramps, strict=True)
        for way in _loading_strokes(recording.position_m)
        if way.stop - ramp > _MIN_WINDOW_SAMPLES
    ]
    if not sum(map(len, ways)):
        return None
    measured, known, predicted = np.concatenate(ways).T
    percent = 100.0 * np.abs(predicted - measured) / measured
    return SlopeErrors(
        windows=len(measured),
        median_percent=float(np.median(percent)),
        p95_percent=float(np.percentile(percent, 95)),
        floor_percent=float(np.median(100.0 * known / measured)),
    )


def slope_keys(errors: SlopeErrors | None) -> JsonObject:
    """JSON keys: median and 95 % quantile of the error, its floor; null if no slope is known."""
    return {
        "slope_error_median_percent": None if errors is None else errors.median_percent,
        "slope_error_p95_percent": None if errors is None else errors.p95_percent,
        "slope_floor_percent": None if errors is None else errors.floor_percent,
    }


def slope_sentence(keys: JsonObject) -> str:
    """Return the same in a person's words; keys: of `slope_keys`."""
    if keys["slope_error_median_percent"] is None:
        return "not known: no way in on which the measured slope stands out from noise"
    return (
        f"median {keys['slope_error_median_percent']:.2g} %, 95 % below "
        f"{keys['slope_error_p95_percent']:.2g} % (a hand can tell {100 * STIFFNESS_JND:g} %; "
        f"measured to {keys['slope_floor_percent']:.2g} %)"
    )


def press_errors_n(
    recordings: Sequence[Recording], predicted_n: Sequence[Samples], ramps: Sequence[int]
) -> tuple[float, float] | None:
    """RMSE of the first press of each recording, and of the later ones, N; None without either.

    The first shows whether the model begins as the object does: at rest, or as after a press.
    """
    first, later = [], []
    for recording, force_n, ramp in zip(recordings, predicted_n, ramps, strict=True):
        error_n = force_n - recording.force_n
        begins = [way.start for way in _loading_strokes(recording.position_m)]
        second = max(begins[1], ramp) if len(begins) > 1 else len(error_n)
        first.append(error_n[ramp:second])
        later.append(error_n[second:])
    if not (any(map(len, first)) and any(map(len, later))):
        return None
    return rms(np.concatenate(first)), rms(np.concatenate(later))


def _loading_strokes(position_m: Samples) -> Iterator[slice]:
    """Yield samples of each way from a turn to a deeper one."""
    turns = turning_points(position_m, _MIN_REVERSAL * float(np.ptp(position_m)))
    for begin, end in pairwise(turns):
        if position_m[end] > position_m[begin]:
            yield slice(begin, end + 1)


def _resolved_slopes(recording: Recording, predicted_n: Samples, way: slice) -> Samples:
    """Return the slopes that stand out from noise, (k, 3), N/m: measured, its error, predicted."""
    depth_m, force_n = recording.position_m[way], recording.force_n[way]
    for windows in _WINDOWS_PER_STROKE:
        windows_found = list(_slopes(depth_m, force_n, predicted_n[way], windows))
        slopes = np.array(windows_found).reshape(-1, 3)
        slopes = slopes[slopes[:, 0] > _FLAT * slopes[:, 0].max(initial=0.0)]
        shares = slopes[:, 1] / slopes[:, 0]
        if len(shares) and np.median(shares) <= _MAX_MEDIAN_SLOPE_SE:
            known: Samples = slopes[shares <= _UNKNOWN]
            return known
    return np.empty((0, 3))


def _slopes(
    depth_m: Samples, force_n: Samples, predicted_n: Samples, windows: int
) -> Iterator[Samples]:
    """Fit a parabola over windows of depth on each way in: slope measured and predicted, N/m."""
    edges_m = np.linspace(depth_m[0], depth_m[-1], windows + 1)
    number = np.clip(np.searchsorted(edges_m, depth_m, side="right") - 1, 0, windows - 1)
    for window in range(windows):
        rows = np.flatnonzero(number == window)
        if len(rows) < _MIN_WINDOW_SAMPLES or np.ptp(depth_m[rows]) <= 0.5 * (
            edges_m[1] - edges_m[0]
        ):
            continue
        u = (depth_m[rows] - depth_m[rows].mean()) / (edges_m[1] - edges_m[0])
        powers = np.stack([np.ones_like(u), u, u * u], axis=1)
        inverse = np.linalg.pinv(powers.T @ powers)
        both = inverse @ powers.T @ np.stack([force_n[rows], predicted_n[rows]], axis=1)
        left_n = force_n[rows] - powers @ both[:, 0]
        variance = float(left_n @ left_n) / (len(rows) - _QUADRATIC) * float(inverse[1, 1])
        per_m = 1.0 / float(edges_m[1] - edges_m[0])
        yield per_m * np.array([both[1, 0], np.sqrt(variance), both[1, 1]])
