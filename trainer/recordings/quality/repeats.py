"""Recordings of one profile, repeated: noise floor and drift between them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.trainer.recordings.quality.cycles import SAME_PRESS, at_equal_positions
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.recording import Recording

_DRIFT = 0.02  # of the peak force
_POINTS = 2000
_MAX_PAIRED = 200


@dataclass(frozen=True)
class Repeats:
    """Recordings of one press.

    noise_n: of each against the mean of the earlier ones, rms, at equal positions.
    drift_n: mean force of the last less that of the first. peak_n: maximum force.
    samples: of all but the first. place_m: where they were pressed, if that is known.
    """

    names: tuple[str, ...]
    noise_n: float
    drift_n: float
    peak_n: float
    samples: int
    place_m: tuple[float, float] | None = None


def find_repeats(recordings: Sequence[Recording]) -> list[Repeats]:
    """Group recordings of one press, of equal length and rate, and compare the forces in each.

    A copy is no repeat.
    """
    groups: list[list[Recording]] = []
    for recording in recordings[:_MAX_PAIRED]:
        group = next((g for g in groups if _same_press(g[0], recording)), None)
        if group is None:
            groups.append([recording])
        elif not any(_is_copy(recording, other) for other in group):
            group.append(recording)
    return [_repeats(group) for group in groups if len(group) > 1]


def repeat_findings(repeats: Sequence[Repeats]) -> Iterator[Finding]:
    """Yield a finding for each group with a drifting force."""
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


def _is_copy(one: Recording, other: Recording) -> bool:
    same = np.array_equal(one.force_n, other.force_n)
    return same and np.array_equal(one.position_m, other.position_m)


def _same_press(one: Recording, other: Recording) -> bool:
    """Whether one path was driven twice, or one force, at one place."""
    if one.place_m != other.place_m:
        return False
    if len(one.position_m) != len(other.position_m) or abs(one.dt_s / other.dt_s - 1) > 1e-3:
        return False
    return _alike(one.position_m, other.position_m) or _alike(one.force_n, other.force_n)


def _alike(one: Samples, other: Samples) -> bool:
    a, b = _thin(one), _thin(other)
    span = max(float(np.ptp(a)), float(np.ptp(b)))
    return float(np.sqrt(np.mean((a - b) ** 2))) < SAME_PRESS * span


def _repeats(group: list[Recording]) -> Repeats:
    forces = np.stack([recording.force_n for recording in group])
    positions = np.stack([recording.position_m for recording in group])
    return Repeats(
        names=tuple(recording.name for recording in group),
        noise_n=_noise_n(at_equal_positions(positions, forces)),
        drift_n=float(forces[-1].mean() - forces[0].mean()),
        peak_n=float(np.abs(forces).max()),
        samples=forces[1:].size,
        place_m=group[0].place_m,
    )


def _noise_n(forces_n: NDArray[np.float64]) -> float:
    """RMS of what each of (repeats, samples) differs by from the mean of the earlier ones.

    Noise alone gives its own RMS whatever the number of repeats: a mean of k forces adds a k-th.
    """
    squares = [
        k / (k + 1) * float(np.mean((forces_n[k] - forces_n[:k].mean(axis=0)) ** 2))
        for k in range(1, len(forces_n))
    ]
    return float(np.sqrt(np.mean(squares)))
