"""Spikes: a few samples far from those around them, which are replaced from those beside."""

from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from springpot.codegen.arrays import Indices, Samples, runs
from springpot.trainer.recordings.quality.finding import Finding, refusal, warning
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import quantisation_step

SPIKES_KEY = "outliers"  # of a recording's details: what was found in each channel
_MAX_POSITION_RUN, _MAX_FORCE_RUN = (
    5,
    2,
)  # samples of position, of force: a longer run may be an impact
_POSITION_FRACTION, _FORCE_FRACTION = (
    0.25,
    0.02,
)  # of the channel's range: a spike is as far off at least
_NOISE_SIGMAS, _MAX_STEP_RATIO = (
    8.0,
    5.5,
)  # of the noise, and of the largest step around: it is farther off
_MEDIAN_REACH = 5  # samples to each side that are compared
_MAX_SPIKE_FRACTION = 0.05  # of the samples
_MAX_TRAVEL_FRACTION = 0.1  # of the travel: a tool that moves more meanwhile may have hit something


def replace_spikes(recording: Recording) -> tuple[Recording, list[Finding]]:
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
    if known := recording.details.get(SPIKES_KEY):
        replaced = ("replaced from those beside", "if the tool did so, record at a higher rate")
        return recording, [warning("outlier", name, what, *replaced) for what in known]
    position_m, force_n = recording.position_m, recording.force_n
    position_rows = _find_position_spikes(position_m, force_n)
    repaired_m = _interpolate_rows(position_m, position_rows)
    force_rows = _find_force_spikes(repaired_m, force_n)
    channels = (
        ("position", position_rows, 1e3 * position_m, "mm"),
        ("force", force_rows, force_n, "N"),
    )
    found = [
        f"{len(rows)} of {len(values)} samples of {channel} jump away, the first at "
        f"{rows[0] * recording.dt_s:.4g} s to {values[rows[0]]:.4g} {unit}"
        for channel, rows, values, unit in channels
        if len(rows)
    ]
    if not found:
        return recording, []
    if max(len(position_rows), len(force_rows)) > _MAX_SPIKE_FRACTION * len(force_n):
        spoiled = ("too many to be replaced", "mend the sensor or its cable, and record again")
        return recording, [refusal("outlier", name, what, *spoiled) for what in found]
    details, repaired_n = (
        {**recording.details, SPIKES_KEY: found},
        _interpolate_rows(force_n, force_rows),
    )
    repaired = replace(recording, position_m=repaired_m, force_n=repaired_n, details=details)
    return replace_spikes(repaired)


def _find_position_spikes(position_m: Samples, force_n: Samples) -> Indices:
    """Rows of spikes, ascending: at most five samples in a row.

    At an end of the recording force has to stay: it may start just before a sudden press.
    """
    spikes, last = np.zeros(len(position_m), dtype=bool), len(position_m) - 1
    for run in _find_outlier_runs(position_m, _MAX_POSITION_RUN, _POSITION_FRACTION):
        inside = run[-1] + 1 if run[0] == 0 else run[0] - 1
        step_m, step_n = (float(each[run[0]] - each[inside]) for each in (position_m, force_n))
        follows = step_m * step_n > 0.0 and abs(step_n) > _POSITION_FRACTION * float(
            np.ptp(force_n)
        )
        spikes[run] = not follows or (run[0] > 0 and run[-1] < last)
    return np.flatnonzero(spikes)


def _find_force_spikes(position_m: Samples, force_n: Samples) -> Indices:
    """Rows of spikes, ascending: one or two samples in a row.

    Not where the tool moves by a tenth of its travel meanwhile, which may be an impact, nor at an
    end where force goes on: a recording may begin while it relaxes.
    """
    spikes, last = np.zeros(len(force_n), dtype=bool), len(force_n) - 1
    for run in _find_outlier_runs(force_n, _MAX_FORCE_RUN, _FORCE_FRACTION):
        beside_n = force_n[run[-1] + 1 :][:2] if run[0] == 0 else force_n[: run[0]][-2:]
        goes_on = float(np.ptp(beside_n)) > _FORCE_FRACTION * float(np.ptp(force_n))
        if (run[0] > 0 and run[-1] < last) or not goes_on:
            moved_m = float(np.ptp(position_m[max(run[0] - 1, 0) : run[-1] + 2]))
            spikes[run] = moved_m <= _MAX_TRAVEL_FRACTION * float(np.ptp(position_m))
    return np.flatnonzero(spikes)


def _find_outlier_runs(samples: Samples, longest: int, share: float) -> list[Indices]:
    """Runs of rows farther from the medians around than noise, motion and a share of the range.

    The noise is by the median of second differences, which spikes hardly change; without those
    that are 0, of a sensor that repeats its values. The motion is that of the medians.
    """
    second_differences = np.abs(np.diff(samples, 2))
    second_differences = second_differences[second_differences > 0.0]
    if len(samples) <= 2 * _MEDIAN_REACH or not len(second_differences):
        return []
    min_deviation = _NOISE_SIGMAS * 1.4826 * float(np.median(second_differences)) / np.sqrt(6.0)
    if np.abs(np.diff(samples)).max() <= min_deviation:
        return []
    medians = np.median(sliding_window_view(samples, 2 * _MEDIAN_REACH + 1), axis=1)
    typical = np.pad(medians, _MEDIAN_REACH, mode="edge")
    steps = np.pad(np.abs(np.diff(typical)), 2 * _MEDIAN_REACH)
    steps = sliding_window_view(steps, 4 * _MEDIAN_REACH).max(axis=1)
    min_deviation = np.maximum(
        max(min_deviation, share * float(np.ptp(typical))), _MAX_STEP_RATIO * steps
    )
    far = runs(np.abs(samples - typical) > min_deviation)
    return [np.arange(begin, end) for begin, end in far if end - begin <= longest]


def _interpolate_rows(samples: Samples, rows: Indices) -> Samples:
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
    repaired = samples.copy()
    repaired[rows] = values
    return repaired
