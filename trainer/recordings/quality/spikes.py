"""Spikes: samples that no tool was at, or no object pushed with, held at the ones beside them."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.recording import Recording

LONGEST_SPIKE = 5  # samples of position
_LONGEST_FORCE = 2  # a longer one may be an impact's
_USUAL = 0.995  # of the steps are usual ones
_TIMES_USUAL = 8.0
_SHARE = 0.25  # of the range of the channel
_BESIDE = 0.1  # of the jump: what force may change just before and after
_STILL = 0.1  # of the travel: a tool that moves more meanwhile may have hit something


def hold_spikes(recording: Recording) -> tuple[Recording, list[Finding]]:
    """Return the recording with every spike held, and a warning for each channel that has any.

    One spike would stretch the trained range, the scale of all that is fitted, and the limit of
    force. Where position is held, force is as it was measured, at the true place of the tool,
    unless it jumps away too.

    >>> position_m = 1e-3 * (1 - np.cos(np.linspace(0, 6.28, 200)))
    >>> force_n = 500 * position_m
    >>> force_n[50] = 900.0
    >>> held, (finding,) = hold_spikes(Recording("a", position_m, force_n, 1e-3))
    >>> finding.what
    '1 of 200 samples of force jump away, the first at 0.05 s to 900 N'
    """
    position_m, force_n = recording.position_m, recording.force_n
    rows = spike_rows(position_m, force_n)
    findings = []
    if len(rows):
        findings.append(_finding(recording, "position", rows, position_m * 1e3, "mm"))
        position_m = _held(position_m, rows)
    rows = force_spike_rows(position_m, force_n)
    if len(rows):
        findings.append(_finding(recording, "force", rows, force_n, "N"))
        force_n = _held(force_n, rows)
    if not findings:
        return recording, []
    return replace(recording, position_m=position_m, force_n=force_n), findings


def spike_rows(position_m: Samples, force_n: Samples) -> Indices:
    """Rows of spikes of position, ascending: at most five samples between jumps there and back.

    A jump is a step above 8 times the 99.5 % quantile of all steps and a quarter of the range of
    the samples that are left. A run at an end has one jump; it is a spike unless force jumps the
    same way, as in a recording that starts just before a sudden press.
    """

    def at_end(left: Indices, jump: int) -> bool:
        step_n = np.diff(force_n[left])
        follows = abs(step_n[jump]) > _SHARE * np.ptp(force_n)
        return not follows or step_n[jump] * np.diff(position_m[left])[jump] < 0.0

    return _spikes(position_m, LONGEST_SPIKE, at_end)


def force_spike_rows(position_m: Samples, force_n: Samples) -> Indices:
    """Rows of spikes of force, ascending: one or two samples, as in `spike_rows`.

    An impact stays: it takes more than one sample to rise and to fall, or the tool moves by a tenth
    of its travel meanwhile. So does a run at an end: a recording may begin while force relaxes.
    """
    found = _spikes(force_n, _LONGEST_FORCE, lambda _left, _jump: False)
    runs = np.split(found, np.flatnonzero(np.diff(found) > 1) + 1) if len(found) else []
    still_m = _STILL * float(np.ptp(position_m))
    alone = [run for run in runs if _is_alone(position_m, force_n, run, still_m)]
    return np.concatenate(alone) if alone else np.empty(0, dtype=np.intp)


def _is_alone(position_m: Samples, force_n: Samples, run: Indices, still_m: float) -> bool:
    """Whether force is usual just before and after a run, where the tool hardly moves."""
    before, after = int(run[0]) - 1, int(run[-1]) + 1
    jump_n = abs(float(force_n[run[0]] - force_n[before]))
    beside_n = [
        abs(float(force_n[at] - force_n[at + away]))
        for at, away in ((before, -1), (after, 1))
        if 0 <= at + away < len(force_n)
    ]
    moved_m = abs(float(position_m[after] - position_m[before]))
    return max(beside_n, default=0.0) <= _BESIDE * jump_n and moved_m <= still_m


def _held(samples: Samples, rows: Indices) -> Samples:
    good = np.setdiff1d(np.arange(len(samples)), rows)
    before = np.maximum(np.searchsorted(good, rows) - 1, 0)
    held = samples.copy()
    held[rows] = samples[good[before]]
    return held


def _finding(
    recording: Recording, channel: str, rows: Indices, values: Samples, unit: str
) -> Finding:
    also = {
        "position": "if the tool did move so, record at a higher rate",
        "force": "if it is an impact, record at a higher rate",
    }
    return warning(
        "outlier", recording.name,
        f"{len(rows)} of {len(values)} samples of {channel} jump away, the first at "
        f"{rows[0] * recording.dt_s:.4g} s to {values[rows[0]]:.4g} {unit}",
        "held at the sample beside them", also[channel],
    )  # fmt: skip


def _spikes(samples: Samples, longest: int, at_end: Callable[[Indices, int], bool]) -> Indices:
    """Rows of spikes; a wider spike may hide a narrower one, so what is left is looked at again.

    at_end: whether the run between an end and the one jump is a spike.
    """
    found = np.zeros(len(samples), dtype=bool)
    while True:
        left = np.flatnonzero(~found)
        rows = left[_runs(samples[left], longest, partial(at_end, left))]
        if not len(rows):
            return np.flatnonzero(found)
        found[rows] = True


def _runs(samples: Samples, longest: int, at_end: Callable[[int], bool]) -> Indices:
    """Indices in the runs between jumps."""
    step = np.diff(samples)
    if len(step) < 2:
        return np.empty(0, dtype=np.intp)
    usual = float(np.quantile(np.abs(step), _USUAL))
    least = max(_TIMES_USUAL * usual, _SHARE * float(np.ptp(samples)))
    jumps = np.flatnonzero(np.abs(step) > least)
    found: list[int] = []
    for jump, back in zip(jumps[:-1].tolist(), jumps[1:].tolist(), strict=True):
        away = not found or found[-1] < jump  # not itself the way back of the run before
        if away and back - jump <= longest and step[jump] * step[back] < 0.0:
            found += range(jump + 1, back + 1)
    if len(jumps) and not found:
        n, first, last = len(samples), int(jumps[0]), int(jumps[-1])
        if first < longest and at_end(first):
            found += range(first + 1)
        elif last >= n - 1 - longest and at_end(last):
            found += range(last + 1, n)
    return np.array(found, dtype=np.intp)
