"""Whether force begins at position 0, where the surface should be, and is 0 without contact."""

from collections.abc import Iterator, Sequence
from contextlib import suppress

import numpy as np

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.contact_point import ContactPoint, find_contact
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.recording import Recording

_SURFACE_OFF, _TARE = 0.05, 0.02  # of the travel; of the peak force

Met = tuple[Recording, ContactPoint]


def contact_findings(recordings: Sequence[Recording]) -> Iterator[Finding]:
    """Yield findings where position 0 should be the surface and is not, of all together."""
    met: list[Met] = []
    for recording in (each for each in recordings if each.zero == "none"):
        with suppress(DataError):  # a tool that never leaves the object shows no surface
            met.append((recording, find_contact(recording)))
    # An object that remembers its last press is met where that left it.
    yield from _surface_findings([item for item in met if not item[0].start_s])
    for recording, contact in met:
        if abs(contact.tare_n) > max(3 * contact.threshold_n, _TARE * recording.force_n.max()):
            yield warning(
                "tare", recording.name, f"{contact.tare_n:.3g} N without contact",
                "the model would push or pull where nothing is touched", "import with --tare auto",
            )  # fmt: skip


def _surface_findings(met: Sequence[Met]) -> Iterator[Finding]:
    """Distinguish a zero that is not the surface from an object that is still dented.

    An object that has not recovered is met deeper, never less deep: where one recording begins at
    position 0, others that begin deeper do not say that the surface is elsewhere. To put each of
    them at 0 would take away what the object remembers.
    """
    off = [item for item in met if _is_off(*item, bounds=2.0)]
    if not off:
        return
    off = [item for item in met if _is_off(*item, bounds=0.0)]  # one that is sure is enough
    first = min(met, key=lambda item: item[1].position_m)
    where = off[0][0].name if len(off) == 1 else f"{len(off)} recordings"
    usual_m = float(np.median([contact.position_m for _, contact in off]))
    begins = f"force begins at {1e3 * usual_m:.3g} mm"
    if first in off:
        yield warning(
            "contact", where, f"{begins}, not at 0", "the surface is not where position is 0",
            "import with --contact-force auto",
        )  # fmt: skip
    else:
        yield warning(
            "contact", where, f"{begins}, in {first[0].name} at 0",
            "the object had not recovered there, or its zero was another",
            "import with --rest-s if one object was pressed in this order, with --contact-force "
            "auto if each recording has a zero of its own",
        )  # fmt: skip


def _is_off(recording: Recording, contact: ContactPoint, bounds: float) -> bool:
    allowed_m = _SURFACE_OFF * float(np.ptp(recording.position_m)) + bounds * contact.uncertainty_m
    return abs(contact.position_m) > allowed_m
