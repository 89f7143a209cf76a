"""A recording that pushes several times as hard as the others: a unit, or another object."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.formats.units import units_near
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.quality.motion import find_strokes
from springpot.trainer.recordings.quality.sign_evidence import noise_n
from springpot.trainer.recordings.recording import Recording

# Between presses of one object, at equal depth: softening by the first press, relaxation, another
# day leave less. By speed the force of a solid grows with a small power, that of a fluid in
# proportion; a fluid pushes no more where the tool turns round.
_APART = 2.5
_SOLID, _FLUID = 0.3, 1.0  # powers of the speed
_TURNING = 0.5  # of the greatest force of a stroke
_DEPTHS = np.linspace(0.2, 0.95, 16)  # of a press
_LEAST = 0.02  # of the greatest force: below that, noise and the surface make the ratio
_NOISES = 5.0
_ALL, _FEWEST = 0.1, 3  # quantile of the depths; of them in common


def scale_findings(recordings: Sequence[Recording]) -> Iterator[Finding]:
    """Yield a finding for each recording that no other one comes near at the same depths.

    Objects that differ from place to place, and presses without a zero in common, are left out.
    """
    if any(item.place_m or item.zero != "none" for item in recordings):
        return
    presses = [press for item in recordings if (press := _Press.of(item)) is not None]
    for press in presses if len(presses) > 1 else ():
        beyond, times = min(press.over(other) for other in presses if other is not press)
        if beyond < _APART or (len(presses) == 2 and times < 1.0):
            continue  # of two, the one that pushes harder is named
        meant = units_near(1.0 / times, "force")
        unit = f"its force looks as if it were in {meant}" if meant else "another unit or gain"
        yield warning(
            "scale", press.recording.name,
            f"pushes {times:.3g} times as hard as the other recordings at equal depth",
            f"{unit}, or another object: one model of both fits neither",
            "state the unit on import (--map force=COL:UNIT), or leave that recording out",
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Press:
    """Force on the way in, at depths of the deepest stroke; power: of speed that it may follow."""

    recording: Recording
    depth_m: Samples
    force_n: Samples
    speed_mps: float
    power: float

    @classmethod
    def of(cls, recording: Recording) -> "_Press | None":
        position_m = recording.position_m
        inwards = [
            (begin, end)
            for begin, end, _ in find_strokes(recording)
            if position_m[end] > max(0.0, float(position_m[begin]))
        ]
        if not inwards:
            return None
        begin, end = max(inwards, key=lambda stroke: position_m[stroke[1]])
        part = slice(begin, end + 1)
        depth_m = np.maximum.accumulate(position_m[part])
        grid_m = depth_m[0] + _DEPTHS * (depth_m[-1] - depth_m[0])
        force_n = np.interp(grid_m, depth_m, recording.force_n[part])
        least_n = max(_LEAST * np.ptp(recording.force_n), _NOISES * noise_n(recording.force_n))
        seen = (force_n > least_n) & (grid_m > 0.0)
        if not seen.any():
            return None
        # A stroke may rest on its way: the speed is that with which it comes by.
        speed_mps = float(np.median(np.gradient(depth_m)[np.searchsorted(depth_m, grid_m)]))
        flows = recording.force_n[end] < _TURNING * float(recording.force_n[part].max())
        power = _FLUID if flows else _SOLID
        return cls(recording, grid_m[seen], force_n[seen], speed_mps / recording.dt_s, power)

    def over(self, other: "_Press") -> tuple[float, float]:
        """Factor between the forces, beyond what their speeds may make, and force over the other's.

        The factor is that where they are nearest; 1 without depths in common.
        """
        both = (self.depth_m >= other.depth_m[0]) & (self.depth_m <= other.depth_m[-1])
        if np.count_nonzero(both) < _FEWEST or min(self.speed_mps, other.speed_mps) <= 0.0:
            return 1.0, 1.0
        logs = np.log(
            self.force_n[both] / np.interp(self.depth_m[both], other.depth_m, other.force_n)
        )
        power = max(self.power, other.power)
        by_speed = power * float(np.log(self.speed_mps / other.speed_mps))
        left = logs - np.clip(logs, min(by_speed, 0.0), max(by_speed, 0.0))
        least, most = np.quantile(left, (_ALL, 1.0 - _ALL))
        return float(np.exp(max(least, -most, 0.0))), float(np.exp(np.median(logs)))
