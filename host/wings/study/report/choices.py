"""Methods whose answers are right or wrong: psychometric functions and d'."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from springpot import DataError
from springpot.basics import Samples
from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.report.comparisons import Row
from springpot.host.wings.study.report.scores import condition_title
from springpot.host.wings.study.responses import Response
from springpot.host.wings.study.statistics.psychometric import PsychometricFit, fit_psychometric
from springpot.host.wings.study.statistics.sensitivity import sensitivity

EVERYBODY = "everybody"
_CHOICE = ("constant", "staircase", "quest+")
_MIN_TRIALS = 20  # of a person's own fit or d'
_FITTED = ("threshold", "low", "high", "slope", "slope_low", "slope_high", "width", "lapse",
           "guess")  # fmt: skip


@dataclass(frozen=True, eq=False)
class PsychometricCurve:
    """Answers of one series, of a person or of everybody; rising: share grows with the level.

    share: of answers for the comparison where it grows, else for the standard. fit: None, and
    why, where the answers do not carry one.
    """

    series: str
    person: str
    levels: Samples
    chosen: Samples
    trials: Samples
    rising: bool
    fit: PsychometricFit | None
    why: str = ""

    def share(self, levels: Samples) -> Samples:
        """Return the fitted share at levels of the study."""
        assert self.fit is not None
        return self.fit.share(levels if self.rising else -levels)


def psychometric_curves(study: Study, responses: Sequence[Response]) -> list[PsychometricCurve]:
    """Fit the curves of each series: everybody's, then one a person."""
    if study.method not in _CHOICE:
        return []
    found = []
    for series in dict.fromkeys(pair.series for pair in study.pair):
        own = [r for r in responses if study.pair[r.pair].series == series]
        for person in _people(own):
            found.append(_curve(study, series, person, _of(own, person)))
    return found


def psychometric_rows(curves: Sequence[PsychometricCurve]) -> list[Row]:
    """Return threshold and slope of each, in levels of the study."""
    rows = []
    for curve in curves:
        row: Row = {"stimulus": curve.series, "participant": curve.person,
                    "trials": int(curve.trials.sum())}  # fmt: skip
        values: list[float | None] = [None] * len(_FITTED)
        if (fit := curve.fit) is not None:
            sign = 1.0 if curve.rising else -1.0
            ends = sorted(sign * end for end in fit.threshold_interval)
            values = [sign * fit.threshold, *ends, fit.slope, *fit.slope_interval, fit.width,
                      fit.lapse, fit.guess]  # fmt: skip
        rows.append(row | dict(zip(_FITTED, values, strict=True)) | {"why": curve.why})
    return rows


def sensitivity_rows(study: Study, responses: Sequence[Response]) -> list[Row]:
    """Return d' of each pair of everybody, then of each person."""
    if study.method == "similarity" or study.adaptive:
        return []
    rows = []
    model = "2afc" if study.method == "constant" else study.method
    for pair, one in enumerate(study.pair):
        own = [r for r in responses if r.pair == pair]
        levels = {study.stimulus_of(name).at_level for name in (one.left, one.right)}
        if study.method == "constant" and len(levels) < 2:
            continue  # neither answer is right
        for person in _people(own):
            row: Row = {"condition": condition_title(study, pair), "participant": person}
            counts = _counts(study, _of(own, person))
            try:
                found = sensitivity(model, *counts)
            except DataError:
                continue  # not yet asked in both kinds of trials
            rows.append(row | {
                "d_prime": found.d_prime, "low": _finite(found.low), "high": _finite(found.high),
                "hit_rate": found.hit_rate, "false_alarm_rate": found.false_alarm_rate,
                "trials": found.trials,
                "correct": float(np.mean([bool(r.correct) for r in _of(own, person)])),
            })  # fmt: skip
    return rows


def _people(own: Sequence[Response]) -> list[str]:
    """Return everybody, then those who answered often enough for a figure of their own."""
    people = dict.fromkeys(r.participant for r in own)
    return [EVERYBODY, *(p for p in people if len(_of(own, p)) >= _MIN_TRIALS)] if own else []


def _of(own: Sequence[Response], person: str) -> list[Response]:
    return [r for r in own if person in (EVERYBODY, r.participant)]


def _curve(study: Study, series: str, person: str, own: Sequence[Response]) -> PsychometricCurve:
    first = study.pair[own[0].pair]
    standard = study.stimulus_of(first.left).at_level
    level = np.array([study.stimulus_of(study.pair[r.pair].right).at_level for r in own])
    slot = [0 if r.swapped else 1 for r in own]  # of the comparison
    comparison = np.array(
        [r.answer == ("left", "right")[k] for r, k in zip(own, slot, strict=True)]
    )
    rising = bool(np.any(level > standard))
    one_sided = bool(np.all(level >= standard) or np.all(level <= standard))
    chosen = comparison if rising else ~comparison
    places, which = np.unique(level, return_inverse=True)
    trials = np.bincount(which).astype(float)
    yes = np.bincount(which, chosen).astype(float)
    name = series or first.left
    try:
        guess = 0.5 if one_sided else None
        fit = fit_psychometric(places if rising else -places, yes, trials, guess)
    except DataError as error:
        return PsychometricCurve(name, person, places, yes, trials, rising, None, str(error))
    return PsychometricCurve(name, person, places, yes, trials, rising, fit)


def _counts(study: Study, own: Sequence[Response]) -> tuple[int, int, int, int]:
    """Return yes and trials of the first kind, yes and trials of the second."""
    claimed: Callable[[Response], bool]
    first: Callable[[Response], bool]
    if study.method == "abx":
        claimed, first = (lambda r: r.answer == "A"), (lambda r: r.shown[2] == r.shown[0])
    elif study.method == "same-different":
        claimed, first = (lambda r: r.answer == "different"), (lambda r: r.shown[0] != r.shown[1])
    else:
        claimed, first = (lambda r: r.answer == "left"), (lambda r: _stiffer_left(study, r))
    signal = [r for r in own if first(r)]
    noise = [r for r in own if not first(r)]
    return sum(map(claimed, signal)), len(signal), sum(map(claimed, noise)), len(noise)


def _stiffer_left(study: Study, response: Response) -> bool:
    left, right = (study.stimulus_of(name).at_level for name in response.shown[:2])
    return left > right


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
