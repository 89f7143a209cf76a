"""Force of a model along positions as its C gives it: no pull where the object has a surface."""

from collections.abc import Sequence

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.model.model import Model
from springpot.trainer.models.predict import predict_each_n
from springpot.trainer.recordings.places import Site, site_words
from springpot.trainer.recordings.recording import Recording

_DEEP = 1.5  # times the trained depth: from here on it is said
_TOO_DEEP = 10.0  # and from here on refused: no extrapolation, but another unit


def limited_n(model: Model, recording: Recording) -> Samples:
    """Force along a recording's positions, (n,), N, float64, at least 0 where there is a surface.

    Raises DataError for positions ten times deeper than any training press.
    """
    return limited_each_n(model, [recording])[0]


def limited_each_n(model: Model, recordings: Sequence[Recording]) -> list[Samples]:
    """The same of several recordings, those of one session one after another.

    Raises DataError as `limited_n`.
    """
    for recording in recordings:
        _require_metres(model, recording)
    if not recordings:
        return []
    pieces = [(each, np.arange(len(each.position_m))) for each in recordings]
    force_n = predict_each_n(model, pieces)
    given_n = np.maximum(force_n, 0.0) if model.contact == "surface" else force_n
    return np.split(given_n, np.cumsum([len(rows) for _, rows in pieces])[:-1])


def _require_metres(model: Model, recording: Recording) -> None:
    times = times_trained(model, recording)
    if times > _TOO_DEEP:
        deepest = float(np.max(np.abs(recording.position_m)))
        raise DataError(
            f"{recording.name}: position goes to {deepest:.4g} m, {times:.3g} times the trained "
            f"{_span_m(model):.4g} m: give positions in metres, or correct the unit on import"
        )


def extrapolation(model: Model, recording: Recording) -> str:
    """Say that positions go farther beyond the training presses than their force is known."""
    times = times_trained(model, recording)
    if times <= _DEEP:
        return ""
    return (
        f"{recording.name}: goes to {times:.3g} times the trained depth: there the force is an "
        "extrapolation"
    )


def unplaced(model: Model, recording: Recording) -> str:
    """Say which place a recording without one is given of a map: forces differ from place to place.

    "" where the recording has a place, or the model no map.
    """
    passive = model.hammerstein
    if passive is None or passive.places is None or recording.place_m is not None:
        return ""
    return f"{recording.name}: has no place: {stiffest_words(passive.places.stiffest_m)}"


def stiffest_words(stiffest_m: Site) -> str:
    """Say what a map renders where nobody chose a place."""
    return (
        f"the force is that of the map's stiffest place, {site_words(stiffest_m)}: give place_m, "
        "or a recording that has its place"
    )


def times_trained(model: Model, recording: Recording) -> float:
    """Compare how far a recording goes with the training presses: 1 is as far as they went.

    Above a surface is air, where every height gives 0 N; without one, either way counts.
    """
    trained = model.trained
    beyond_m = float(np.max(recording.position_m)) - trained.max_m
    if model.contact == "always":
        beyond_m = max(beyond_m, trained.min_m - float(np.min(recording.position_m)))
    return 1.0 + max(beyond_m, 0.0) / _span_m(model)


def _span_m(model: Model) -> float:
    above_m = model.trained.min_m if model.contact == "always" else 0.0
    return model.trained.max_m - above_m
