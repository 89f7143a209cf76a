"""Check whether force begins at position 0, where the surface should be."""

from collections.abc import Iterator, Sequence

import numpy as np

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.contact_point import ContactPoint, find_contact
from springpot.trainer.recordings.quality.contact.preload import (
    NEAR_ZERO,
    NOISES,
    Loaded,
    other_zero_findings,
    preload_findings,
)
from springpot.trainer.recordings.quality.contact.zeroed_under_load import (
    AirLevel,
    find_air_level,
    zeroed_findings,
)
from springpot.trainer.recordings.quality.finding import Finding, span, warning
from springpot.trainer.recordings.quality.motion import where_of
from springpot.trainer.recordings.quality.sign_evidence import first_n, noise_n
from springpot.trainer.recordings.recording import Recording

_PRELOAD = 0.05  # of the peak force, at the lowest position
_LOWEST = 0.005  # of the travel: where a motion seldom comes, the force there is the least
_SURFACE_OFF = 0.05  # of the travel

Met = tuple[Recording, ContactPoint]


def contact_findings(recordings: Sequence[Recording]) -> Iterator[Finding]:
    """Yield findings where position 0 should be the surface and is not, of all together."""
    met: list[Met] = []
    loaded: list[Loaded] = []
    in_air: list[tuple[Recording, AirLevel]] = []
    for recording in recordings:
        if recording.zero != "none" or np.ptp(recording.force_n) == 0.0:
            continue
        try:
            met.append((recording, find_contact(recording)))
        except DataError:  # at its lowest position it touches the surface, or is pressed already
            lowest_m, rest_n = _at_rest(recording)
            least_n = max(_PRELOAD * float(recording.force_n.max()), noise_n(recording.force_n))
            if (level := find_air_level(recording)) is not None:
                in_air.append((recording, level))
            elif abs(rest_n) > least_n:
                loaded.append((recording, rest_n))
            else:
                yield from _trigger_findings(recording, rest_n)
                doubt_m = _doubt_m(recording, lowest_m, rest_n)
                met.append((recording, ContactPoint(lowest_m, doubt_m, rest_n, np.inf)))
    yield from zeroed_findings(in_air, len(recordings))
    shown = [item for item, contact in met if not _is_off(item, contact)]
    rested = [item for item in met if _rests_on(*item, loaded)]
    met = [item for item in met if item not in rested]
    if shown:
        yield from other_zero_findings(loaded, shown)
    else:
        relaxed = [(item, max(contact.tare_n, 0.0)) for item, contact in rested]
        yield from preload_findings(loaded + relaxed)
    # An object that remembers its last press is met where that left it.
    yield from _surface_findings([item for item in met if not item[0].start_s])
    for recording, contact in met:
        if abs(contact.tare_n) > max(3 * contact.threshold_n, 0.02 * recording.force_n.max()):
            yield warning(
                "tare", recording.name, f"{contact.tare_n:.3g} N without contact",
                f"the model would {'push' if contact.tare_n > 0.0 else 'pull'} where nothing is "
                "touched",
                "import with --tare auto",
            )  # fmt: skip


def _surface_findings(met: Sequence[Met]) -> Iterator[Finding]:
    """Distinguish a zero that is not the surface from an object that is still dented.

    An object that has not recovered is met deeper, never less deep: where one recording begins at
    position 0, others that begin deeper do not say that the surface is elsewhere. To put each of
    them at 0 would take away what the object remembers.
    """
    sure = [contact for item, contact in met if _is_off(item, contact)]
    off = [item for item in met if _is_off(*item) or _may_be_off(*item, sure)]
    if not off:
        return
    fresh, _ = first = min(met, key=lambda item: item[1].position_m)
    none_at_0 = first in off
    if not none_at_0:  # what begins pressed shows no surface, and needs none beside it
        off = [item for item in off if not _begins_pressed(*item)]
    if not off:
        return
    where = where_of([item for item, _ in off])
    places_mm = span([1e3 * contact.position_m for _, contact in off])
    if len(off) == 1:
        places_mm += f" +- {1e3 * off[0][1].uncertainty_m:.2g}"
    if none_at_0:
        so_what, to_do = _elsewhere(off)
        yield warning("contact", where, f"force begins at {places_mm} mm, not at 0", so_what, to_do)
    else:
        yield warning(
            "contact", where, f"force begins at {places_mm} mm, in {fresh.name} at 0",
            "the object had not recovered there, or its zero was another",
            "import with --rest-s if one object was pressed in this order, with --contact-force "
            "auto if each recording has a zero of its own",
        )  # fmt: skip


def _trigger_findings(recording: Recording, rest_n: float) -> Iterator[Finding]:
    """Yield a finding if a test begins at position 0 with a force already, and ends without."""
    begins_n = _begins_n(recording, rest_n)
    at_zero = abs(recording.position_m[0]) <= NEAR_ZERO * float(np.ptp(recording.position_m))
    if at_zero and begins_n > 0.0:
        yield warning(
            "contact", recording.name, f"begins at position 0 with {begins_n:.3g} N",
            "perhaps a trigger's: the surface is farther out, and the force would jump there",
            "record from above the object, or with a lower trigger",
        )  # fmt: skip


def _begins_n(recording: Recording, rest_n: float) -> float:
    """Force above `rest_n` that a recording begins with, N; 0 within its noise."""
    begins_n = first_n(recording.position_m, recording.force_n) - rest_n
    noisy_n = NOISES * noise_n(recording.force_n)
    return begins_n if begins_n > max(_PRELOAD * float(recording.force_n.max()), noisy_n) else 0.0


def _begins_pressed(recording: Recording, contact: ContactPoint) -> bool:
    return contact.threshold_n == np.inf and _begins_n(recording, contact.tare_n) > 0.0


def _rests_on(recording: Recording, contact: ContactPoint, loaded: Sequence[Loaded]) -> bool:
    """Whether it relaxed to nearly no force at a lowest position where another one pushes."""
    deep_m = contact.position_m + NEAR_ZERO * float(np.ptp(recording.position_m))
    pushing_m = [item.position_m.min() for item, rest_n in loaded if rest_n > 0.0]
    return (
        contact.threshold_n == np.inf
        and _is_off(recording, contact)
        and any(lowest_m <= deep_m for lowest_m in pushing_m)
    )


def _elsewhere(off: Sequence[Met]) -> tuple[str, str]:
    """Say what follows if force begins elsewhere than at position 0, and what to do about it."""
    so_what, to_do = "the surface is not where position is 0", "import with --contact-force auto"
    if any(contact.threshold_n == np.inf for _, contact in off):  # nor would import find it
        return so_what, "record from above the object, or take its place off the position"
    if all(item.force_n[0] > found.tare_n + found.threshold_n for item, found in off):
        # Pressed before it was met, an object may be dented.
        return f"{so_what}, or the object had not recovered", f"if its zero is wrong, {to_do}"
    return so_what, to_do


def _is_off(recording: Recording, contact: ContactPoint) -> bool:
    allowed_m = _SURFACE_OFF * float(np.ptp(recording.position_m)) + 2 * contact.uncertainty_m
    return abs(contact.position_m) > allowed_m


def _may_be_off(recording: Recording, contact: ContactPoint, sure: Sequence[ContactPoint]) -> bool:
    """Whether its bounds meet those of one that is off, and are about no surface at 0."""
    return abs(contact.position_m) > _SURFACE_OFF * float(np.ptp(recording.position_m)) and any(
        abs(contact.position_m - other.position_m) <= contact.uncertainty_m + other.uncertainty_m
        for other in sure
    )


def _doubt_m(recording: Recording, lowest_m: float, rest_n: float) -> float:
    """How far above the lowest position the surface may be, m, of a tool that rests on it.

    No higher than where force passes 5 % of its range; and the line through that and 15 % leads
    back to the lowest position, if force is the object's: friction jumps where the tool sets off.
    """
    risen_n = recording.force_n - rest_n
    first_m, then_m = (
        float(recording.position_m[risen_n > share * float(risen_n.max())].min())
        for share in (_PRELOAD, 3.0 * _PRELOAD)
    )
    return max(first_m - lowest_m, abs(first_m - (then_m - first_m) / 2.0 - lowest_m))


def _at_rest(recording: Recording) -> tuple[float, float]:
    """Lowest position, m, and the median force about there, N."""
    lowest_m = float(recording.position_m.min())
    near = recording.position_m <= lowest_m + _LOWEST * float(np.ptp(recording.position_m))
    return lowest_m, float(np.median(recording.force_n[near]))
