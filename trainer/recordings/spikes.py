"""Spikes of position: samples that no tool can have been at, held at the ones beside them."""

from dataclasses import replace

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.trainer.recordings.recording import Recording

LONGEST = 5  # samples
_USUAL = 0.995  # of the steps are usual ones
_TIMES_USUAL = 8.0
_TRAVEL = 0.25


def hold_spikes(recording: Recording) -> tuple[Recording, str]:
    """Return the recording with every spike held, and a line that says so; "" where none is.

    One spike would stretch the trained range, and with it the scale of all that is fitted. Force
    stays as it is: it was measured where the tool truly was.
    """
    rows = spike_rows(recording.position_m, recording.force_n)
    if not len(rows):
        return recording, ""
    good = np.setdiff1d(np.arange(len(recording.position_m)), rows)
    before = np.maximum(np.searchsorted(good, rows) - 1, 0)
    position_m = recording.position_m.copy()
    position_m[rows] = recording.position_m[good[before]]
    line = (
        f"{recording.name}: {len(rows)} of {len(position_m)} samples of position jump away, the "
        f"first at {rows[0] * recording.dt_s:.4g} s to {recording.position_m[rows[0]] * 1e3:.4g} "
        "mm: held at the sample beside them; if the tool did move so, record at a higher rate"
    )
    return replace(recording, position_m=position_m), line


def spike_rows(position_m: Samples, force_n: Samples) -> Indices:
    """Rows of spikes, ascending: runs of at most five samples between two jumps there and back.

    A jump is a step above 8 times the 99.5 % quantile of all steps and a quarter of the travel of
    the samples that are left. A run at an end has one jump; it is a spike unless force jumps with
    it, as in a recording that starts just before a sudden press.
    """
    found = np.zeros(len(position_m), dtype=bool)
    while True:
        left = np.flatnonzero(~found)
        rows = left[_runs(position_m[left], force_n[left])]
        if not len(rows):
            return np.flatnonzero(found)
        found[rows] = True


def _runs(position_m: Samples, force_n: Samples) -> Indices:
    """Indices in the runs between jumps; a wider spike may hide a narrower one: ask again."""
    step = np.diff(position_m)
    if len(step) < 2:
        return np.empty(0, dtype=np.intp)
    least = max(
        _TIMES_USUAL * float(np.quantile(np.abs(step), _USUAL)), _TRAVEL * float(np.ptp(position_m))
    )
    jumps = np.flatnonzero(np.abs(step) > least)
    found: list[int] = []
    for jump, back in zip(jumps[:-1].tolist(), jumps[1:].tolist(), strict=True):
        away = not found or found[-1] < jump  # not itself the way back of the run before
        if away and back - jump <= LONGEST and step[jump] * step[back] < 0.0:
            found += range(jump + 1, back + 1)
    if len(jumps) and not found:
        n, first, last = len(position_m), int(jumps[0]), int(jumps[-1])
        follows = np.abs(np.diff(force_n)) > _TRAVEL * np.ptp(force_n)
        if first < LONGEST and not follows[first]:
            found += range(first + 1)
        elif last >= n - 1 - LONGEST and not follows[last]:
            found += range(last + 1, n)
    return np.array(found, dtype=np.intp)
