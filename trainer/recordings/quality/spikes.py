"""Spikes: a few samples far from those around them, which are replaced from those beside."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from springpot.codegen.arrays import Indices, Samples, runs
from springpot.trainer.recordings.quality.finding import Finding, refusal, warning
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import quantisation_step

SPIKES_KEY = "outliers"  # of a recording's details: what was found in each channel


@dataclass(frozen=True)
class SpikeRule:
    """Define a spike: a few samples that leave their surroundings in one step, and come back.

    position_samples, force_samples: at most in a row; a longer run of force may be an impact.
    position_fraction, force_fraction: of the channel's range: a spike is as far off at least.
    reach: samples to each side whose median a sample is compared with.
    noise_sigmas: of the channel's noise: a spike is farther off.
    step_ratio: times the largest step of those medians, the median of the samples' own steps, and
    at an end the largest of the steps inside: a spike is farther off. Hum swells, and a tool at an
    end moves on; neither is farther off than that.
    beside_fraction: of its distance: as near are the samples beside a spike at most. The top of a
    smooth peak of six samples is no spike.
    travel_fraction: of the travel: a tool that moves by more meanwhile may have hit something.
    end_fraction: of the travel: a tool that moves by more at an end, as force does, presses.
    max_fraction: of the samples: more spikes are a fault of the sensor.
    least_events, events_fraction, band_fraction, time_fraction: so many runs or more, most of which
    come in a band of positions, so wide of the travel, where the tool spends less of its time, are
    made by the motion, as the pull of a sticky surface.
    """

    position_samples: int = 5
    force_samples: int = 2
    position_fraction: float = 0.25
    force_fraction: float = 0.02
    reach: int = 5
    noise_sigmas: float = 8.0
    step_ratio: float = 5.5
    beside_fraction: float = 1 / 3
    travel_fraction: float = 0.1
    end_fraction: float = 0.01
    max_fraction: float = 0.05
    least_events: int = 4
    events_fraction: float = 0.8
    band_fraction: float = 0.1
    time_fraction: float = 0.4


_RULE = SpikeRule()


def replace_spikes(recording: Recording) -> tuple[Recording, list[Finding]]:
    """Return the recording without spikes, and a finding for each channel that has any.

    One spike would stretch the trained range, the scale of all that is fitted, and the limit of
    force. More than 5 % of the samples are refused. The recording keeps what was found in it.

    >>> position_m = 1e-3 * (1 - np.cos(np.linspace(0, 6.28, 200)))
    >>> force_n = 500 * position_m
    >>> force_n[50] = 900.0
    >>> held, (finding,) = replace_spikes(Recording("a", position_m, force_n, 1e-3))
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
    spikes = [
        f"{len(rows)} of {len(values)} samples of {channel} jump away, the first at "
        f"{rows[0] * recording.dt_s:.4g} s to {values[rows[0]]:.4g} {unit}"
        for channel, rows, values, unit in channels
        if len(rows)
    ]
    if not spikes:
        return recording, []
    if max(len(position_rows), len(force_rows)) > _RULE.max_fraction * len(force_n):
        spoiled = ("too many to be replaced", "mend the sensor or its cable, and record again")
        return recording, [refusal("outlier", name, what, *spoiled) for what in spikes]
    details, repaired_n = (
        {**recording.details, SPIKES_KEY: spikes},
        _interpolate_rows(force_n, force_rows),
    )
    repaired = replace(recording, position_m=repaired_m, force_n=repaired_n, details=details)
    return replace_spikes(repaired)


def _find_position_spikes(position_m: Samples, force_n: Samples) -> Indices:
    """Rows of spikes, ascending: at most five samples in a row.

    At an end of the recording force has to stay: it may start just before a sudden press.
    """
    spikes, last = np.zeros(len(position_m), dtype=bool), len(position_m) - 1
    for run in _find_outlier_runs(position_m, _RULE.position_samples, _RULE.position_fraction):
        inside = run[-1] + 1 if run[0] == 0 else run[0] - 1
        step_m, step_n = (
            float(channel[run[0]] - channel[inside]) for channel in (position_m, force_n)
        )
        follows = step_m * step_n > 0.0 and abs(step_n) > _RULE.position_fraction * float(
            np.ptp(force_n)
        )
        spikes[run] = not follows or (run[0] > 0 and run[-1] < last)
    return np.flatnonzero(spikes)


def _find_force_spikes(position_m: Samples, force_n: Samples) -> Indices:
    """Rows of spikes, ascending: one or two samples in a row.

    Not where the tool moves by a tenth of its travel meanwhile, which may be an impact. Nor where
    the object may push so: at an end where force goes on, while it relaxes, or follows the tool; at
    the turn of a tool that meets, for these samples alone, an object that is dented.
    """
    spike_runs, last, travel_m = list[Indices](), len(force_n) - 1, float(np.ptp(position_m))
    outliers = _find_outlier_runs(force_n, _RULE.force_samples, _RULE.force_fraction)
    peak_n = np.delete(force_n, np.concatenate([*outliers, np.empty(0, dtype=np.intp)])).max()
    for run in outliers:
        rows = slice(max(run[0] - 1, 0), run[-1] + 2)
        if run[0] > 0 and run[-1] < last:
            around_m = position_m[max(run[0] - _RULE.reach, 0) : run[-1] + 1 + _RULE.reach]
            is_pushed = around_m.max() in position_m[rows] and 0.0 < force_n[run].max() <= peak_n
        else:
            first, inside = (0, run[-1] + 1) if run[0] == 0 else (last, run[0] - 1)
            step_m, step_n = (
                float(channel[first] - channel[inside]) for channel in (position_m, force_n)
            )
            follows = step_m * step_n > 0.0 and abs(step_m) > _RULE.end_fraction * travel_m
            beside_n = force_n[run[-1] + 1 :][:2] if run[0] == 0 else force_n[: run[0]][-2:]
            is_pushed = follows or np.ptp(beside_n) > _RULE.force_fraction * np.ptp(force_n)
        if np.ptp(position_m[rows]) <= _RULE.travel_fraction * travel_m and not is_pushed:
            spike_runs.append(run)
    if _come_with_motion(position_m, [int(run[0]) for run in spike_runs]):
        return np.empty(0, dtype=np.intp)
    return np.concatenate([*spike_runs, np.empty(0, dtype=np.intp)])


def _come_with_motion(position_m: Samples, rows: list[int]) -> bool:
    """Return whether events come at one place, where the tool is only a part of its time."""
    band_m = _RULE.band_fraction * float(np.ptp(position_m))
    at_m = np.sort(position_m[rows])
    inside = np.searchsorted(at_m, at_m + band_m, side="right") - np.arange(len(at_m))
    if len(rows) < _RULE.least_events or inside.max() < _RULE.events_fraction * len(rows):
        return False
    low_m = at_m[np.argmax(inside)]
    stays = np.mean((position_m >= low_m) & (position_m <= low_m + band_m))
    return bool(stays < _RULE.time_fraction)


def _find_outlier_runs(samples: Samples, longest: int, share: float) -> list[Indices]:
    """Runs of rows farther from the medians around than noise, motion and a share of the range.

    The noise is by the median of second differences, which spikes hardly change; without those
    that are 0, of a sensor that repeats its values. The motion is that of the medians, and of the
    samples themselves: hum as fast as half the rate hardly moves a median.
    """
    second_differences = np.abs(np.diff(samples, 2))
    second_differences = second_differences[second_differences > 0.0]
    reach, steps = _RULE.reach, np.abs(np.diff(samples))
    if len(samples) <= 2 * reach or not len(second_differences):
        return []
    noise = 1.4826 * float(np.median(second_differences)) / np.sqrt(6.0)
    if steps.max() <= _RULE.noise_sigmas * noise:
        return []
    medians = np.median(sliding_window_view(samples, 2 * reach + 1), axis=1)
    typical = np.pad(medians, reach, mode="edge")
    motion = np.pad(np.abs(np.diff(typical)), 2 * reach)
    motion = sliding_window_view(motion, 4 * reach).max(axis=1)
    own_steps = np.pad(steps, 2 * reach, mode="reflect")
    own_steps = np.median(sliding_window_view(own_steps, 4 * reach), axis=1)[: len(samples)]
    floor = max(_RULE.noise_sigmas * noise, share * float(np.ptp(typical)))
    far = np.abs(samples - typical)
    outliers = []
    for begin, end in runs(
        far > np.maximum(floor, _RULE.step_ratio * np.maximum(motion, own_steps))
    ):
        if end - begin > longest:
            continue
        run, beside = (
            np.arange(begin, end),
            [row for row in (begin - 1, end) if 0 <= row < len(far)],
        )
        if len(beside) == 2:
            if far[beside].max() < _RULE.beside_fraction * far[run].min():
                outliers.append(run)
            continue
        # At an end there is one side: the step away from it is compared with those inside.
        away = steps[end - 1 if begin == 0 else begin - 1]
        inside = steps[end : end + 2 * reach] if begin == 0 else steps[: begin - 1][-2 * reach :]
        if away > max(_RULE.step_ratio * inside.max(initial=0.0), floor):
            outliers.append(run)
    return outliers


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
