"""Faults of a channel: constant, clipped, stuck, gone, filled, coarse, or wrapped."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from springpot.codegen.arrays import Samples, runs
from springpot.codegen.messages import counted_noun
from springpot.trainer.recordings.quality.finding import Finding, refusal, warning
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import (
    quantisation_step,
    sensor_noise_n,
    turning_points,
)

CLIPPED_KEY = "clipping"  # of a recording's details: findings before a line was taken off
_MIN_FLAT_SAMPLES, _MIN_OTHER_FRACTION = (
    5,
    0.05,
)  # samples at the extreme; of the other channel's range
_AIR_FRACTION = 0.1  # of the travel, taken as free of contact
_STUCK_FORCE_FRACTION, _STUCK_TRAVEL_FRACTION = (
    0.05,
    0.3,
)  # of the force's range, off its level without contact; of the travel
_LOST_FORCE_FRACTION, _DROP_RATIO = (
    0.02,
    5.0,
)  # of the largest force: none is left; times that, just before
_NOISE_SIGMAS, _MEDIAN_REACH = 4.0, 2  # of the noise; samples to each side in a running median
_MAX_NOISE_FRACTION = 0.1  # of the largest force: such noise hides whether any is left
_CONTACT_TRAVEL_FRACTION, _DEEP_TRAVEL_FRACTION = (
    0.5,
    0.7,
)  # of the travel: in contact, wherever the surface is
_MAX_BEND_FRACTION = 2e-3  # of the travel: a motion that is bent by less goes on
# Of the travel, in one sample: an object that has relaxed lets go of a tool that leaves so fast.
_LET_GO_FRACTION = 0.02
_MAX_SLOWDOWN = 4.0  # times the samples of a way in that meets force
_RUNS_PER_AVERAGE = 8  # of such a row, one part is averaged
_CLIPPED_SIGMAS = 6.0  # of that mean
_MIN_FILLED_S = 0.02
_ZERO_STEP_FRACTION = 1e-9  # of the travel: a step that is none
_MAX_STEP_FRACTION = 0.01  # quantisation step over the signal's range
_JUMP_RANGE_FRACTION, _JUMP_STEP_RATIO = 0.4, 4.0  # of the range; times the usual step: a jump
_NEIGHBOUR_SAMPLES = 5  # samples, over which a channel moves against its jump
_MIN_WRAP_FRACTION = 0.8  # of the jumps
_RETURN_FRACTION = 0.1  # of the other channel's range: it is back where it began
_MAX_OTHER_FRACTION = 0.2  # of the other channel's range, meanwhile


def channel_findings(recording: Recording) -> Iterator[Finding]:
    """Yield what is wrong with the channels of one recording; a constant one alone."""
    channels = (
        ("position", recording.position_m, recording.force_n, 1e3, "mm"),
        ("force", recording.force_n, recording.position_m, 1.0, "N"),
    )
    constant = [channel for channel in channels if np.ptp(channel[1]) == 0.0]
    for channel, samples, _, scale, unit in constant:
        yield refusal(
            "constant", recording.name, f"{channel} is {scale * samples[0]:.6g} {unit} all along",
            "there is nothing to learn from it",
            "take the right column (--map), or check the sensor's cable",
        )  # fmt: skip
    if constant:
        return
    steps = []
    yield from (Finding(**known) for known in find_clipping(recording))
    for channel, samples, other, scale, unit in channels:
        if wraps := _find_wraps(samples, other):
            yield refusal(
                "wrap", recording.name,
                f"{channel} jumps {len(wraps)} times by {scale * float(np.ptp(samples)):.3g} "
                f"{unit} against its own motion, first at {wraps[0] * recording.dt_s:.3f} s",
                "a counter or a converter wraps there, or samples are spikes",
                "unwrap it in the source (numpy.unwrap), or cut them out",
            )  # fmt: skip
        if step := quantisation_step(samples):
            steps.append(step)
            if (share := step / float(np.ptp(samples))) > _MAX_STEP_FRACTION:
                yield warning(
                    "quantisation", recording.name,
                    f"{channel} has steps of {scale * step:.3g} {unit}, {100 * share:.2g} % of "
                    "its range",
                    f"no model can be better than about {scale * step / np.sqrt(12):.2g} {unit}",
                    "use a finer sensor or range, or more amplitude",
                )  # fmt: skip
    yield from _stuck_findings(recording)
    yield from _stuck_position_findings(recording)
    yield from _fall_findings(recording)
    yield from _force_loss_findings(recording)
    filled = _find_filled_runs(recording) if not steps else []  # coarse channels repeat values
    if filled:
        begin, end = max(filled, key=lambda run: run[1] - run[0])
        yield warning(
            "gap", recording.name,
            f"both channels stand still {counted_noun(len(filled), 'time')}, longest {end - begin} "
            f"samples at {begin * recording.dt_s:.3f} s",
            "lost samples were filled by the last one",
            "cut there, or record again with less load on the computer",
        )  # fmt: skip


@dataclass(frozen=True)
class LevelRule:
    """When force without contact jumps between two levels, as a sign bit or a loose plug makes it.

    gap_fraction: of the range of force: how far apart; gap_ratio: times the spread of each level.
    least_share: of the samples in the air, on each; spikes are fewer. changes: from one to the
    other in a visit, in the mean: a surface that lets go changes once.
    """

    gap_fraction: float = 0.1
    gap_ratio: float = 3.0
    least_share: float = 0.15
    changes: float = 4.0


_LEVELS = LevelRule()


def level_findings(recording: Recording) -> Iterator[Finding]:
    """Find a force that takes two levels in turn where nothing is touched; before any repair."""
    position_m, force_n = recording.position_m, recording.force_n
    in_air = position_m <= position_m.min() + _AIR_FRACTION * float(np.ptp(position_m))
    air_n = np.sort(force_n[in_air])
    least = max(_MIN_FLAT_SAMPLES, int(_LEVELS.least_share * len(air_n)))
    gaps = np.diff(air_n)[least - 1 : len(air_n) - least]
    if not len(gaps):
        return
    last_low = least - 1 + int(np.argmax(gaps))
    low_n, high_n = air_n[: last_low + 1], air_n[last_low + 1 :]
    spread_n = max(float(np.ptp(np.quantile(level, (0.05, 0.95)))) for level in (low_n, high_n))
    is_high = force_n > 0.5 * (low_n[-1] + high_n[0])
    visits = runs(in_air)
    changes = sum(int(np.count_nonzero(np.diff(is_high[a:b]))) for a, b in visits)
    if gaps.max() > max(
        _LEVELS.gap_fraction * float(np.ptp(force_n)), _LEVELS.gap_ratio * spread_n
    ) and changes >= _LEVELS.changes * len(visits):
        yield refusal(
            "levels", recording.name,
            f"force takes two levels in the air, {np.median(low_n):.3g} and "
            f"{np.median(high_n):.3g} N, and changes {changes} times between them",
            "a converter's sign is read wrong, or a plug is loose, and no object does so",
            "correct the sign in the source, or check the sensor's cable",
        )  # fmt: skip


def find_clipping(recording: Recording) -> list[dict[str, Any]]:
    """Return the fields of findings: of clipped channels, or those that a correction has kept."""
    if CLIPPED_KEY in recording.details:
        return list(recording.details[CLIPPED_KEY])
    position_m, force_n = recording.position_m, recording.force_n
    findings = [*_clipping_findings(recording, "position", position_m, force_n)]
    findings += _clipping_findings(recording, "force", force_n, position_m)
    return [asdict(finding) for finding in findings]


def _clipping_findings(
    recording: Recording, channel: str, samples: Samples, other: Samples
) -> Iterator[Finding]:
    """Find a flat extreme of one channel while the other goes on."""
    for extreme, side in ((samples.max(), "maximum"), (samples.min(), "minimum")):
        flat = [run for run in runs(samples == extreme) if run[1] - run[0] >= _MIN_FLAT_SAMPLES]
        outside = channel == "force" and abs(extreme - _air_force_n(recording)) < (
            _LOST_FORCE_FRACTION * float(np.ptp(samples))
        )
        if not flat or outside or (side == "minimum" and extreme >= 0.0):
            continue  # out of contact, or at rest
        moved = max(_excursion(other[begin:end], channel) for begin, end in flat)
        longest_s = max(end - begin for begin, end in flat) * recording.dt_s
        if moved > _MIN_OTHER_FRACTION * np.ptp(other):
            yield warning(
                "clipping", recording.name,
                f"{channel} stays at its {side} for up to {longest_s:.3g} s while the other "
                "channel moves on",
                "the sensor's limit is recorded in place of the object",
                "record again with less amplitude or a larger sensor",
            )  # fmt: skip


def _air_force_n(recording: Recording) -> float:
    """Force at the lowest positions, N."""
    position_m = recording.position_m
    free_m = float(position_m.min()) + _AIR_FRACTION * float(np.ptp(position_m))
    return float(np.median(recording.force_n[position_m <= free_m]))


def _stuck_findings(recording: Recording) -> Iterator[Finding]:
    """Find a force that stands still in contact while the tool moves through the object."""
    position_m, force_n = recording.position_m, recording.force_n
    travel_m, range_n = float(np.ptp(position_m)), float(np.ptp(force_n))
    free_n = _air_force_n(recording)
    for begin, end in runs(np.diff(force_n) == 0.0):
        moved_m = float(np.ptp(position_m[begin : end + 1]))
        in_contact = abs(force_n[begin] - free_n) > _STUCK_FORCE_FRACTION * range_n
        inside = force_n.min() < force_n[begin] < force_n.max()  # at its limits it is clipped
        if (
            end - begin >= _MIN_FLAT_SAMPLES
            and in_contact
            and inside
            and moved_m > _STUCK_TRAVEL_FRACTION * travel_m
        ):
            yield warning(
                "stuck", recording.name,
                f"force stands still at {force_n[begin]:.4g} N for "
                f"{(end - begin) * recording.dt_s:.3g} s from {begin * recording.dt_s:.4g} s on, "
                f"while the tool moves by {1e3 * moved_m:.3g} mm",
                "no sample of the sensor came through", "cut the recording there",
            )  # fmt: skip
            return


@dataclass(frozen=True)
class StuckPositionRule:
    """When the position of a sensor or a log stands still, though the tool does not.

    Of 676 right recordings none holds still to the last bit, and is then elsewhere by one step.

    steps: at least so many without change. step_ratio, beside: times the largest of so many steps
    before and behind is the one that ends the hold. step_fraction: of the travel, at least.
    force_fraction: of its range, by which force goes on meanwhile.
    """

    steps: int = 3
    step_ratio: float = 4.0
    beside: int = 5
    step_fraction: float = 0.01
    force_fraction: float = 0.03


@dataclass(frozen=True)
class FallRule:
    """When force falls on the way in, as no law of springs, dashpots and friction lets it.

    bins: of a stroke's way, of min_rows samples at least. stroke_fraction: of the travel: shorter
    strokes are not looked at. fall_fraction: of the range of force, noise_sigmas: of the noise of
    a bin's mean, by which it falls. pace_fraction: of the samples in a bin: a tool that slows down
    more before it turns lets any object relax, and one that speeds up moves a mass.
    """

    bins: int = 16
    min_rows: int = 8
    stroke_fraction: float = 0.3
    fall_fraction: float = 0.1
    noise_sigmas: float = 8.0
    pace_fraction: float = 0.15


_STUCK, _FALL = StuckPositionRule(), FallRule()


def _stuck_position_findings(recording: Recording) -> Iterator[Finding]:
    """Find holds of the position during which force goes on, and that end by one step."""
    position_m, force_n = recording.position_m, recording.force_n
    steps_m, held = np.abs(np.diff(position_m)), []
    for begin, end in runs(steps_m == 0.0):
        before_m = steps_m[max(0, begin - _STUCK.beside) : begin]
        after_m = steps_m[end + 1 : end + 1 + _STUCK.beside]
        if end - begin < _STUCK.steps or not len(before_m) or not len(after_m):
            continue
        usual_m = max(before_m.max(), after_m.max())
        least_m = max(_STUCK.step_ratio * usual_m, _STUCK.step_fraction * float(np.ptp(position_m)))
        swing_n = float(np.ptp(force_n[begin : end + 1]))
        if steps_m[end] > least_m and swing_n > _STUCK.force_fraction * float(np.ptp(force_n)):
            held.append((begin, end))
    if held:
        begin, end = held[0]
        yield warning(
            "stuck", recording.name,
            f"position stands still {counted_noun(len(held), 'time')} while force goes on, first "
            f"for {(end - begin) * recording.dt_s:.3g} s at {begin * recording.dt_s:.4g} s, and "
            f"then jumps by {1e3 * steps_m[end]:.3g} mm",
            "force belongs to another depth there", "cut the recording there, or record again",
        )  # fmt: skip


def _fall_findings(recording: Recording) -> Iterator[Finding]:
    """Find a force that falls on the way in, while the tool goes on as fast as before."""
    position_m, force_n = recording.position_m, recording.force_n
    travel_m, least_n = float(np.ptp(position_m)), _FALL.fall_fraction * float(np.ptp(force_n))
    noise_n = _FALL.noise_sigmas * sensor_noise_n(force_n)
    turns = turning_points(position_m, _AIR_FRACTION * travel_m)
    for begin, end in pairwise(turns):
        bins = min(_FALL.bins, (end - begin) // _FALL.min_rows)
        if position_m[end] - position_m[begin] < _FALL.stroke_fraction * travel_m or bins < 4:
            continue
        levels_m = np.linspace(position_m[begin], position_m[end], bins + 1)
        farthest_m = np.maximum.accumulate(position_m[begin : end + 1])
        edges = begin + np.searchsorted(farthest_m, levels_m)
        rows = np.diff(edges)
        if rows.min() < 1:
            continue
        means_n = np.array([force_n[low:high].mean() for low, high in pairwise(edges)])
        for peak in range(1, bins - 1):
            pace = np.abs(rows[peak + 1 :] - rows[peak])
            late = np.flatnonzero(pace > max(1.0, _FALL.pace_fraction * rows[peak]))
            last = peak + 1 + (int(late[0]) if len(late) else bins - peak - 1)
            fall_n = means_n[peak] - means_n[peak + 1 : last]
            if len(fall_n) and fall_n.max() > max(least_n, noise_n / np.sqrt(rows[peak])):
                low = peak + 1 + int(np.argmax(fall_n))
                yield warning(
                    "fall", recording.name,
                    f"force falls from {means_n[peak]:.3g} to {means_n[low]:.3g} N on the way in, "
                    f"from {1e3 * levels_m[peak]:.3g} to {1e3 * levels_m[low + 1]:.3g} mm at "
                    f"{edges[peak] * recording.dt_s:.4g} s",
                    "an object that snaps through, cracks or slips does so, and no model here",
                    "cut the recording there if it is damage, else expect the model to miss it",
                )  # fmt: skip
                return


def _force_loss_findings(recording: Recording) -> Iterator[Finding]:
    """Find the first row at which force is gone."""
    position_m = recording.position_m
    for row in _find_force_loss(position_m, np.abs(recording.force_n - _air_force_n(recording))):
        yield warning(
            "gone", recording.name,
            f"force is gone at {row * recording.dt_s:.4g} s, with the tool "
            f"{1e3 * (position_m[row] - position_m.min()):.3g} mm from its lowest position",
            "a cable came off, or the object tore or stays dented", "cut the recording there",
        )  # fmt: skip
        return


def _find_force_loss(x: Samples, rise: Samples) -> Iterator[int]:
    """Rows from which on the tool is deep in the object, and meets no force where it met some.

    An object relaxes, and one that flows answers a slow press with little. So the force falls from
    one sample to the next while the tool goes on as before; or there is none on a whole way in that
    takes no more than four times the samples of one with force, and none at its deepest sample,
    which is as deep as any before: an object that stays dented pushes there.
    """
    noise_n = _NOISE_SIGMAS * sensor_noise_n(rise)
    if len(x) <= 2 * _MEDIAN_REACH or noise_n > _MAX_NOISE_FRACTION * rise.max():
        return
    samples = sliding_window_view(np.pad(rise, _MEDIAN_REACH, mode="edge"), 2 * _MEDIAN_REACH + 1)
    rise = np.median(samples, axis=1)
    middle_m, deep_m = (
        float(x.min() + share * np.ptp(x))
        for share in (_CONTACT_TRAVEL_FRACTION, _DEEP_TRAVEL_FRACTION)
    )
    zero_force_n = max(_LOST_FORCE_FRACTION * float(rise.max()), noise_n)
    bend_m = _MAX_BEND_FRACTION * float(np.ptp(x))

    def loading_samples(begin: int, end: int) -> int:
        """Samples from row `begin`, in the middle, to the first deep one; 0 if there is none."""
        comes_in = begin > 0 and x[begin - 1] < middle_m
        return int(np.argmax(x[begin:end] >= deep_m)) if comes_in else 0

    strokes = [(begin, loading_samples(begin, end)) for begin, end in runs(x >= middle_m)]
    longest = _MAX_SLOWDOWN * max(
        (samples_in for begin, samples_in in strokes if rise[begin + samples_in] > zero_force_n),
        default=0,
    )

    def is_deepest(begin: int, end: int) -> bool:
        """Return whether a stroke is deepest in these rows, and none before is deeper."""
        first, last = next(stroke for stroke in runs(x >= middle_m) if stroke[1] > begin)
        deepest = first + int(np.argmax(x[first:last]))
        return begin <= deepest < end and x[deepest] >= x[:first].max(initial=-np.inf) - bend_m

    met, gone = np.flatnonzero((x >= middle_m) & (rise > zero_force_n)), None
    for begin, end in runs((x >= middle_m) & (rise <= zero_force_n)):
        neighbours_m = x[max(0, begin - 2 * _MEDIAN_REACH) : begin + _MEDIAN_REACH + 1]
        falls = (
            begin > 0
            and end - begin > _MEDIAN_REACH
            and x[begin - 1] - x[begin] < _LET_GO_FRACTION * float(np.ptp(x))
            and rise[begin - 1] > _DROP_RATIO * zero_force_n
        )
        goes_on = abs(neighbours_m[0] - 2.0 * x[begin - 1] + neighbours_m[-1]) <= bend_m
        if falls and goes_on:
            yield begin
        if 0 < loading_samples(begin, end) <= longest:
            # The first of all that meet nothing, once one of them is deep enough to say so.
            gone = begin if gone is None or ((met > gone) & (met < begin)).any() else gone
            if is_deepest(begin, end):
                yield gone


def _excursion(other: Samples, channel: str) -> float:
    """Distance that the other channel goes within a run.

    A held position lets force relax one way; only a force that rises and falls shows clipping.
    Noise does so too: of so many samples in a row the mean is taken.
    """
    if channel == "force":
        return float(np.ptp(other))
    averaged = max(1, len(other) // _RUNS_PER_AVERAGE)
    by_noise = _CLIPPED_SIGMAS * sensor_noise_n(other) / float(np.sqrt(averaged))
    other = np.convolve(other, np.full(averaged, 1.0 / averaged), "valid")
    first, last = float(other[0]), float(other[-1])
    beyond = max(other.max() - max(first, last), min(first, last) - other.min())
    return float(beyond) - by_noise


def _find_filled_runs(recording: Recording) -> list[tuple[int, int]]:
    """Runs of rows in which both channels stand still, after which the position catches up."""
    steps_m, filled = np.abs(np.diff(recording.position_m)), []
    min_rows = max(3, round(_MIN_FILLED_S / recording.dt_s))
    for begin, end in runs((steps_m == 0.0) & (np.diff(recording.force_n) == 0.0)):
        around = np.concatenate((steps_m[max(0, begin - 20) : begin], steps_m[end + 1 : end + 21]))
        if end - begin >= min_rows and begin > 0 and end < len(steps_m):
            usual_m = float(np.median(around))
            catches_up = float(steps_m[end]) > 0.5 * (end - begin + 1) * usual_m
            if catches_up and usual_m > _ZERO_STEP_FRACTION * float(np.ptp(recording.position_m)):
                filled.append((begin, end))
    return filled


def _find_wraps(samples: Samples, other: Samples) -> list[int]:
    """Rows before jumps from one end of the range to the other, against the motion around them.

    A counter that wraps stays there, jumps by one size, and is back on its turn where the other
    channel is back where it began. Hum is undone by the next sample; a force that falls where the
    object cracks never jumps up again. The other channel goes on meanwhile: where a tool is drawn
    back within a sample, it does not.
    Empty if there is one alone, or if a fifth of the jumps are none.
    """
    steps, span, other_span = np.diff(samples), float(np.ptp(samples)), float(np.ptp(other))
    usual_steps = np.append(np.abs(steps)[np.abs(steps) <= _JUMP_RANGE_FRACTION * span], 0.0)
    # In a hold alone, noise jumps over much of the range and back: it does so all the time.
    usual = float(np.quantile(usual_steps, 0.95))
    min_jump = max(_JUMP_RANGE_FRACTION * span, _JUMP_STEP_RATIO * usual)
    jumps = np.flatnonzero(
        (np.abs(steps) > min_jump) & (np.abs(np.diff(other)) < _MAX_OTHER_FRACTION * other_span)
    )
    groups = np.split(jumps, np.flatnonzero(np.diff(jumps) > _NEIGHBOUR_SAMPLES) + 1)
    wraps = list[tuple[int, int]]()
    for rows in groups if len(jumps) else ():
        # Noise at the turn jumps there and back: what is left of them counts.
        begin, end, jump = int(rows[0]), int(rows[-1]) + 1, float(steps[rows].sum())
        before = samples[begin] - samples[max(0, begin - _NEIGHBOUR_SAMPLES)]
        after = samples[end : end + 1 + _NEIGHBOUR_SAMPLES][-1] - samples[end]
        if abs(jump) > min_jump and jump * before < 0.0 and jump * after < 0.0:
            wraps.append((begin, 1 if jump > 0.0 else -1))
    back = np.flatnonzero(np.abs(other - other[0]) < _RETURN_FRACTION * other_span)[-1]
    signs = [sign for row, sign in wraps if row < back]
    never_back = len(signs) > 1 and abs(sum(signs)) == len(signs)
    many = len(wraps) > max(1, _MIN_WRAP_FRACTION * len(groups))
    return [row for row, _ in wraps] if many and not never_back else []
