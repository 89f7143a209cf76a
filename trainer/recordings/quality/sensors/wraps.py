"""A counter or converter that wraps: its channel jumps from one end of its range to the other."""

from collections.abc import Iterator

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.quality.finding import Finding, refusal
from springpot.trainer.recordings.recording import Recording

_LONG, _USUAL_STEPS = 0.4, 4.0  # of the range; times 95 in 100 of the other steps: a jump
_END = 0.1  # of the range: where it jumps from, and to
_CHATTER = 8  # samples: of jumps to and fro, where a channel rests at the end of its range
_BESIDE = 5  # samples, over which a channel moves against its jump
_FEWEST, _MOST = 2, 0.8  # jumps; of them against the motion
_GOES_ON = 0.2  # of the other channel's range, meanwhile


def wrap_findings(recording: Recording) -> Iterator[Finding]:
    """Refuse a channel that jumps through its whole range, against its motion before and after.

    The other channel goes on meanwhile: where a tool is drawn back within a sample, it does not.
    """
    position_m, force_n = recording.position_m, recording.force_n
    for channel, samples, other, scale, unit in (
        ("position", position_m, force_n, 1e3, "mm"),
        ("force", force_n, position_m, 1.0, "N"),
    ):
        # What chatters for long says nothing of its motion.
        jumps = [
            jump
            for jump in _jumps(samples)
            if _goes_on(other, *jump) and jump[1] - jump[0] <= _CHATTER
        ]
        wraps = [begin for begin, end in jumps if _against(samples, begin, end)]
        if len(jumps) >= _FEWEST and len(wraps) > _MOST * len(jumps):
            yield refusal(
                "wrap", recording.name,
                f"{channel} jumps {len(wraps)} times by {scale * float(np.ptp(samples)):.3g} "
                f"{unit} against its own motion, first at {(wraps[0] + 1) * recording.dt_s:.3f} s",
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
