"""Figures of a prediction against a measurement, beside what no model and no hand can tell."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples, rms
from springpot.codegen.errors import DataError
from springpot.codegen.messages import short_repr
from springpot.codegen.notes import RAMPED
from springpot.codegen.types import JsonObject
from springpot.trainer.recordings.quality.repeats import NoiseFloor

# Weber fraction of force: 10 % at and above 2 N (the paper's figure 8); below it rises, and is
# drawn, not scored.
WEBER_FRACTION = 0.10
SCORED_ABOVE_N = 2.0
JND_WORDS = (
    f"a hand can tell {100 * WEBER_FRACTION:g} % of the force from {SCORED_ABOVE_N:g} N on, "
    f"{WEBER_FRACTION * SCORED_ABOVE_N:g} N below"
)
_BOOTSTRAPS = 2000


@dataclass(frozen=True)
class Accuracy:
    """Error of forces over several recordings.

    samples: all of them. ramped: those of the start-up ramp, where a recording begins in contact:
    the force rises from zero there whatever the model says, and no error counts them.
    rmse_n: over the others. mean_error_n: predicted less measured, averaged: the one-sided part of
    the error. mean_recording_rmse_n: RMSE of each recording, averaged (the paper's
    figure 9), and interval_n its 95 % bootstrap interval over recordings (None for one recording).
    ape_below_jnd: share of samples above 2 N whose absolute percentage error is below the just
    noticeable difference (None where no sample is). error_per_jnd: RMS of the errors, each over the
    just noticeable difference of its measured force, that below 2 N included.
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
    __repr__ = short_repr


def start_up_ramp(notes: NDArray[np.int32]) -> int:
    """Ticks at the beginning of a replay whose force still rose from zero; notes: (n,)."""
    settled = np.flatnonzero((notes & RAMPED) == 0)
    return int(settled[0]) if len(settled) else 0


def accuracy(
    measured_n: Sequence[Samples],
    predicted_n: Sequence[Samples],
    ramps: Sequence[int] | None = None,
) -> Accuracy:
    """Compare recordings with predictions, one array a recording.

    ramps: samples of each that are not counted, from the beginning; none by default.
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
    each = np.array([rms(values) for values in errors])
    rmse_n = rms(error)
    return Accuracy(
        samples=len(error) + sum(ramps),
        ramped=sum(ramps),
        rmse_n=rmse_n,
        rmse_percent_of_peak=100.0 * rmse_n / float(np.abs(measured).max()),
        mean_error_n=float(error.mean()),
        mean_recording_rmse_n=float(each.mean()),
        interval_n=_bootstrap_interval(each),
        max_abs_error_n=float(np.abs(error).max()),
        p99_abs_error_n=float(np.percentile(np.abs(error), 99)),
        ape_below_jnd=_below_jnd(measured, error),
        error_per_jnd=rms(error / just_noticeable_n(measured)),
    )


def error_ratios(found: Accuracy, floor: NoiseFloor) -> JsonObject:
    """JSON keys: the floor and what it is from, the RMSE over it, the error over the JND."""
    per_floor = found.rmse_n / floor.rms_n if floor.rms_n else None
    return floor_keys(floor) | {
        "error_per_floor": per_floor,
        "error_per_jnd": found.error_per_jnd,
    }


def floor_keys(floor: NoiseFloor) -> JsonObject:
    """JSON keys of a floor alone."""
    return {
        "noise_floor_n": floor.rms_n,
        "noise_floor_from": floor.source,
        "noise_floor": floor.words,
    }


def floor_words(floor: JsonObject) -> str:
    """A floor in a person's words. floor: of `floor_keys`."""
    floor_n, words = floor["noise_floor_n"], floor["noise_floor"]
    if floor_n is None:
        return f"not known: {words}"
    return f"{floor_n:.3g} N, {words}" if floor_n else f"0 N, {words}: no ratio"


def ratio_rows(ratios: JsonObject) -> dict[str, str]:
    """Two rows under an error."""
    words, ratio = floor_words(ratios), ratios["error_per_floor"]
    return {
        "error / noise floor": words if ratio is None else f"{ratio:.3g} (floor {words})",
        "error / JND": f"{ratios['error_per_jnd']:.3g}, rms ({JND_WORDS})",
    }


def just_noticeable_n(force_n: Samples) -> Samples:
    """Just noticeable difference, N: 10 % of the force from 2 N on, 0.2 N below."""
    noticeable: Samples = WEBER_FRACTION * np.maximum(np.abs(force_n), SCORED_ABOVE_N)
    return noticeable


def _below_jnd(measured_n: Samples, error_n: Samples) -> float | None:
    scored = np.abs(measured_n) >= SCORED_ABOVE_N
    if not scored.any():
        return None
    share = np.abs(error_n[scored]) / np.abs(measured_n[scored])
    return float(np.mean(share < WEBER_FRACTION))


def _bootstrap_interval(each: Samples) -> tuple[float, float] | None:
    if len(each) < 2:
        return None
    draws = np.random.default_rng(0).choice(each, size=(_BOOTSTRAPS, len(each)))
    low, high = np.percentile(draws.mean(axis=1), [2.5, 97.5])
    return float(low), float(high)
