"""Faults of a channel: constant, clipped, filled, coarse, or wrapped; spikes, which are replaced.

A spike is a few samples far from those around them: they are replaced from the samples beside.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from springpot.codegen.arrays import Indices, Samples, runs
from springpot.codegen.messages import number_of
from springpot.trainer.recordings.quality.finding import Finding, refusal, warning
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import noise_n, quantisation_step

HELD = "outliers"  # of a recording's details: what was found in each channel
_LONGEST_M, _LONGEST_N = 5, 2  # samples of position, of force: a longer run may be an impact
_SHARE_M, _SHARE_N = 0.25, 0.02  # of the channel's range: a spike is as far off at least
_NOISES, _STEPS = 8.0, 5.5  # of the noise, and of the largest step around: it is farther off
_REACH = 5  # samples to each side that are compared
_MOST = 0.05  # of the samples
_STILL = 0.1  # of the travel: a tool that moves more meanwhile may have hit something
_CLIPPED_RUN, _CLIPPED_MOVE = 5, 0.05  # samples at the extreme; of the other channel's range
_STUCK, _DEAD = 0.05, 0.3  # of the force's range, off its level without contact; of the travel
_AVERAGED_SHARE = 8  # of such a row, one part is averaged
_CLIPPED_NOISES = 6.0  # of that mean
_HELD_S = 0.02
_NO_STEP = 1e-9  # of the travel: a step that is none
_COARSE = 0.01  # quantisation step over the signal's range
_LONG, _USUAL_STEPS = 0.4, 4.0  # of the range; times the usual step: a jump
_BESIDE = 5  # samples, over which a channel moves against its jump
_MOST_JUMPS = 0.8  # of the jumps
_GOES_ON = 0.2  # of the other channel's range, meanwhile


def hold_spikes(recording: Recording) -> tuple[Recording, list[Finding]]:
    """Return the recording without spikes, and a finding for each channel that has any.

    One spike would stretch the trained range, the scale of all that is fitted, and the limit of
    force. More than 5 % of the samples are refused. The recording keeps what was found in it.

    >>> position_m = 1e-3 * (1 - np.cos(np.linspace(0, 6.28, 200)))
    >>> force_n = 500 * position_m
    >>> force_n[50] = 900.0
    >>> held, (finding,) = hold_spikes(Recording("a", position_m, force_n, 1e-3))
    >>> finding.what
    '1 of 200 samples of force jump away, the first at 0.05 s to 900 N'
    """
    name = recording.name
    if known := recording.details.get(HELD):
        replaced = ("replaced from those beside", "if the tool did so, record at a higher rate")
        return recording, [warning("outlier", name, what, *replaced) for what in known]
    position_m, force_n = recording.position_m, recording.force_n
    at_m = _position_spikes(position_m, force_n)
    held_m = _interpolated(position_m, at_m)
    at_n = _force_spikes(held_m, force_n)
    channels = (("position", at_m, 1e3 * position_m, "mm"), ("force", at_n, force_n, "N"))
    found = [
        f"{len(rows)} of {len(values)} samples of {channel} jump away, the first at "
        f"{rows[0] * recording.dt_s:.4g} s to {values[rows[0]]:.4g} {unit}"
        for channel, rows, values, unit in channels
        if len(rows)
    ]
    if not found:
        return recording, []
    if max(len(at_m), len(at_n)) > _MOST * len(force_n):
        spoiled = ("too many to be replaced", "mend the sensor or its cable, and record again")
        return recording, [refusal("outlier", name, what, *spoiled) for what in found]
    details, held_n = {**recording.details, HELD: found}, _interpolated(force_n, at_n)
    held = replace(recording, position_m=held_m, force_n=held_n, details=details)
    return hold_spikes(held)


def _position_spikes(position_m: Samples, force_n: Samples) -> Indices:
    """Rows of spikes, ascending: at most five samples in a row.

    At an end of the recording force has to stay: it may start just before a sudden press.
    """
    spikes, last = np.zeros(len(position_m), dtype=bool), len(position_m) - 1
    for run in _far_runs(position_m, _LONGEST_M, _SHARE_M):
        inside = run[-1] + 1 if run[0] == 0 else run[0] - 1
        step_m, step_n = (float(each[run[0]] - each[inside]) for each in (position_m, force_n))
        follows = step_m * step_n > 0.0 and abs(step_n) > _SHARE_M * float(np.ptp(force_n))
        spikes[run] = not follows or (run[0] > 0 and run[-1] < last)
    return np.flatnonzero(spikes)


def _force_spikes(position_m: Samples, force_n: Samples) -> Indices:
    """Rows of spikes, ascending: one or two samples in a row.

    Not where the tool moves by a tenth of its travel meanwhile, which may be an impact, nor at an
    end where force goes on: a recording may begin while it relaxes.
    """
    spikes, last = np.zeros(len(force_n), dtype=bool), len(force_n) - 1
    for run in _far_runs(force_n, _LONGEST_N, _SHARE_N):
        beside_n = force_n[run[-1] + 1 :][:2] if run[0] == 0 else force_n[: run[0]][-2:]
        goes_on = float(np.ptp(beside_n)) > _SHARE_N * float(np.ptp(force_n))
        if (run[0] > 0 and run[-1] < last) or not goes_on:
            moved_m = float(np.ptp(position_m[max(run[0] - 1, 0) : run[-1] + 2]))
            spikes[run] = moved_m <= _STILL * float(np.ptp(position_m))
    return np.flatnonzero(spikes)


def _far_runs(samples: Samples, longest: int, share: float) -> list[Indices]:
    """Runs of rows farther from the medians around than noise, motion and a share of the range.

    The noise is by the median of second differences, which spikes hardly change; without those
    that are 0, of a sensor that repeats its values. The motion is that of the medians.
    """
    second = np.abs(np.diff(samples, 2))
    second = second[second > 0.0]
    if len(samples) <= 2 * _REACH or not len(second):
        return []
    least = _NOISES * 1.4826 * float(np.median(second)) / np.sqrt(6.0)
    if np.abs(np.diff(samples)).max() <= least:
        return []
    medians = np.median(sliding_window_view(samples, 2 * _REACH + 1), axis=1)
    typical = np.pad(medians, _REACH, mode="edge")
    steps = np.pad(np.abs(np.diff(typical)), 2 * _REACH)
    steps = sliding_window_view(steps, 4 * _REACH).max(axis=1)
    least = np.maximum(max(least, share * float(np.ptp(typical))), _STEPS * steps)
    far = np.flatnonzero(np.abs(samples - typical) > least)
    runs = np.split(far, np.flatnonzero(np.diff(far) > 1) + 1)
    return [run for run in runs if 0 < len(run) <= longest]


def _interpolated(samples: Samples, rows: Indices) -> Samples:
    """The samples with these rows from those beside, on the sensor's grid if there is one.

    Values off the grid would hide it, and with it the noise of a force without contact.
    """
    if not len(rows):
        return samples
    good = np.setdiff1d(np.arange(len(samples)), rows)
    values = np.interp(rows, good, samples[good])
    if step := quantisation_step(samples[good]):
        first = samples[good[0]]
        values = first + step * np.round((values - first) / step)
    held = samples.copy()
    held[rows] = values
    return held


def channel_findings(recording: Recording) -> Iterator[Finding]:
    """Yield what is wrong with the channels of one recording; a constant one alone."""
    channels = (
        ("position", recording.position_m, recording.force_n, 1e3, "mm"),
        ("force", recording.force_n, recording.position_m, 1.0, "N"),
    )
    constant = [each for each in channels if np.ptp(each[1]) == 0.0]
    for channel, samples, _, scale, unit in constant:
        yield refusal(
            "constant", recording.name, f"{channel} is {scale * samples[0]:.6g} {unit} all along",
            "there is nothing to learn from it",
            "take the right column (--map), or check the sensor's cable",
        )  # fmt: skip
    if constant:
        return
    grains = []
    for channel, samples, other, scale, unit in channels:
        yield from _clipping_findings(recording, channel, samples, other)
        if wraps := _wraps(samples, other):
            yield refusal(
                "wrap", recording.name,
                f"{channel} jumps {len(wraps)} times by {scale * float(np.ptp(samples)):.3g} "
                f"{unit} against its own motion, first at {wraps[0] * recording.dt_s:.3f} s",
                "a counter or a converter wraps there, or samples are spikes",
                "unwrap it in the source (numpy.unwrap), or cut them out",
            )  # fmt: skip
        if step := quantisation_step(samples):
            grains.append(step)
            if (share := step / float(np.ptp(samples))) > _COARSE:
                yield warning(
                    "quantisation", recording.name,
                    f"{channel} has steps of {scale * step:.3g} {unit}, {100 * share:.2g} % of "
                    "its range",
                    f"no model can be better than about {scale * step / np.sqrt(12):.2g} {unit}",
                    "use a finer sensor or range, or more amplitude",
                )  # fmt: skip
    yield from _stuck_findings(recording)
    filled = _filled_runs(recording) if not grains else []  # coarse channels repeat values
    if filled:
        begin, end = max(filled, key=lambda run: run[1] - run[0])
        yield warning(
            "gap", recording.name,
            f"both channels stand still {number_of(len(filled), 'time')}, longest {end - begin} "
            f"samples at {begin * recording.dt_s:.3f} s",
            "lost samples were filled by the last one",
            "cut there, or record again with less load on the computer",
        )  # fmt: skip


def _clipping_findings(
    recording: Recording, channel: str, samples: Samples, other: Samples
) -> Iterator[Finding]:
    """Find a flat extreme of one channel while the other goes on."""
    for extreme, side in ((samples.max(), "maximum"), (samples.min(), "minimum")):
        flat = [run for run in runs(samples == extreme) if run[1] - run[0] >= _CLIPPED_RUN]
        if not flat or (side == "minimum" and extreme >= 0.0):
            continue  # out of contact, or at rest
        moved = max(_excursion(other[begin:end], channel) for begin, end in flat)
        longest_s = max(end - begin for begin, end in flat) * recording.dt_s
        if moved > _CLIPPED_MOVE * np.ptp(other):
            yield warning(
                "clipping", recording.name,
                f"{channel} stays at its {side} for up to {longest_s:.3g} s while the other "
                "channel moves on",
                "the sensor's limit is recorded in place of the object",
                "record again with less amplitude or a larger sensor",
            )  # fmt: skip


def _stuck_findings(recording: Recording) -> Iterator[Finding]:
    """Find a force that stands still in contact while the tool moves through the object."""
    position_m, force_n = recording.position_m, recording.force_n
    travel_m, range_n = float(np.ptp(position_m)), float(np.ptp(force_n))
    free_n = float(np.median(force_n[position_m <= position_m.min() + _STILL * travel_m]))
    for begin, end in runs(np.diff(force_n) == 0.0):
        moved_m = float(np.ptp(position_m[begin : end + 1]))
        in_contact = abs(force_n[begin] - free_n) > _STUCK * range_n
        inside = force_n.min() < force_n[begin] < force_n.max()  # at its limits it is clipped
        if end - begin >= _CLIPPED_RUN and in_contact and inside and moved_m > _DEAD * travel_m:
            yield warning(
                "stuck", recording.name,
                f"force stands still at {force_n[begin]:.4g} N for "
                f"{(end - begin) * recording.dt_s:.3g} s from {begin * recording.dt_s:.4g} s on, "
                f"while the tool moves by {1e3 * moved_m:.3g} mm",
                "no sample of the sensor came through", "cut the recording there",
            )  # fmt: skip
            return


def _excursion(other: Samples, channel: str) -> float:
    """Distance that the other channel goes within a run.

    A held position lets force relax one way; only a force that rises and falls shows clipping.
    Noise does so too: of so many samples in a row the mean is taken.
    """
    if channel == "force":
        return float(np.ptp(other))
    averaged = max(1, len(other) // _AVERAGED_SHARE)
    by_noise = _CLIPPED_NOISES * noise_n(other) / float(np.sqrt(averaged))
    other = np.convolve(other, np.full(averaged, 1.0 / averaged), "valid")
    first, last = float(other[0]), float(other[-1])
    beyond = max(other.max() - max(first, last), min(first, last) - other.min())
    return float(beyond) - by_noise


def _filled_runs(recording: Recording) -> list[tuple[int, int]]:
    """Runs of rows in which both channels stand still, after which the position catches up."""
    steps_m, found = np.abs(np.diff(recording.position_m)), []
    least = max(3, round(_HELD_S / recording.dt_s))
    for begin, end in runs((steps_m == 0.0) & (np.diff(recording.force_n) == 0.0)):
        around = np.concatenate((steps_m[max(0, begin - 20) : begin], steps_m[end + 1 : end + 21]))
        if end - begin >= least and begin > 0 and end < len(steps_m):
            usual_m = float(np.median(around))
            catches_up = float(steps_m[end]) > 0.5 * (end - begin + 1) * usual_m
            if catches_up and usual_m > _NO_STEP * float(np.ptp(recording.position_m)):
                found.append((begin, end))
    return found


def _wraps(samples: Samples, other: Samples) -> list[int]:
    """Rows before jumps through much of the range, against the motion before and after.

    The other channel goes on meanwhile: where a tool is drawn back within a sample, it does not.
    Empty if there is one alone, or if a fifth of the jumps are none.
    """
    steps, spans = np.diff(samples), (float(np.ptp(samples)), float(np.ptp(other)))
    usual = np.append(np.abs(steps)[np.abs(steps) <= _LONG * spans[0]], 0.0)
    # In a hold alone, noise jumps over much of the range and back: it does so all the time.
    least = max(_LONG * spans[0], _USUAL_STEPS * float(np.quantile(usual, 0.95)))
    jumps = np.flatnonzero((np.abs(steps) > least) & (np.abs(np.diff(other)) < _GOES_ON * spans[1]))
    wraps = [
        at
        for at in jumps.tolist()
        if steps[at] * (samples[at] - samples[max(0, at - _BESIDE)]) < 0.0
        and steps[at] * (samples[at + 1 : at + 2 + _BESIDE][-1] - samples[at + 1]) < 0.0
    ]
    return wraps if len(wraps) > max(1, _MOST_JUMPS * len(jumps)) else []
