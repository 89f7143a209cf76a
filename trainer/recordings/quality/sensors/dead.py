"""A sensor that gives one value for a while, far from those beside it: a loose plug, lost rows."""

from collections.abc import Iterator

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.recording import Recording

_FEWEST = 3  # samples of one value; fewer may be a spike, which is held
_JUMP = 0.25  # of the channel's range, within a sample
_TIMES_USUAL, _USUAL = 8.0, 0.95  # the quantile of the steps
_EVEN = 0.1  # of the other channel's range, in the sample of a jump: if the tool steps, both jump
_STAYS = 0.02  # of the other channel's range: so far it may go beyond where it is beside the run


def dead_findings(recording: Recording) -> Iterator[Finding]:
    """Name runs of one value into which a channel jumps, and out of which it jumps back.

    Of a tool that steps, or strikes the object, both channels jump; one that leaves it is farther
    out than beside the run; one that steps in the air feels no force. Rows that were lost are one
    value of both channels, amid a motion: a tool that steps rests before and after.
    """
    position_m, force_n = recording.position_m, recording.force_n
    rows = set(_dead_runs(position_m)) & set(_dead_runs(force_n))
    rows = {run for run in rows if _moves(position_m, *run)}
    for channel, samples, other, scale, unit in (
        ("position", position_m, force_n, 1e3, "mm"),
        ("force", force_n, position_m, 1.0, "N"),
    ):
        runs = [run for run in _dead_runs(samples) if run in rows or _stays(other, *run)]
        if runs:
            begin, end = max(runs, key=lambda run: run[1] - run[0])
            times = f"{len(runs)} times, the longest" if len(runs) > 1 else "once,"
            yield warning(
                "dead", recording.name,
                f"{channel} jumps to {scale * samples[begin]:.4g} {unit} and stays there, {times} "
                f"{end - begin} samples from {begin * recording.dt_s:.4g} s on",
                "the sensor or its logger gave nothing, and a model would learn that value",
                "cut the recording there and import the parts, or record again",
            )  # fmt: skip


def _dead_runs(samples: Samples) -> list[tuple[int, int]]:
    """Runs [begin, end) of one value, with a jump at each side that is within the recording."""
    steps = np.diff(samples)
    usual = float(np.quantile(np.abs(steps), _USUAL))
    jumps = np.abs(steps) > max(_TIMES_USUAL * usual, _JUMP * float(np.ptp(samples)))
    edges = np.concatenate([[0], np.flatnonzero(steps) + 1, [len(samples)]])
    found = []
    for begin, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        into = begin > 0 and bool(jumps[begin - 1])
        out = end < len(samples) and bool(jumps[end - 1])
        both = into and out and steps[begin - 1] * steps[end - 1] < 0.0
        at_end = (into and end == len(samples)) or (out and begin == 0)
        if end - begin >= _FEWEST and (both or at_end):
            found.append((begin, end))
    return found


def _moves(position_m: Samples, begin: int, end: int) -> bool:
    """Whether the tool moves just before and just after a run."""
    steps = [(begin - 1, begin - 2), (end + 1, end)]
    within = all(0 <= at < len(position_m) and before >= 0 for at, before in steps)
    return within and all(position_m[at] != position_m[before] for at, before in steps)


def _stays(other: Samples, begin: int, end: int) -> bool:
    """Whether the other channel goes on evenly from beside the run, and does not draw back."""
    travel = float(np.ptp(other))
    edges = [(at, at - 1) for at in (begin, end) if 0 < at < len(other)]
    if any(abs(float(other[at] - other[before])) > _EVEN * travel for at, before in edges):
        return False
    if float(np.median(other[begin:end] - other.min())) <= _JUMP * travel:
        return False
    beside = [float(other[at]) for at in (begin - 1, end) if 0 <= at < len(other)]
    return float(other[begin:end].min()) >= min(beside) - _STAYS * travel
