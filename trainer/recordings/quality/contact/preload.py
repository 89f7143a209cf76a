"""Find recordings that never leave the object: under preload, or pulled by it."""

from collections.abc import Iterator, Sequence

import numpy as np

from springpot.trainer.recordings.quality.finding import Finding, span, warning
from springpot.trainer.recordings.quality.motion import where_of
from springpot.trainer.recordings.quality.sign_evidence import noise_n
from springpot.trainer.recordings.recording import Recording

NEAR_ZERO = 0.02  # of the travel, about position 0
NOISES = 8.0  # of the force's
_AS_MUCH = 1.25  # times the force of other presses, which may have been slower

Loaded = tuple[Recording, float]  # and the force at its lowest position, N


def preload_findings(loaded: Sequence[Loaded]) -> Iterator[Finding]:
    """Yield a finding for recordings that pull at their lowest position, and one for preloads.

    What pulls there is bonded to the tool, or was pressed when its force was zeroed: these data
    look alike.
    """
    pulled = [item for item in loaded if item[1] < 0.0]
    pressed = [item for item in loaded if item[1] >= 0.0]
    if pulled:
        yield warning(
            "contact", where_of([recording for recording, _ in pulled]),
            f"force is {_forces(pulled)} at its lowest position",
            "the object is bonded to the tool and pulls, or force was zeroed under load: the model "
            "pulls there too, and has no surface",
            "if it is not bonded, import with --tare=-PRELOAD_N, the force that was taken off, or "
            "record with force zeroed in the air",
        )  # fmt: skip
    if pressed:
        # What was tared on purpose has its zero of force, and import takes no other beside it.
        tared = any("tare_n" in recording.details for recording, _ in pressed)
        or_zero = ", or, if position 0 means nothing, import with --zero first or min"
        yield warning(
            "contact", where_of([recording for recording, _ in pressed]),
            f"never leaves the object, {_forces(pressed)} at its lowest position",
            "the model pushes there too, and has no surface",
            "record from above the object" + ("" if tared else or_zero),
        )  # fmt: skip


def other_zero_findings(loaded: Sequence[Loaded], shown: Sequence[Recording]) -> Iterator[Finding]:
    """Yield a finding for what pushes more than others do at its depth, or pulls there.

    shown: those that meet the surface at position 0. An object that is kept pressed relaxes, so
    that it pushes no more than one that is pressed from its surface. Nor does it pull, if another
    one was off it: what is pulled and pressed has no air.
    """
    in_air = any(each.position_m.min() < -NEAR_ZERO * np.ptp(each.position_m) for each in shown)
    pulled = [] if in_air else [item for item in loaded if item[1] < 0.0]
    yield from preload_findings(pulled)
    for recording, rest_n in (item for item in loaded if item not in pulled):
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
    return f"{span([force_n for _, force_n in loaded])} N"
