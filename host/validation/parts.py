"""Errors of a validation in parts: by place on the object, and of slides.

Of a slide they are along the depth and sideways, beside the work done.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples, rms
from springpot.codegen.errors import DataError
from springpot.codegen.plan.plan import Plan
from springpot.codegen.plurals import number_of
from springpot.host.metrics import accuracy
from springpot.trainer.models.folds import geometric_mean
from springpot.trainer.recordings.quality.places import site_words, sites_of
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.slides import lateral_of, require_path, slide_path

_ALONG = (-1.0, -1.0, 1.0)  # a hand puts in work against x and y, and along the depth
_PRESSED = 0.1  # of the peak force: below it the ratio of two forces is of noise
_MOVING = 0.2  # of the fastest way sideways in a sample: slower, the tip may stick


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


@dataclass(frozen=True)
class SlideError:
    """Error of the C on one slide, behind its start-up ramp.

    rmse_percent_of_peak: of the force along the depth. lateral_rmse_n, lateral_rms_n: of the error
    of the force along x and y, and of that force. correlation: of measured and rendered lateral
    force. friction: the coefficient with which the C would have the drag of the object in the
    median. work_j, c_work_j: what the hand put in from the first sample to the last, against the
    measured force and against that of the C. None if the lateral force was not measured; without a
    correlation it is constant, without a friction the tip never moves while it presses.
    """

    name: str
    rmse_percent_of_peak: float
    lateral_rmse_n: float | None = None
    lateral_rms_n: float | None = None
    correlation: float | None = None
    friction: float | None = None
    work_j: float | None = None
    c_work_j: float | None = None


def require_slides(plan: Plan, recording: Recording) -> None:
    """Raise DataError if the C of the scene cannot slide, or nothing was felt on the way."""
    if plan.lateral is None:
        raise DataError(
            f"{recording.name}: slides, and this scene does not: emit it with [places] mode = "
            '"lateral", or leave this recording out'
        )
    require_path(recording)
    if not recording.force_n.any():
        raise DataError(f"{recording.name}: its force is 0 everywhere: leave this recording out")


def slide_error(recording: Recording, force_n: Samples, ramped: int, friction: float) -> SlideError:
    """Compare a slide with forces of the C at its samples, (n, 3), N.

    ramped: samples in the start-up ramp, which are left out. friction: of the scene.
    """
    measured_n, found_n = recording.force_n[ramped:], force_n[ramped:]
    peak_n = float(np.abs(recording.force_n).max())
    percent = 100.0 * rms(found_n[:, 2] - measured_n) / peak_n
    lateral_n = lateral_of(recording)
    if lateral_n is None:
        return SlideError(recording.name, percent)
    lateral_n, path_m = lateral_n[ramped:], slide_path(recording)[ramped:]
    return SlideError(
        recording.name,
        percent,
        rms(found_n[:, :2] - lateral_n),
        rms(lateral_n),
        _correlation(lateral_n.ravel(), found_n[:, :2].ravel()),
        _friction(path_m, lateral_n - found_n[:, :2], measured_n, friction),
        _work_j(path_m, np.column_stack([lateral_n, measured_n])),
        _work_j(path_m, found_n),
    )


def slide_line(errors: Sequence[SlideError]) -> str:
    """Errors of all slides, for people; empty without slides."""
    if not errors:
        return ""
    worst = max(errors, key=lambda error: error.rmse_percent_of_peak)
    line = f"{number_of(len(errors), 'slide')}: along the depth "
    line += f"{worst.rmse_percent_of_peak:.3g} % of peak"
    line += f" ({worst.name})" if len(errors) == 1 else f" at worst ({worst.name})"
    sideways = [e for e in errors if e.lateral_rms_n]
    if sideways:
        share = max(100.0 * (e.lateral_rmse_n or 0.0) / (e.lateral_rms_n or 1.0) for e in sideways)
        line += f"; sideways {share:.3g} % of the force's rms"
    if correlations := [e.correlation for e in errors if e.correlation is not None]:
        line += f", correlation {min(correlations):.2f}"
    if frictions := [e.friction for e in errors if e.friction is not None]:
        line += f"; their drag is that of places.friction = {np.median(frictions):.2g}"
    return line.replace("1 slides", "1 slide", 1) if len(errors) == 1 else line


def _correlation(one: Samples, other: Samples) -> float | None:
    if min(one.std(), other.std()) == 0.0:
        return None
    return float(np.corrcoef(one, other)[0, 1])


def _friction(
    path_m: Samples, missing_n: Samples, normal_n: Samples, friction: float
) -> float | None:
    """Add the median of the missing drag over the normal force, where the tip moves (Coulomb)."""
    way_m = np.diff(path_m[:, :2], axis=0, append=path_m[-1:, :2])
    length_m = np.hypot(*way_m.T)
    pressed = normal_n > _PRESSED * normal_n.max()
    moves = pressed & (length_m > _MOVING * length_m.max())
    if not moves.any():
        return None
    drag_n = -np.sum(missing_n[moves] * way_m[moves], axis=1) / length_m[moves]
    return max(0.0, friction + float(np.median(drag_n / normal_n[moves])))


def _work_j(path_m: Samples, force_n: NDArray[np.floating]) -> float:
    """Trapezoids of force over the way, along all three axes."""
    mean_n = 0.5 * (force_n[1:] + force_n[:-1]) * _ALONG
    return float(np.sum(mean_n * np.diff(path_m, axis=0)))
