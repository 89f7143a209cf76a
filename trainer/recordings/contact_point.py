"""Surface of an object: the position at which force leaves its level without contact."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Samples, runs
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import noise_n, quantisation_step, sensor_noise_n

_LOW_SHARE = 0.05  # of the travel, taken as free of contact if its force is level
_MIN_FREE_SHARE = 0.02
_OWN_AIR = 5  # samples in it: their median errs by less than the noise
_LEVEL = 0.2  # of the mean slope: more at the lowest positions is no level without contact
_RESTS, _MIDWAY = 0.02, (1 / 3, 2 / 3)  # of the way to the threshold
_RISES = 0.35  # of the threshold, midway: a force that rises from the first move on
_NOISES = 5.0
_DEVIATIONS = 2.0  # of a slope, by the noise around it
_BOUND = 4.0  # deviations, of where noise lets force pass a level
_MIN_SHARE_OF_PEAK = 0.002
_COUNTS = 1.5  # of the sensor: noise of less than one makes one, some samples in a row
_HIGHER = 3.0  # times the threshold: the slope below the surface is taken up to there
_FEWEST_SWINGS, _ONE_TONE = 4, 0.5  # of a hum, in one visit to the air; of the power there
_ABOVE = 0.25  # of its bound: a surface that is farther above all positions was not seen
_WITHOUT = "import without --contact-force and --tare if position 0 is the surface"
_STEEPEST, _NEARLY_EXPONENTIAL = 1.5, 1.01  # ratio of ways: F ~ x^2.7, and no surface at all


@dataclass(frozen=True)
class ContactPoint:
    """Surface: its position, +- what sampling, several presses and the threshold leave open.

    tare_n: force without contact; threshold_n: force above it that counts as contact.
    """

    position_m: float
    uncertainty_m: float
    tare_n: float
    threshold_n: float


@dataclass(frozen=True)
class _Press:
    """Where a press passes the levels, m, above base_n, its force without contact.

    before_m, step_m: the last sample before the first level, and how far the next one is from it.
    rest_n, midway_n: mean of so many samples of force before the tool moves, and midway to the
    first level; nan of none. falls_back: whether force returns to base_n deeper than that.
    """

    base_n: float
    passes_m: list[float]
    before_m: float
    step_m: float
    rest_n: float
    midway_n: float
    samples: int
    falls_back: bool


def find_contact(
    recording: Recording, tare_n: float | None = None, threshold_n: float | None = None
) -> ContactPoint:
    """Find the surface; tare and threshold, N, are found in the data if they are None.

    Raises DataError if the recording never leaves the object, or never reaches the threshold.
    """
    position_m, force_n = recording.position_m, recording.force_n
    low_m, travel_m = float(position_m.min()), float(np.ptp(position_m))
    air_m = low_m + _LOW_SHARE * travel_m
    free_n = force_n[position_m <= air_m]
    if travel_m == 0.0 or len(free_n) < 3:
        raise DataError(f"{recording.name}: moves too little to show where contact begins")
    base_n = float(np.median(free_n)) if tare_n is None else tare_n
    ways = [(position_m[way], force_n[way]) for way in _ways_in(position_m)]
    levels_n = [force[way <= air_m] for way, force in ways] if tare_n is None else []
    # A load cell drifts: each press that has enough air counts from its own.
    own_n = [its for its in levels_n if len(its) >= _OWN_AIR]
    deviation_n = _deviation_n(own_n or [free_n])
    bases_n = [float(np.median(its)) if len(its) >= _OWN_AIR else base_n for its in levels_n]
    level_n = threshold_n
    if level_n is None:
        least_n = _MIN_SHARE_OF_PEAK * (float(force_n.max()) - base_n)
        counts_n = _COUNTS * (quantisation_step(force_n) or 0.0)
        level_n = max(_NOISES * deviation_n, least_n, counts_n)
    if not (force_n > base_n + level_n).any():
        why = find_hum(recording) or f"is {base_n:.4g} N"
        raise DataError(
            f"{recording.name}: force never passes {level_n:.3g} N above that without contact, "
            f"which {why}: give a lower --contact-force, or {_WITHOUT}"
        )
    starts_n = bases_n or [base_n] * len(ways)
    presses = [_passes(*way, its_n, level_n) for way, its_n in zip(ways, starts_n, strict=True)]
    presses = [press for press in presses if press.passes_m]
    _require_air(recording, presses, base_n, level_n)
    met = _meets_first(presses)
    # Half a usual step; where the tool met the surface by steps that are longer, half of that one.
    step_m = max(float(np.median(np.abs(np.diff(position_m)))), met.step_m)
    doubt_m = max(step_m / 2, quantisation_step(position_m) or 0.0)
    surface_m = met.passes_m[0]
    if threshold_n is None:  # a threshold that was stated defines the surface: nothing to go back
        # A press too light for all levels, as the first of growing ones, does not show the law.
        most = max(len(press.passes_m) for press in presses)
        lawful = _meets_first([press for press in presses if len(press.passes_m) == most])
        noise = _BOUND * deviation_n / level_n
        back_m, open_m = _way_back_m(lawful.passes_m, noise, low_m)
        surface_m, doubt_m = surface_m - back_m, max(doubt_m, open_m)
        if surface_m + _ABOVE * doubt_m < low_m:
            raise DataError(f"{recording.name}: {_never_leaves(base_n)}")
    return ContactPoint(surface_m, doubt_m, base_n, level_n)


def _require_air(
    recording: Recording, presses: list[_Press], base_n: float, level_n: float
) -> None:
    """Raise DataError if force is not level before the presses: the tool is on the object."""
    position_m, force_n = recording.position_m, recording.force_n
    low_m, travel_m = float(position_m.min()), float(np.ptp(position_m))
    slope_npm = _slope_npm(position_m, force_n, low_m + _LOW_SHARE * travel_m)
    if (
        not presses
        or slope_npm > _LEVEL * (float(force_n.max()) - base_n) / travel_m
        or _rise_midway(presses, level_n, sensor_noise_n(force_n)) > _RISES
        or _meets_first(presses).before_m - low_m < 0.5 * _MIN_FREE_SHARE * travel_m
        or min(press.passes_m[0] for press in presses) - low_m < _MIN_FREE_SHARE * travel_m
    ):
        why = _never_leaves(base_n)
        if any(press.falls_back for press in presses):
            why = (
                "force rises and falls back before the object is met, as the mass of a tool makes "
                "it: pass what moves beyond the load cell, --mass-kg KG, or press more slowly"
            )
        if hum := find_hum(recording):
            why = f"force without contact {hum}: filter it out in the source, or {_WITHOUT}"
        raise DataError(f"{recording.name}: {why}")


def _never_leaves(base_n: float) -> str:
    other = "--zero first or --zero min if position 0 means nothing"
    if base_n < 0.0:
        other = "--tare=-PRELOAD_N, the force taken off, if it was zeroed under load"
    return (
        f"never leaves the object, or by too little (force is {base_n:.4g} N at its lowest "
        "position), so the surface cannot be found: record from farther above the object, or leave "
        f"--contact-force and --tare out: pass {other}"
    )


def find_hum(recording: Recording) -> str:
    """Words on force without contact that swings at one frequency; empty if it does not."""
    position_m = recording.position_m
    low = position_m <= position_m.min() + _LOW_SHARE * np.ptp(position_m)
    begin, end = max(runs(low), key=lambda run: run[1] - run[0])
    air_n = recording.force_n[begin:end] - recording.force_n[begin:end].mean()
    power = np.abs(np.fft.rfft(air_n * np.hanning(len(air_n)))) ** 2
    swings = _FEWEST_SWINGS + int(np.argmax(np.append(power[_FEWEST_SWINGS:-1], 0.0)))
    hums = power[swings - 1 : swings + 2].sum() > _ONE_TONE * power.sum()
    if len(power) <= 2 * _FEWEST_SWINGS or not hums:
        return ""
    hz = swings / (len(air_n) * recording.dt_s)
    return f"swings by +-{np.sqrt(2.0) * air_n.std():.2g} N at {hz:.3g} Hz, as hum does"


def _deviation_n(levels_n: list[Samples]) -> float:
    """Return the standard deviation of forces about the median of each level, N.

    By the median deviation, which a few samples in contact do not raise; by steps from sample to
    sample where that is less by half, as most samples of a coarse sensor have one value.
    """
    off_n = np.abs(np.concatenate([each - np.median(each) for each in levels_n]))
    deviation_n = 1.4826 * float(np.median(off_n))
    white_n = sensor_noise_n(np.concatenate(levels_n))
    return white_n if deviation_n < 0.5 * white_n else deviation_n


def _meets_first(presses: list[_Press]) -> _Press:
    """Return the press that meets the object first: one that has not recovered is met deeper.

    Between two samples far apart the first contact may be anywhere: of the presses that may be the
    first, the one with the shortest step there says where it is.
    """
    last_m = min(press.before_m + press.step_m for press in presses)
    may_be = [press for press in presses if press.before_m <= last_m]
    return min(may_be, key=lambda press: (press.step_m, press.passes_m[0]))


def _way_back_m(passes_m: list[float], noise: float, low_m: float) -> tuple[float, float]:
    """How far above the threshold's position the surface is, m, and what that leaves open, m.

    passes_m: where force passes the threshold, three and nine times it. Under F ~ (x - x_0)^n the
    ways between them are in the ratio r = 3^(1/n), and x_0 is the first way over r - 1 above the
    threshold's position (Aitken). Open is the difference from the line through the first two,
    r = 3, with what noise, a share of the threshold, moves that by. A law that is nearly
    exponential, r = 1, has no surface to find. Force that passes the threshold alone
    shows none either: it is anywhere up to low_m, the highest position above the object.
    """
    ways_m = np.maximum(np.diff(passes_m), 0.0)
    if not len(ways_m):
        return 0.0, passes_m[0] - low_m
    line_m = float(ways_m[0]) / (_HIGHER - 1.0)
    if line_m == 0.0 or len(ways_m) == 1:
        return line_m, line_m * (1.0 + noise)
    ratio = min(max(float(ways_m[1] / ways_m[0]), _NEARLY_EXPONENTIAL), _HIGHER)
    back_m = float(ways_m[0]) / (max(ratio, _STEEPEST) - 1.0)
    return back_m, max(float(ways_m[0]) / (ratio - 1.0) - line_m, line_m) + line_m * noise


def _slope_npm(position_m: Samples, force_n: Samples, below_m: float) -> float:
    """Slope of force at the lowest positions that noise cannot make, N/m: 0 off the object."""
    low = position_m <= below_m
    off_m = position_m[low] - position_m[low].mean()
    spread = float(off_m @ off_m)
    if spread == 0.0:
        return 0.0
    slope_npm = float(off_m @ force_n[low]) / spread
    return slope_npm - _DEVIATIONS * noise_n(force_n) / float(np.sqrt(spread))


def _rise_midway(presses: list[_Press], threshold_n: float, noise_n: float) -> float:
    """Share of the threshold that force surely rises midway there: 1/2 of a preload, 0 of air.

    A tool that rests on an object leaves no level: force rises with the way from the first move on.
    Each press counts from its own rest, for the object relaxes and recovers between them. Surely:
    by more than the noise, RMS, of the means, which are of a few samples each.
    """
    seen = [press for press in presses if press.samples]
    whole_n = sum(press.base_n + threshold_n - press.rest_n for press in seen)
    doubt_n = _DEVIATIONS * noise_n * float(np.sqrt(sum(2.0 / press.samples for press in seen)))
    risen_n = sum(press.midway_n - press.rest_n for press in seen) - doubt_n
    return risen_n / whole_n if whole_n > 0.0 else 0.0


def _passes(position_m: Samples, force_n: Samples, base_n: float, threshold_n: float) -> _Press:
    """Positions at which a press passes each level for good, up to the first that it does not."""
    found: list[float] = []
    before_m = step_m = 0.0
    rest_n, midway_n, samples, falls_back = np.nan, np.nan, 0, False
    for level_n in base_n + threshold_n * np.array([1.0, _HIGHER, _HIGHER**2]):
        above = force_n > level_n
        stays = above[:-2] & above[1:-1] & above[2:]  # a crossing by noise does not
        at = int(np.argmax(stays)) if stays.any() else 0
        if at == 0:
            break
        share = (level_n - force_n[at - 1]) / (force_n[at] - force_n[at - 1])
        low_m, high_m = float(position_m[at - 1]), float(position_m[at])
        if not found:
            before_m, step_m = min(low_m, high_m), abs(high_m - low_m)
            rest_n, midway_n, samples = _on_the_way(position_m[: at + 1], force_n[: at + 1])
            below = force_n[at:] < base_n + threshold_n / _HIGHER
            falls_back = bool((below[:-2] & below[1:-1] & below[2:]).any())
        found.append(low_m + float(share) * (high_m - low_m))
    return _Press(base_n, found, before_m, step_m, rest_n, midway_n, samples, falls_back)


def _on_the_way(position_m: Samples, force_n: Samples) -> tuple[float, float, int]:
    """Mean force just before the tool leaves its rest, and midway to the last sample; of how many.

    nan where no sample is midway.
    """
    way = (position_m - position_m[0]) / max(position_m[-1] - position_m[0], 1e-300)
    leaves = int(np.flatnonzero(way <= _RESTS)[-1]) + 1
    after = way[leaves:]
    midway = force_n[leaves:][(after > _MIDWAY[0]) & (after < _MIDWAY[1])]
    rest = force_n[max(0, leaves - max(len(midway), 1)) : leaves]
    midway_n = float(np.mean(midway)) if len(midway) else np.nan
    return float(np.mean(rest)), midway_n, len(midway)


def _ways_in(position_m: Samples) -> Iterator[slice]:
    """Samples of each press: from where the tool is farthest out to its last ones deep inside."""
    share = (position_m - position_m.min()) / np.ptp(position_m)
    side = np.where(share >= 0.5, 1, np.where(share <= 0.25, -1, 0))
    known = np.flatnonzero(side)
    turns = np.flatnonzero(np.diff(side[known])) + 1
    runs = np.concatenate([[0], turns, [len(known)]])
    for first, deep, last in zip(runs, runs[1:], runs[2:], strict=False):
        if side[known[deep]] > 0:
            begin, end = int(known[first]), int(known[deep])
            yield slice(begin + int(np.argmin(position_m[begin:end])), int(known[last - 1]) + 1)
