"""Recordings of one profile, repeated: noise floor and drift between them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.quality.cycles import noise_floor_n
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.recording import Recording

_SAME_POSITION = 0.02  # rms difference over the travel
_DRIFT = 0.02  # of the peak force
_POINTS = 2000
_MAX_PAIRED = 200


@dataclass(frozen=True)
class Repeats:
    """Recordings that follow one path.

    noise_n: rms difference that their motion does not explain: no model can beat it.
    drift_n: mean force of the last less that of the first. peak_n: maximum force.
    """

    names: tuple[str, ...]
    noise_n: float
    drift_n: float
    peak_n: float


def find_repeats(recordings: Sequence[Recording]) -> list[Repeats]:
    """Group recordings of equal length, rate and path, and compare the forces in each group."""
    groups: list[list[Recording]] = []
    for recording in recordings[:_MAX_PAIRED]:
        group = next((g for g in groups if _same_path(g[0], recording)), None)
        if group is None:
            groups.append([recording])
        else:
            group.append(recording)
    return [_repeats(group) for group in groups if len(group) > 1]


def repeat_findings(repeats: Sequence[Repeats]) -> Iterator[Finding]:
    """Yield a finding for each group whose force drifts."""
    for group in repeats:
        if abs(group.drift_n) > max(_DRIFT * group.peak_n, group.noise_n):
            yield warning(
                "drift", f"{group.names[0]} to {group.names[-1]}",
                f"mean force changes by {group.drift_n:.3g} N over {len(group.names)} repeats",
                "the object or the sensor changes between recordings, a model averages over it",
                "condition the object by some cycles first, let the sensor warm up",
            )  # fmt: skip


def _thin(samples: Samples) -> Samples:
    return samples[:: max(1, len(samples) // _POINTS)]


def _same_path(one: Recording, other: Recording) -> bool:
    if len(one.position_m) != len(other.position_m) or abs(one.dt_s / other.dt_s - 1) > 1e-3:
        return False
    a, b = _thin(one.position_m), _thin(other.position_m)
    travel_m = max(float(np.ptp(a)), float(np.ptp(b)))
    return float(np.sqrt(np.mean((a - b) ** 2))) < _SAME_POSITION * travel_m


def _repeats(group: list[Recording]) -> Repeats:
    forces = np.stack([recording.force_n for recording in group])
    positions = np.stack([recording.position_m for recording in group])
    return Repeats(
        names=tuple(recording.name for recording in group),
        noise_n=noise_floor_n(positions, forces),
        drift_n=float(forces[-1].mean() - forces[0].mean()),
        peak_n=float(np.abs(forces).max()),
    )
