"""Checks of each channel by itself: constant, clipped, held, coarse; its unit and its clock."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.plurals import number_of
from springpot.trainer.recordings.formats.units import CLOCK, FRAME_NAME, parts_of
from springpot.trainer.recordings.quality.finding import Finding, refusal, warning
from springpot.trainer.recordings.quality.sensors.jumps import dead_findings, wrap_findings
from springpot.trainer.recordings.quality.sensors.lost_rows import lost_findings
from springpot.trainer.recordings.quality.sign_evidence import noise_n
from springpot.trainer.recordings.recording import Recording

_CLIPPED_RUN = 5  # samples in a row exactly at the extreme
_CLIPPED_MOVE = 0.05  # of the other channel's range, meanwhile
_AVERAGED_SHARE = 8  # of such a row, one part is averaged
_NOISES = 6.0  # of that mean
_HELD_S = 0.02
_ALONE = 0.02  # of moves: those unlike the one before and the one after, of a ramp at its ends
_SAME = 1e-9  # of the range: the same value, converted or interpolated twice
_COARSE = 0.01  # quantisation step over the signal's range
_JITTER = 0.05  # of a step
# Beyond these a unit is doubted. Micrometres, millinewtons and 20 000 N load cells are real.
_CHECK_RIG = "check it against the rig"
_TRAVEL_M = (1e-6, 1.0)
_FORCE_N = (1e-5, 2e4)
_RATE_HZ = (0.05, 1e6)
_LONG_S = 3600.0  # of a test that is logged once a second
_USUAL_HZ = (5.0, 1e6)  # slower stamps may be sample numbers, read as s
_QUASI_STATIC_MPS = 1e-3  # such tests are logged slowly
_SPEED_MPS = (0.0, 3.0)
_STIFFNESS_NPM = (0.1, 1.2e6)  # cartilage has 1e6 under a tool of 8 mm


def channel_findings(recording: Recording) -> Iterator[Finding]:
    """Yield what is wrong with the channels of one recording."""
    constant = list(_constant(recording))
    yield from constant
    if constant:
        return
    yield from _units(recording)
    yield from _clipping(recording)
    yield from wrap_findings(recording)
    yield from dead_findings(recording)
    yield from _held(recording)
    yield from lost_findings(recording)
    yield from _quantisation(recording)
    yield from _clock(recording)


def quantisation_step(samples: Samples) -> float | None:
    """Smallest step between values on a grid, in the channel's unit; None without a grid.

    Values a constant speed apart, on ramps between holds, are on no sensor's grid: on one, a speed
    takes now more, now fewer of its steps.
    """
    values = np.unique(samples)
    steps = np.diff(values)
    span = float(values[-1] - values[0])
    steps = steps[steps > _SAME * span]
    if not len(steps):
        return None
    step = float(steps.min())
    off_grid = np.abs(steps / step - np.round(steps / step))
    if len(values) >= len(samples) / 2 or off_grid.max() >= 0.2:
        return None
    taken = np.round(np.diff(samples) / step)  # steps of the grid from sample to sample
    before, after = np.append(0.0, taken[:-1]), np.append(taken[1:], 0.0)
    alone = (taken != 0.0) & (taken != before) & (taken != after)
    return step if np.count_nonzero(alone) > _ALONE * np.count_nonzero(taken) else None


def _channels(recording: Recording) -> tuple[tuple[str, Samples, str], ...]:
    return (("position", recording.position_m, "m"), ("force", recording.force_n, "N"))


def _constant(recording: Recording) -> Iterator[Finding]:
    for channel, samples, unit in _channels(recording):
        if np.ptp(samples) == 0.0:
            yield refusal(
                "constant", recording.name, f"{channel} is {samples[0]:.6g} {unit} all along",
                "there is nothing to learn from it",
                "take the right column (--map), or check the sensor's cable",
            )  # fmt: skip


def _units(recording: Recording) -> Iterator[Finding]:
    """Refuse a unit that the importer read off a header; warn of one that a person stated."""
    values = {
        "position": (float(np.ptp(recording.position_m)), _TRAVEL_M, "m of travel"),
        "force": (float(np.abs(recording.force_n).max()), _FORCE_N, "N of peak force"),
        "time": (recording.rate_hz, _RATE_HZ, "samples a second"),
    }
    if all(low <= value <= high for value, (low, high), _ in values.values()):
        yield from _ratios(recording)
    stored = recording.details.get("units", {})
    for channel, (value, (low, high), what) in values.items():
        if low <= value <= high:
            continue
        metadata = stored.get(channel, {})
        guessed = bool(metadata) and metadata.get("from") not in ("map", "device")
        unit = metadata.get("unit", "")
        so_what = "its unit looks wrong" + (f" ({unit!r} was read off the file)" if guessed else "")
        to_do = _true_unit(channel, value, low, high, metadata) if guessed else _CHECK_RIG
        make = refusal if guessed else warning
        yield make("unit", recording.name, f"{value:.4g} {what}", so_what, to_do)


def _true_unit(
    channel: str, value: float, low: float, high: float, metadata: Mapping[str, Any]
) -> str:
    """How to state a unit that was read off a file: another if the header is wrong, or itself."""
    unit = str(metadata.get("unit", ""))
    form = "{}='COL:{}'" if metadata.get("from") == FRAME_NAME else "--map {}=COL:{}"
    right = f"state it if it is right: {form.format(channel, unit)}"
    # A unit of time that is longer makes a lower rate.
    by_time = -1 if channel == "time" else 1
    factors = (by for by in (1e-3, 1e3, 1e-6, 1e6) if low <= by**by_time * value <= high)
    factor = next(factors, None)
    if factor is None or unit == CLOCK:
        return right
    before, symbol = parts_of(unit)
    other = form.format(channel, f"{before * factor:g}{symbol}")
    return f"if the header is wrong, state what its numbers count: {other}; {right}"


def _ratios(recording: Recording) -> Iterator[Finding]:
    """Warn of units that are possible each by itself, and seldom together."""
    steps_m = np.abs(np.diff(recording.position_m))
    speed_mps = float(np.quantile(steps_m, 0.99)) / recording.dt_s
    stiffness_npm = float(np.ptp(recording.force_n)) / float(np.ptp(recording.position_m))
    # Sample numbers and milliseconds are whole numbers, slow logs have digits behind the point;
    # what was never printed, 0, shows neither.
    # Digits that are all 0 (1.000, 2.000) are printed by a format: over hours it is doubted too.
    sampling = recording.details.get("sampling", {})
    whole = sampling.get("longest_step_s") == sampling.get("shortest_step_s") == 1.0
    long = recording.dt_s * len(recording.position_m) > _LONG_S
    numbered = not 0.0 < sampling.get("stamp_digit_s", 0.0) < 1.0 or (whole and long)
    slow = speed_mps < _QUASI_STATIC_MPS and not numbered
    stored = recording.details.get("units", {})
    clocked = stored.get("time", {}).get("from") == CLOCK
    meant = slow or clocked or "resampled_hz" in recording.details
    for value, (low, high), what, units in (
        (_USUAL_HZ[0] if meant else recording.rate_hz, _USUAL_HZ, "samples a second", "time"),
        (speed_mps, _SPEED_MPS, "m/s of pressing", "position or time"),
        (stiffness_npm, _STIFFNESS_NPM, "N/m of stiffness", "position or force"),
    ):
        if not low <= value <= high:
            stated = all(stored.get(one, {}).get("from") == "map" for one in units.split(" or "))
            yield warning(
                "unit", recording.name, f"{value:.4g} {what}", f"the unit of {units} looks wrong",
                "check it against the rig" + ("" if stated else ", and state it on import (--map)"),
            )  # fmt: skip


def _clipping(recording: Recording) -> Iterator[Finding]:
    """Find a flat extreme of one channel while the other goes on."""
    position, force = _channels(recording)
    for (channel, samples, unit), (_, other, _) in ((force, position), (position, force)):
        for extreme, side in ((samples.max(), "maximum"), (samples.min(), "minimum")):
            if side == "minimum" and extreme >= 0.0:
                continue  # out of contact, or at rest
            moved, longest = 0.0, 0
            or_air = ("", "")
            if channel == "force" and side == "minimum":  # of a coarse sensor the air is one value
                or_air = (
                    ", or the tool is in the air and force was zeroed under load",
                    f"; in the air, import with --tare={extreme:.6g}",
                )
            for begin, end in _runs(samples == extreme):
                if end - begin < _CLIPPED_RUN:
                    continue
                longest = max(longest, end - begin)
                moved = max(moved, _excursion(other[begin:end], channel))
            if moved > _CLIPPED_MOVE * np.ptp(other):
                yield warning(
                    "clipping", recording.name,
                    f"{channel} stays at its {side} value, {extreme:.6g} {unit}, for up to "
                    f"{longest * recording.dt_s:.3g} s while the other channel moves on",
                    "the sensor's limit is recorded in place of the object" + or_air[0],
                    "record again with less amplitude or a larger sensor" + or_air[1],
                )  # fmt: skip


def _excursion(other: Samples, channel: str) -> float:
    """Distance that the other channel goes within a run.

    A held position lets force relax one way; only a force that rises and falls shows clipping.
    Noise does so too: of so many samples in a row the mean is taken.
    """
    if channel == "force":
        return float(np.ptp(other))
    averaged = max(1, len(other) // _AVERAGED_SHARE)
    noise = noise_n(other)
    other = np.convolve(other, np.full(averaged, 1.0 / averaged), "valid")
    ends = float(max(other[0], other[-1])), float(min(other[0], other[-1]))
    by_noise = _NOISES * noise / float(np.sqrt(averaged))
    return max(float(other.max()) - ends[0], ends[1] - float(other.min())) - by_noise


def _held(recording: Recording) -> Iterator[Finding]:
    """Find both channels standing still exactly, and then catching up."""
    same = (np.diff(recording.position_m) == 0.0) & (np.diff(recording.force_n) == 0.0)
    # Coarse channels repeat values at low speed, with no sample lost.
    for samples in (recording.position_m, recording.force_n):
        if quantisation_step(samples) is not None:
            return
    minimum = max(3, round(_HELD_S / recording.dt_s))
    runs = [(begin, end) for begin, end in _runs(same) if end - begin >= minimum]
    inner = [run for run in runs if _catches_up(recording.position_m, *run)]
    if inner:
        begin, end = max(inner, key=lambda run: run[1] - run[0])
        yield warning(
            "gap", recording.name,
            f"both channels stand still {number_of(len(inner), 'time')}, longest {end - begin} "
            f"samples at {begin * recording.dt_s:.3f} s",
            "lost samples were filled by the last one",
            "cut there, or record again with less load on the computer",
        )  # fmt: skip


def _catches_up(position_m: Samples, begin: int, end: int) -> bool:
    """Whether the position jumps after a rest by what it would have moved meanwhile."""
    steps = np.abs(np.diff(position_m))
    around = np.concatenate((steps[max(0, begin - 20) : begin], steps[end + 1 : end + 21]))
    if begin == 0 or end >= len(steps) or not len(around):
        return False
    usual, least = float(np.median(around)), _SAME * float(np.ptp(position_m))
    return usual > least and float(steps[end]) > 0.5 * (end - begin + 1) * usual


def _quantisation(recording: Recording) -> Iterator[Finding]:
    for channel, samples, unit in _channels(recording):
        step = quantisation_step(samples)
        share = step / float(np.ptp(samples)) if step else 0.0
        if step and share > _COARSE:
            yield warning(
                "quantisation", recording.name,
                f"{channel} has steps of {step:.3g} {unit}, {100 * share:.2g} % of its range",
                f"no model can be better than about {step / np.sqrt(12):.2g} {unit} in it",
                "use a finer sensor or range, or more amplitude",
            )  # fmt: skip


def _clock(recording: Recording) -> Iterator[Finding]:
    sampling = recording.details.get("sampling", {})
    jitter_s = float(sampling.get("jitter_rms_s", 0.0))
    rounding_s = float(sampling.get("stamp_digit_s", 0.0))
    if jitter_s > _JITTER * recording.dt_s + rounding_s:
        yield warning(
            "jitter", recording.name,
            f"time steps vary by {jitter_s:.3g} s rms about {recording.dt_s:.3g} s",
            "samples were moved by interpolation, fast changes are blurred",
            "record with a hardware clock",
        )  # fmt: skip
    tail = sampling.get("tail")
    if tail:
        rows = number_of(tail["rows"], "row")
        yield warning(
            "jitter", recording.name,
            f"the end, {rows} from row {tail['from_row']} on, is out of step",
            "it was interpolated onto the steps before it",
            "cut it off in the source to do without",
        )  # fmt: skip


def _runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Begin and end (exclusive) of each run of true."""
    edges = np.diff(np.concatenate(([0], flags.astype(np.int8), [0])))
    return list(zip(*(np.flatnonzero(edges == e).tolist() for e in (1, -1)), strict=True))
