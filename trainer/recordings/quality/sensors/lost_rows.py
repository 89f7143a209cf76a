"""Rows that a logger lost and counted on without: both channels jump in the midst of a motion."""

from collections.abc import Iterator

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.quality.sign_evidence import noise_n
from springpot.trainer.recordings.recording import Recording

_BESIDE = 10  # samples on each side, of the motion there
_USUAL = 0.99  # quantile of the steps
_POSITION, _FORCE = 5.0, 3.0  # times the largest step beside
_NOISES, _SURE = 8.0, 5.0  # of a jump; of a motion beside it


def lost_findings(recording: Recording) -> Iterator[Finding]:
    """Name steps in which position and force go as far as in many, and before and after do not.

    A tool that steps rests before or after; one that turns round and goes back at once steps
    against its motion on both sides.
    """
    position_m, force_n = recording.position_m, recording.force_n
    jumps = _jumps(position_m, _POSITION)
    jumps = [at for at in jumps if at in set(_jumps(force_n, _FORCE)) and _goes_on(position_m, at)]
    if jumps:
        at = max(jumps, key=lambda at: abs(float(position_m[at + 1] - position_m[at])))
        times = f"{len(jumps)} times, the farthest" if len(jumps) > 1 else "once,"
        yield warning(
            "gap", recording.name,
            f"position and force jump amid a motion, {times} by "
            f"{1e3 * abs(float(position_m[at + 1] - position_m[at])):.3g} mm and "
            f"{abs(float(force_n[at + 1] - force_n[at])):.3g} N within the sample at "
            f"{(at + 1) * recording.dt_s:.4g} s",
            "rows seem to be lost there, without a gap in time: a model would learn a speed that "
            "no tool had",
            "cut there and import the parts, or record again with less load on the computer",
        )  # fmt: skip


def _jumps(samples: Samples, times: float) -> list[int]:
    """Samples before steps that are larger by `times` than those beside and than usual ones."""
    steps = np.abs(np.diff(samples))
    least = max(times * float(np.quantile(steps, _USUAL)), _NOISES * noise_n(samples))
    found = []
    for at in np.flatnonzero(steps > least).tolist():
        beside = np.concatenate(
            [steps[max(0, at - _BESIDE) : at], steps[at + 1 : at + 1 + _BESIDE]]
        )
        if len(beside) and steps[at] > times * float(beside.max()):
            found.append(at)
    return found


def _goes_on(position_m: Samples, at: int) -> bool:
    """Whether the tool moves before and after a jump, on one side at least the same way.

    A single step beside is no motion.
    """
    steps_m = np.diff(position_m)
    ways_m = []
    for beside_m in (steps_m[max(0, at - _BESIDE) : at], steps_m[at + 1 : at + 1 + _BESIDE]):
        way_m = float(beside_m.sum())
        single_m = float(np.abs(beside_m).max(initial=0.0))
        if abs(way_m) - single_m <= _SURE * noise_n(position_m):
            return False
        ways_m.append(way_m)
    return max(way_m * float(steps_m[at]) for way_m in ways_m) > 0.0
