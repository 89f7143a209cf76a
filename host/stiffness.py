"""Error of the stiffness along presses: a hand judges how force grows, not force alone."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.types import JsonObject
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import turning_points

STIFFNESS_JND = 0.15  # just noticeable difference, of the stiffness: about so much
_TURN = 0.1  # of the range of positions: what turns by less is one way in
_WINDOWS = (16, 8, 4, 2)  # of a way in: as many as noise allows
_KNOWN = 0.03  # median standard error of the measured slopes, of the slope
_UNKNOWN, _FLAT = 0.1, 0.05  # standard error of a slope, and share of the greatest: not counted
_FEWEST = 8  # samples of a window
_QUADRATIC = 3  # numbers of a parabola


@dataclass(frozen=True)
class SlopeErrors:
    """Error of dF/dx on the way in, percent of the measured slope, over windows of the depth.

    windows: so many. floor_percent: median standard error of the measured slopes themselves.
    """

    windows: int
    median_percent: float
    p95_percent: float
    floor_percent: float


@dataclass(frozen=True)
class _Slope:
    measured_npm: float
    error_npm: float  # standard error of that
    predicted_npm: float


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
    found = [
        slope
        for recording, force_n, ramp in zip(recordings, predicted_n, ramps, strict=True)
        for way in _ways_in(recording.position_m)
        if way.stop - ramp > _FEWEST
        for slope in _known_slopes(recording, force_n, slice(max(way.start, ramp), way.stop))
    ]
    if not found:
        return None
    measured, known, predicted = np.transpose([
        (slope.measured_npm, slope.error_npm, slope.predicted_npm) for slope in found
    ])  # fmt: skip
    percent = 100.0 * np.abs(predicted - measured) / measured
    return SlopeErrors(
        windows=len(found),
        median_percent=float(np.median(percent)),
        p95_percent=float(np.percentile(percent, 95)),
        floor_percent=float(np.median(100.0 * known / measured)),
    )


def slope_keys(found: SlopeErrors | None) -> JsonObject:
    """JSON keys: median and 95 % quantile of the error, its floor; null if no slope is known."""
    return {
        "slope_error_median_percent": None if found is None else found.median_percent,
        "slope_error_p95_percent": None if found is None else found.p95_percent,
        "slope_floor_percent": None if found is None else found.floor_percent,
    }


def slope_words(keys: JsonObject) -> str:
    """The same in a person's words; keys: of `slope_keys`."""
    if keys["slope_error_median_percent"] is None:
        return "not known: no way in on which the measured slope stands out from noise"
    return (
        f"median {keys['slope_error_median_percent']:.2g} %, 95 % below "
        f"{keys['slope_error_p95_percent']:.2g} % (a hand can tell {100 * STIFFNESS_JND:g} %; "
        f"measured to {keys['slope_floor_percent']:.2g} %)"
    )


def _ways_in(position_m: Samples) -> Iterator[slice]:
    """Samples of each way from a turn to a deeper one."""
    turns = turning_points(position_m, _TURN * float(np.ptp(position_m)))
    for begin, end in pairwise(turns):
        if position_m[end] > position_m[begin]:
            yield slice(begin, end + 1)


def _known_slopes(recording: Recording, predicted_n: Samples, way: slice) -> list[_Slope]:
    depth_m, force_n = recording.position_m[way], recording.force_n[way]
    for windows in _WINDOWS:
        slopes = list(_slopes(depth_m, force_n, predicted_n[way], windows))
        steepest = max((slope.measured_npm for slope in slopes), default=0.0)
        slopes = [slope for slope in slopes if slope.measured_npm > _FLAT * steepest]
        shares = [slope.error_npm / slope.measured_npm for slope in slopes]
        if shares and np.median(shares) <= _KNOWN:
            pairs = zip(slopes, shares, strict=True)
            return [slope for slope, share in pairs if share <= _UNKNOWN]
    return []


def _slopes(
    depth_m: Samples, force_n: Samples, predicted_n: Samples, windows: int
) -> Iterator[_Slope]:
    edges_m = np.linspace(depth_m[0], depth_m[-1], windows + 1)
    number = np.clip(np.searchsorted(edges_m, depth_m, side="right") - 1, 0, windows - 1)
    for window in range(windows):
        rows = np.flatnonzero(number == window)
        if len(rows) < _FEWEST or np.ptp(depth_m[rows]) <= 0.5 * (edges_m[1] - edges_m[0]):
            continue
        u = (depth_m[rows] - depth_m[rows].mean()) / (edges_m[1] - edges_m[0])
        powers = np.stack([np.ones_like(u), u, u * u], axis=1)
        inverse = np.linalg.pinv(powers.T @ powers)
        both = inverse @ powers.T @ np.stack([force_n[rows], predicted_n[rows]], axis=1)
        left_n = force_n[rows] - powers @ both[:, 0]
        variance = float(left_n @ left_n) / (len(rows) - _QUADRATIC) * float(inverse[1, 1])
        per_m = 1.0 / float(edges_m[1] - edges_m[0])
        yield _Slope(both[1, 0] * per_m, float(np.sqrt(variance)) * per_m, both[1, 1] * per_m)
