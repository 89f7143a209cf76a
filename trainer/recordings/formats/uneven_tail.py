"""Files with last rows that are out of step: machines end a test between two samples.

Rows in step stay as they are, those after are interpolated onto the same steps and reported.
"""

from typing import Any

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.plurals import number_of
from springpot.trainer.recordings.recording import Recording

# So much of a file may be out of step if it is its end.
_MAX_SHARE = 0.05
_MIN_STEPS = 20


def last_even_sample(time_s: Samples, slack_s: float, digit_s: float) -> int | None:
    """The last sample in step where only the end is out of step; None elsewhere.

    slack_s: how far a step may differ from the usual one. digit_s: last printed digit of the
    stamps; where the other rows are regular to it, the first one out of step is found exactly.
    """
    steps_s = np.diff(time_s)
    off_s = np.abs(steps_s - np.median(steps_s))
    if not np.any(off_s > slack_s):
        return None
    for limit_s in (min(1.5 * digit_s, slack_s), slack_s):
        first = int(np.argmax(off_s > limit_s))
        rows = len(steps_s) - first
        if first >= _MIN_STEPS and rows <= max(1.0, _MAX_SHARE * len(steps_s)):
            return first
    return None


def tail_grid(time_s: Samples, last_even: int) -> tuple[Samples, dict[str, Any]]:
    """Even time stamps to the end, (samples,), s, and the metadata of what was done."""
    begin_s, end_s = float(time_s[0]), float(time_s[-1])
    step_s = (float(time_s[last_even]) - begin_s) / last_even
    count = int((end_s - begin_s) / step_s + 1e-6) + 1
    grid_s: Samples = begin_s + step_s * np.arange(count, dtype=np.float64)
    left_out_s = max(0.0, end_s - float(grid_s[-1]))
    return grid_s, {"rows": len(time_s) - last_even - 1, "left_out_s": left_out_s}


def on_grid(time_s: Samples, samples: Samples, grid_s: Samples, last_even: int) -> Samples:
    """Samples on the grid, (samples,): those in step as they are, those after interpolated."""
    behind = np.interp(grid_s[last_even + 1 :], time_s, samples)
    return np.concatenate((samples[: last_even + 1], behind))


def tail_note(recording: Recording) -> str:
    """Report what was done with an uneven end; empty where nothing was."""
    tail = recording.details["sampling"].get("tail")
    if not tail:
        return ""
    return (
        f"the end, {number_of(tail['rows'], 'row')} from row {tail['from_row']} on, is not in step "
        f"with the rows before: interpolated onto their {recording.rate_hz:.6g} Hz, and the last "
        f"{tail['left_out_s']:.3g} s left out"
    )
