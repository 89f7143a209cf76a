"""Doubts about a fit: memory that was guessed, presses that it misses, recordings unlike."""

from collections.abc import Iterator

import numpy as np

from springpot.codegen.errors import SpringpotError
from springpot.trainer.models.fit import Fit, FitOptions
from springpot.trainer.models.predict import predict_each_n
from springpot.trainer.models.training_set import TrainingSet

# Of the largest force, by cross-validation: what is warned of, and what is no model.
_WARN_MISFIT_FRACTION, _MAX_MISFIT_FRACTION = 0.15, 0.3
_MAX_FORCE_RATIO, _FELT_FORCE_FRACTION = (
    1.15,
    0.05,
)  # times the force of another recording; of the largest force
_MAX_COMPARED_ROWS = 2000  # of each recording
_MIN_WINDOWS = 3  # a recording shorter than this many windows shows too little of their memory


def find_fit_warnings(fit: Fit, data: TrainingSet, options: FitOptions) -> Iterator[str]:
    """Yield a line for each doubt, with what to do."""
    window_s = options.window_s
    if window_s is not None and data.longest_s < _MIN_WINDOWS * window_s:
        yield (
            f"--window-s {window_s:g}: the longest recording lasts {data.longest_s:.3g} s, under "
            f"{_MIN_WINDOWS} windows: memory that long is guessed, not learned; record longer holds"
        )
    if _compute_misfit(fit, data) > _WARN_MISFIT_FRACTION:
        yield _misfit_message(fit, data)
    yield from _compare_recordings(fit, data)


def require_acceptable_misfit(fit: Fit, data: TrainingSet, accepted: bool) -> None:
    """Raise SpringpotError for a model that misses held-out presses by 30 % of the force.

    Not of a map: there whole places are held out, and each is a guess from its neighbours.
    """
    if _compute_misfit(fit, data) > _MAX_MISFIT_FRACTION and not (
        accepted or "places" in fit.metadata
    ):
        raise SpringpotError(
            f"{_misfit_message(fit, data)}; --accept-misfit takes the model as it is"
        )


def _peak_n(data: TrainingSet) -> float:
    return max(abs(data.trained.max_n), abs(data.trained.min_n))


def _compute_misfit(fit: Fit, data: TrainingSet) -> float:
    """Share of the largest force by which held-out presses were missed; 0 if none was held out."""
    error_n: float = fit.metadata.get("cv_rmse_n") or 0.0
    return error_n / _peak_n(data) if error_n else 0.0


def _misfit_message(fit: Fit, data: TrainingSet) -> str:
    kind = fit.model.kind
    return (
        f"{fit.model.name}: presses that were held out are missed by "
        f"{100.0 * _compute_misfit(fit, data):.0f} % of the largest force: {kind} cannot "
        "follow this object, or the recordings are not of one, or of one zero: "
        "see `springpot check`" + ", or try --model rf-fd" * (kind != "rf-fd")
    )


def _compare_recordings(fit: Fit, data: TrainingSet) -> Iterator[str]:
    """Warn of a passive model of recordings that no one model can follow: of different objects.

    Of 16 sets of one object, the factors that fit each recording's force best to the model of all
    differed by .3 % at most, of five specimens by 4 %; of eight sets with one recording of another
    object, 1.5 to 2.3 times as stiff, by 20 to 60 %.
    """
    if fit.model.kind != "hammerstein" or len(data.recordings) < 2:
        return
    samples = [
        (each, np.arange(0, len(each.force_n), max(1, len(each.force_n) // _MAX_COMPARED_ROWS)))
        for each in data.recordings
    ]
    factors, max_difference_n = {}, 0.0
    for (recording, rows), predicted_n in zip(
        samples, predict_each_n(fit.model, samples), strict=True
    ):
        if predicted_n.any():
            factor = float(predicted_n @ recording.force_n[rows]) / float(predicted_n @ predicted_n)
            factors[recording.name] = factor
            max_difference_n = max(
                max_difference_n, abs(factor - 1.0) * float(np.abs(predicted_n).max())
            )
    # A light press errs more, and nobody feels it.
    if len(factors) < 2 or max_difference_n < _FELT_FORCE_FRACTION * _peak_n(data):
        return
    softest, stiffest = (pick(factors, key=factors.__getitem__) for pick in (min, max))
    if factors[stiffest] > _MAX_FORCE_RATIO * factors[softest] > 0.0:
        yield (
            f"{stiffest}: at equal motion, its force is "
            f"{factors[stiffest] / factors[softest]:.2g} times that of {softest}: "
            "if they are of one object, place, unit and zero, the passive model "
            "cannot follow it: try --model rf-fd"
        )
