"""Find recordings that never leave the object: under preload, or pulled too."""

from collections.abc import Iterator, Sequence

import numpy as np

from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.quality.motion import where_of
from springpot.trainer.recordings.quality.sign_evidence import noise_n
from springpot.trainer.recordings.recording import Recording

NEAR_ZERO, _PULLED = 0.02, 0.2  # of the travel, about position 0; of the force
NOISES = 8.0  # of the force's
_AS_MUCH = 1.25  # times the force of other presses, which may have been slower

Loaded = tuple[Recording, float]  # and the force at its lowest position, N


def preload_findings(loaded: Sequence[Loaded]) -> Iterator[Finding]:
    """Yield a finding for recordings that are pulled too, and one for those under preload."""
    pulled = [item for item in loaded if _pulls_too(*item)]
    pressed = [item for item in loaded if item not in pulled]
    if pulled:
        yield warning(
            "contact", where_of([recording for recording, _ in pulled]),
            f"is pulled too, {_forces(pulled)} at its lowest position",
            "the model pulls there as well, and has no surface",
            "leave --zero out: force is 0 where position is",
        )  # fmt: skip
    if pressed:
        yield warning(
            "contact", where_of([recording for recording, _ in pressed]),
            f"never leaves the object, {_forces(pressed)} at its lowest position",
            "the model pushes there too, and has no surface",
            "record from above the object, or, if position 0 means nothing, import with --zero "
            "first or min",
        )  # fmt: skip


def other_zero_findings(loaded: Sequence[Loaded], shown: Sequence[Recording]) -> Iterator[Finding]:
    """Yield a finding for what pushes more than others do at its depth, or pulls there.

    shown: those that meet the surface at position 0. An object that is kept pressed relaxes, so
    that it pushes no more than one that is pressed from its surface. Nor does it pull, if another
    one was off it: what is pulled and pressed has no air.
    """
    in_air = any(each.position_m.min() < -NEAR_ZERO * np.ptp(each.position_m) for each in shown)
    for recording, rest_n in loaded:
        if rest_n < 0.0 and not in_air:
            yield from preload_findings([(recording, rest_n)])
            continue
        lowest_m = float(recording.position_m.min())
        near_m = lowest_m + NEAR_ZERO * float(np.ptp(recording.position_m))
        there_n = max(
            float(each.force_n[each.position_m <= near_m].max(initial=0.0)) for each in shown
        )
        if rest_n < 0.0 or rest_n > _AS_MUCH * there_n + NOISES * noise_n(recording.force_n):
            yield warning(
                "contact", recording.name,
                f"never leaves the object, {rest_n:.3g} N at its lowest position, "
                f"{1e3 * lowest_m:.3g} mm, where the others have {there_n:.3g} N",
                "its position 0 is not their surface", "give it their zero, or leave it out",
            )  # fmt: skip


def _forces(loaded: Sequence[Loaded]) -> str:
    low_n, high_n = min(force_n for _, force_n in loaded), max(force_n for _, force_n in loaded)
    low, high = f"{low_n:.3g}", f"{high_n:.3g}"
    return f"{low} N" if low == high else f"{low} to {high} N"


def _pulls_too(recording: Recording, rest_n: float) -> bool:
    """Whether an object is pulled below position 0 and pressed above it."""
    position_m, force_n = recording.position_m, recording.force_n
    near = np.abs(position_m) <= NEAR_ZERO * float(np.ptp(position_m))
    if not near.any() or position_m.min() >= 0.0 or rest_n >= 0.0:
        return False
    peak_n = float(force_n.max())
    at_zero_n = float(np.mean(force_n[near]))  # of a damper, the way in and the way out
    return -rest_n > _PULLED * peak_n and abs(at_zero_n) < _PULLED * (peak_n - rest_n)
