"""Surface of an object: the position at which force leaves its level without contact."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.recording import Recording

_LOW_SHARE = 0.05  # of the travel, taken as free of contact if its force is level
_MIN_FREE_SHARE = 0.02
_LEVEL = 0.2  # of the mean slope: more at the lowest positions is no level without contact
_NOISES = 5.0
_MIN_SHARE_OF_PEAK = 0.002
_HIGHER = 3.0  # times the threshold: the slope below the surface is taken up to there
_NEARLY_EXPONENTIAL = 1.01  # ratio of ways between forces of one ratio


@dataclass(frozen=True)
class ContactPoint:
    """Surface: its position, +- what sampling, several presses and the threshold leave open.

    tare_n: force without contact; threshold_n: force above it that counts as contact.
    """

    position_m: float
    uncertainty_m: float
    tare_n: float
    threshold_n: float


def find_contact(
    recording: Recording, tare_n: float | None = None, threshold_n: float | None = None
) -> ContactPoint:
    """Find the surface; tare and threshold, N, are taken from the data where they are None.

    Raises DataError where the recording never leaves the object, or never reaches the threshold.
    """
    position_m, force_n = recording.position_m, recording.force_n
    low_m, travel_m = float(position_m.min()), float(np.ptp(position_m))
    free_n = force_n[position_m <= low_m + _LOW_SHARE * travel_m]
    if travel_m == 0.0 or len(free_n) < 3:
        raise DataError(f"{recording.name}: moves too little to show where contact begins")
    base_n = float(np.median(free_n)) if tare_n is None else tare_n
    # The median deviation, as a standard deviation: a few samples in contact do not raise it.
    noise_n = 1.4826 * float(np.median(np.abs(free_n - np.median(free_n))))
    peak_n = float(force_n.max()) - base_n
    wanted_n = threshold_n
    if threshold_n is None:
        threshold_n = max(_NOISES * noise_n, _MIN_SHARE_OF_PEAK * peak_n)
    touching = force_n > base_n + threshold_n
    if not touching.any():
        raise DataError(
            f"{recording.name}: force never passes {threshold_n:.3g} N above its {base_n:.4g} N "
            "without contact: give a lower --contact-force"
        )
    found_m = _passes(position_m, force_n, base_n + threshold_n)
    pressed = _slope_npm(position_m, force_n, low_m + _LOW_SHARE * travel_m)
    if (
        not len(found_m)
        or pressed > _LEVEL * peak_n / travel_m
        or np.median(found_m) - low_m < _MIN_FREE_SHARE * travel_m
    ):
        raise DataError(
            f"{recording.name}: never leaves the object (force is {base_n:.4g} N at its lowest "
            "position), so the surface cannot be found: import with --zero first or min"
        )
    # The median over presses, half their range, and at least half a usual step of the position.
    surface_m = float(np.median(found_m))
    doubt_m = float(np.ptp(found_m)) / 2 if len(found_m) > 1 else 0.0
    doubt_m = max(doubt_m, float(np.median(np.abs(np.diff(position_m)))) / 2)
    if wanted_n is None:
        # A threshold that was stated defines the surface: nothing to go back.
        levels_n = base_n + threshold_n * np.array([_HIGHER, _HIGHER**2])
        deeper_m = [_passes(position_m, force_n, float(level_n)) for level_n in levels_n]
        back_m, most_m = _way_back_m(surface_m, deeper_m)
        surface_m, doubt_m = surface_m - back_m, max(doubt_m, most_m)
    return ContactPoint(surface_m, doubt_m, base_n, threshold_n)


def _way_back_m(surface_m: float, deeper_m: list[Samples]) -> tuple[float, float]:
    """How far above the threshold's position the surface is, m, and how far it may be at most.

    deeper_m: where force passes three and nine times the threshold. Back along the line through
    the threshold and three times it; at most along the power law through all three,
    F ~ (x - x_0)^n: ways between the three in the ratio r = 3^(1/n) put x_0 at the first of them
    over r - 1 (Aitken). A law that is nearly exponential has no surface that could be told.
    """
    if not len(deeper_m[0]):
        return 0.0, 0.0
    first_m = max(0.0, float(np.median(deeper_m[0])) - surface_m)
    back_m = first_m / (_HIGHER - 1.0)
    if first_m == 0.0 or not len(deeper_m[1]):
        return back_m, back_m
    ratio = (float(np.median(deeper_m[1])) - surface_m - first_m) / first_m
    return back_m, first_m / (min(max(ratio, _NEARLY_EXPONENTIAL), _HIGHER) - 1.0)


def _slope_npm(position_m: Samples, force_n: Samples, below_m: float) -> float:
    """Slope of force at the lowest positions, N/m: none where nothing is touched."""
    low = position_m <= below_m
    off_m = position_m[low] - position_m[low].mean()
    spread = float(off_m @ off_m)
    return float(off_m @ force_n[low]) / spread if spread else 0.0


def _passes(position_m: Samples, force_n: Samples, level_n: float) -> Samples:
    """Positions at which force rises through a level for good, (presses,), m, interpolated."""
    above = force_n > level_n
    rises = np.flatnonzero(~above[:-1] & above[1:])
    deep_m = position_m.min() + 0.5 * np.ptp(position_m)
    found: list[float] = []
    for k, begin in enumerate(rises):
        end = rises[k + 1] if k + 1 < len(rises) else len(position_m) - 1
        # A crossing by noise does not lead half the way into the object.
        if position_m[begin : end + 1].max() < deep_m:
            continue
        share = (level_n - force_n[begin]) / (force_n[begin + 1] - force_n[begin])
        found.append(float(position_m[begin] + share * np.diff(position_m[begin : begin + 2])[0]))
    return np.array(found)
