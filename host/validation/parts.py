"""Errors of a validation by place on the object."""

from collections.abc import Sequence
from dataclasses import dataclass

from springpot.codegen.arrays import Samples
from springpot.host.metrics import accuracy
from springpot.trainer.models.folds import geometric_mean
from springpot.trainer.recordings.recording import Recording, site_words, sites_of


@dataclass(frozen=True)
class PlaceError:
    """Error of the C on the recordings of one place."""

    place_m: tuple[float, float]
    recordings: int
    rmse_n: float
    rmse_percent_of_peak: float


def place_errors(
    recordings: Sequence[Recording], predicted_n: Sequence[Samples], ramped: Sequence[int]
) -> tuple[PlaceError, ...]:
    """Error of each place in the order of recording; none for recordings without places.

    predicted_n: forces of the C along each, (n,), N; ramped: samples of each in the start-up ramp.
    """
    found = []
    for place_m, numbers in sites_of(recordings).items():
        its = accuracy(
            [recordings[k].force_n for k in numbers],
            [predicted_n[k] for k in numbers],
            [ramped[k] for k in numbers],
        )
        found.append(PlaceError(place_m, len(numbers), its.rmse_n, its.rmse_percent_of_peak))
    return tuple(found)


def place_line(errors: Sequence[PlaceError]) -> str:
    """Geometric mean and the worst place, for people; empty for fewer than two places."""
    if len(errors) < 2:
        return ""
    percents = [error.rmse_percent_of_peak for error in errors]
    worst = max(errors, key=lambda error: error.rmse_percent_of_peak)
    return (
        f"{len(errors)} places: {geometric_mean(percents):.3g} % of peak in geometric mean, worst "
        f"{worst.rmse_percent_of_peak:.3g} % at {site_words(worst.place_m)}"
    )
