"""What a set of training recordings has in common: time step, contact, range."""

from collections.abc import Sequence

import numpy as np

from springpot.codegen.ir import Contact, TrainedRange
from springpot.runtime_c.errors import DataError
from springpot.trainer.recording import Recording, Samples

_STEP_TOLERANCE = 1e-3


def common_time_step(recordings: Sequence[Recording]) -> float:
    """Time step of all recordings, s. Raises DataError where there are none, or two."""
    if not recordings:
        raise DataError("no recordings: give files or folders of recordings")
    first = recordings[0]
    for recording in recordings:
        if abs(recording.dt_s / first.dt_s - 1.0) > _STEP_TOLERANCE:
            raise DataError(
                f"{recording.name} is sampled at {recording.rate_hz:g} Hz, {first.name} at "
                f"{first.rate_hz:g} Hz: import both with one --resample-hz"
            )
    return first.dt_s


def contact_of(recordings: Sequence[Recording]) -> Contact:
    """Return "always" where an importer moved the zero: position 0 is then no surface."""
    moved = [recording.name for recording in recordings if recording.zero != "none"]
    if moved and len(moved) != len(recordings):
        kept = next(recording.name for recording in recordings if recording.zero == "none")
        raise DataError(
            f"{moved[0]} was imported with --zero and {kept} without: import all the same way"
        )
    return "always" if moved else "surface"


def depth_m(recording: Recording, contact: Contact) -> Samples:
    """Positions as the model sees them: those above the surface count as 0."""
    if contact == "always":
        return recording.position_m
    return np.maximum(recording.position_m, 0.0)


def trained_range(recordings: Sequence[Recording], contact: Contact) -> TrainedRange:
    """Extremes over all recordings. Raises DataError where nothing moved."""
    depths = [depth_m(recording, contact) for recording in recordings]
    least_m = min(float(depth.min()) for depth in depths)
    greatest_m = max(float(depth.max()) for depth in depths)
    if greatest_m <= max(least_m, 0.0):
        raise DataError(
            f"{recordings[0].name}: positions never go deeper than {greatest_m:g} m: position must "
            "grow into the object; check the sign and the unit on import"
        )
    speeds = [
        float(np.abs(np.diff(depth)).max()) / recording.dt_s
        for depth, recording in zip(depths, recordings, strict=True)
    ]
    return TrainedRange(
        least_m=least_m,
        greatest_m=greatest_m,
        greatest_mps=max(speeds),
        least_n=min(float(recording.force_n.min()) for recording in recordings),
        greatest_n=max(float(recording.force_n.max()) for recording in recordings),
    )
