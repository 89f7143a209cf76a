"""A channel that jumps against all motion: a counter or converter wraps, or a sensor is dead.

What wraps jumps from one end of its range to the other. A sensor with a loose plug, or a logger
that lost rows, gives one value for a while, far from those beside it.
"""

from collections.abc import Iterator

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.plurals import number_of
from springpot.trainer.recordings.quality.finding import Finding, refusal, warning
from springpot.trainer.recordings.recording import Recording

_LONG, _USUAL_STEPS = 0.4, 4.0  # of the range; times 95 in 100 of the other steps: a jump
_END = 0.1  # of the range: where it jumps from, and to
_CHATTER = 8  # samples: of jumps to and fro, where a channel rests at the end of its range
_BESIDE = 5  # samples, over which a channel moves against its jump
_FEWEST_JUMPS, _MOST_JUMPS = 2, 0.8  # jumps; of them against the motion
_GOES_ON = 0.2  # of the other channel's range, meanwhile
_FEWEST = 3  # samples of one value; fewer may be a spike, which is held
_JUMP = 0.25  # of the channel's range, within a sample
_TIMES_USUAL, _USUAL = 8.0, 0.95  # the quantile of the steps
_EVEN = 0.1  # of the other channel's range, in the sample of a jump: if the tool steps, both jump
_STAYS = 0.02  # of the other channel's range: so far it may go beyond where it is beside the run


def wrap_findings(recording: Recording) -> Iterator[Finding]:
    """Refuse a channel that jumps through its whole range, against its motion before and after.

    The other channel goes on meanwhile: where a tool is drawn back within a sample, it does not.
    """
    for channel, samples, other, scale, unit in _each_channel(recording):
        # What chatters for long says nothing of its motion.
        jumps = [
            jump
            for jump in _jumps(samples)
            if _goes_on(other, *jump) and jump[1] - jump[0] <= _CHATTER
        ]
        wraps = [begin for begin, end in jumps if _against(samples, begin, end)]
        if len(jumps) >= _FEWEST_JUMPS and len(wraps) > _MOST_JUMPS * len(jumps):
            yield refusal(
                "wrap", recording.name,
                f"{channel} jumps {number_of(len(wraps), 'time')} by "
                f"{scale * float(np.ptp(samples)):.3g} {unit} against its own motion, first at "
                f"{(wraps[0] + 1) * recording.dt_s:.3f} s",
                "a counter or a converter wraps there, and no object is pressed so",
                "unwrap it in the source, as numpy.unwrap does",
            )  # fmt: skip


def _jumps(samples: Samples) -> list[tuple[int, int]]:
    """Last sample before each jump and first one after it; chatter that ends beyond is one jump."""
    steps, span = np.abs(np.diff(samples)), float(np.ptp(samples))
    usual = steps[steps <= _LONG * span]
    if not len(usual):
        return []
    # In a hold alone, noise jumps over much of the range and back: it does so all the time.
    least = max(_LONG * span, _USUAL_STEPS * float(np.quantile(usual, 0.95)))
    at = np.flatnonzero(steps > least)
    found = []
    for part in np.split(at, np.flatnonzero(np.diff(at) > _CHATTER) + 1) if len(at) else ():
        begin, end = int(part[0]), int(part[-1]) + 1
        if abs(float(samples[end] - samples[begin])) > least:
            found.append((begin, end))
    return found


def _against(samples: Samples, begin: int, end: int) -> bool:
    """Whether a channel moves to an end of its range, and goes on so from the other end."""
    low, span = float(samples.min()), float(np.ptp(samples))
    way = float(np.sign(samples[end] - samples[begin]))
    ends = ((samples[[begin, end]] - low) / span - 0.5) * way
    before = float(samples[begin] - samples[max(0, begin - _BESIDE)])
    after = float(samples[min(len(samples) - 1, end + _BESIDE)] - samples[end])
    at_ends = ends[0] < _END - 0.5 and ends[1] > 0.5 - _END
    return bool(at_ends) and way * before < 0.0 and way * after < 0.0


def _goes_on(other: Samples, begin: int, end: int) -> bool:
    return abs(float(other[end] - other[begin])) < _GOES_ON * float(np.ptp(other))


def dead_findings(recording: Recording) -> Iterator[Finding]:
    """Name runs of one value into which a channel jumps, and out of which it jumps back.

    Of a tool that steps, or strikes the object, both channels jump; one that leaves it is farther
    out than beside the run; one that steps in the air feels no force. Rows that were lost are one
    value of both channels, amid a motion: a tool that steps rests before and after.
    """
    rows = set(_dead_runs(recording.position_m)) & set(_dead_runs(recording.force_n))
    rows = {run for run in rows if _moves(recording.position_m, *run)}
    for channel, samples, other, scale, unit in _each_channel(recording):
        runs = [run for run in _dead_runs(samples) if run in rows or _stays(other, *run)]
        if runs:
            begin, end = max(runs, key=lambda run: run[1] - run[0])
            times = f"{len(runs)} times, the longest" if len(runs) > 1 else "once,"
            yield warning(
                "dead", recording.name,
                f"{channel} jumps to {scale * samples[begin]:.4g} {unit} and stays there, {times} "
                f"{number_of(end - begin, 'sample')} from {begin * recording.dt_s:.4g} s on",
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


def _each_channel(recording: Recording) -> Iterator[tuple[str, Samples, Samples, float, str]]:
    """Yield name, samples and the other one's of each channel; its unit in words, in SI units."""
    yield "position", recording.position_m, recording.force_n, 1e3, "mm"
    yield "force", recording.force_n, recording.position_m, 1.0, "N"
