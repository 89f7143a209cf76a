"""Whether the object has a surface that the tool leaves, and at which depth it is pressed then."""

from collections.abc import Sequence

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.model.model import Contact
from springpot.trainer.recordings.contact_point import find_contact
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.sensor import sensor_noise_n
from springpot.trainer.recordings.smoothing import smoothed, smoothing_samples

_LOWEST = 0.02  # of the depth: where an object's force is 0 if position 0 is its surface
_REST_SHARE = 0.02  # of the peak force
_PULL, _OFTEN = 0.05, 0.01  # of the peak force, in a share of the samples: it holds the tool
_HUM_S, _DEVIATIONS = 0.02, 4.0  # a period of the mains, over which a force is averaged; of noise
_PRELOADED = (
    "force is {rest_n:.3g} N at the lowest positions and no recording leaves the object: the model "
    "pushes there too, and has no surface; if position 0 is the surface, record from above it"
)
_PULLS = (
    "force goes to {min_n:.3g} N inside the object: it holds the tool, and the model pulls as it "
    "does; if nothing held it, look for drift or delay of the force"
)


def contact_of(recordings: Sequence[Recording]) -> Contact:
    """Return "surface" where force is 0 at position 0, "always" where the tool never leaves.

    It never leaves where an importer moved the zero, or where force at the lowest depth is 2 % of
    the peak or more and no recording shows where contact begins. (One that does has a tare: it is
    no force that the object pushes with.) Nor does it leave what holds it: `pulls`.
    """
    moved = [recording.name for recording in recordings if recording.zero != "none"]
    if moved and len(moved) != len(recordings):
        kept = next(recording.name for recording in recordings if recording.zero == "none")
        raise DataError(
            f"{moved[0]} was imported with --zero and {kept} without: import all the same way"
        )
    if moved:
        return "always"
    peak_n = max(float(recording.force_n.max()) for recording in recordings)
    if peak_n > 0.0 and pulls(recordings):
        return "always"
    if abs(rest_force_n(recordings)) < _REST_SHARE * peak_n or peak_n <= 0.0:
        return "surface"
    return "surface" if any(map(_shows_contact, recordings)) else "always"


def surface_warning(recordings: Sequence[Recording]) -> str:
    """Say why the model of these recordings has no surface."""
    if pulls(recordings):
        return _PULLS.format(min_n=min(float(each.force_n.min()) for each in recordings))
    return _PRELOADED.format(rest_n=rest_force_n(recordings))


def pulls(recordings: Sequence[Recording]) -> bool:
    """Whether the object holds the tool: its force inside goes below that at rest, often.

    By 5 % of the peak in 1 % of the samples or more, and by more than noise: a glued specimen, or
    one that sticks. Each recording may have a tare of its own.
    """
    peak_n = max(float(recording.force_n.max()) for recording in recordings)
    pulled = samples = 0
    for recording in recordings:
        averaged = smoothing_samples(_HUM_S, recording.dt_s)
        quiet = smoothed(recording, _HUM_S) if averaged < len(recording.force_n) else recording
        noise_n = _DEVIATIONS * sensor_noise_n(recording.force_n) / np.sqrt(averaged)
        low_m = float(quiet.position_m.min()) + _LOWEST * float(np.ptp(quiet.position_m))
        limit_n = min(rest_force_n([quiet]), 0.0) - _PULL * peak_n - noise_n
        below = (quiet.position_m > low_m) & (quiet.force_n < limit_n)
        pulled += int(np.count_nonzero(below))
        samples += len(below)
    return pulled > _OFTEN * samples


def rest_force_n(recordings: Sequence[Recording]) -> float:
    """Median force at the lowest 2 % of the positions of all recordings, N."""
    position_m = np.concatenate([recording.position_m for recording in recordings])
    force_n = np.concatenate([recording.force_n for recording in recordings])
    low = position_m <= position_m.min() + _LOWEST * np.ptp(position_m)
    return float(np.median(force_n[low]))


def _shows_contact(recording: Recording) -> bool:
    try:
        find_contact(recording)
    except DataError:
        return False
    return True


def depth_m(recording: Recording, contact: Contact) -> Samples:
    """Positions as the model sees them, (n,), m: those above the surface count as 0."""
    if contact == "always":
        return recording.position_m
    return np.maximum(recording.position_m, 0.0)
