"""Recordings to train on, and recordings to report on: whole ones, never single rows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from springpot import Recording

_HOLDOUT = 5  # one recording in so many is held out


def holdout(recordings: Sequence[Recording], seed: int) -> tuple[list[Recording], list[Recording]]:
    """Split into training and validation: a fifth of the recordings, or the end of a single one.

    The recording with the maximum force stays: without it, validation measures extrapolation.
    """
    if len(recordings) == 1:
        cut = 1.0 - 1.0 / _HOLDOUT
        return [part_of(recordings[0], 0.0, cut)], [part_of(recordings[0], cut, 1.0)]
    strongest = int(np.argmax([recording.force_n.max() for recording in recordings]))
    others = [i for i in range(len(recordings)) if i != strongest]
    count = max(1, len(recordings) // _HOLDOUT)
    chosen = set(np.random.default_rng(seed).choice(others, size=count, replace=False).tolist())
    training = [recording for i, recording in enumerate(recordings) if i not in chosen]
    return training, [recording for i, recording in enumerate(recordings) if i in chosen]


def part_of(recording: Recording, begin: float, end: float) -> Recording:
    """Return the samples between two shares of a recording's length."""
    n = len(recording.force_n)
    rows = slice(round(begin * n), round(end * n))
    return replace(
        recording,
        name=f"{recording.name}, {100 * begin:.0f} to {100 * end:.0f} %",
        position_m=recording.position_m[rows],
        force_n=recording.force_n[rows],
        channels={},
        session="",  # what is left of a session has gaps
    )
