"""Places at which an object was pressed: too near each other, or of repeats that disagree."""

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import dist

from springpot.codegen.plurals import number_of
from springpot.trainer.recordings.places import SAME_PLACE_M
from springpot.trainer.recordings.quality.finding import Finding, refusal, warning
from springpot.trainer.recordings.quality.repeats import Repeats
from springpot.trainer.recordings.recording import Recording

_NEAR = 0.25  # of the usual distance to the nearest other site
_DISAGREE = 0.05  # of the peak force: more is another place or object

Site = tuple[float, float]


def sites_of(recordings: Sequence[Recording]) -> dict[Site, list[int]]:
    """Numbers of the recordings of each site, x and y in m, in the order of recording.

    Recordings without a place are of no site.
    """
    sites: dict[Site, list[int]] = {}
    for number, recording in enumerate(recordings):
        if recording.place_m is not None:
            here = recording.place_m
            known = next((site for site in sites if dist(site, here) < SAME_PLACE_M), here)
            sites.setdefault(known, []).append(number)
    return sites


def place_findings(
    recordings: Sequence[Recording], repeats: Sequence[Repeats]
) -> Iterator[Finding]:
    """Yield what is wrong with places, and repeats, those of the set, that no one place gives."""
    yield from _disagreeing(repeats)
    sites = sites_of(recordings)
    if not sites:
        return
    without = [press.name for press in recordings if press.place_m is None]
    if without:
        yield refusal(
            "places", without[0],
            f"{number_of(len(without), 'recording')} without a place, others have one",
            "a map needs the place of each press",
            "give it on import, --place X,Y, or leave those recordings out",
        )  # fmt: skip
    yield from _near(list(sites))


def _disagreeing(repeats: Sequence[Repeats]) -> Iterator[Finding]:
    for group in repeats:
        if group.noise_n <= _DISAGREE * group.peak_n:
            continue
        differ = f"{group.names[0]} and {group.names[-1]} differ by {group.noise_n:.2g} N rms"
        if group.place_m:
            yield warning(
                "places", site_words(group.place_m), differ,
                "the object moved or changed between them, or a place is wrong",
                "record that site again, and check the place of each",
            )  # fmt: skip
        else:
            yield warning(
                "places", f"{len(group.names)} presses of one motion", differ,
                "one model is fitted to all of them, and is right for none",
                "if they are of several places of an object, import each with its --place X,Y, or "
                "all with the columns that say it, --place COL,COL; of several objects, train each "
                "alone; of one, condition it by some cycles first",
            )  # fmt: skip


def site_words(site: Site) -> str:
    """Write a site as messages show it, in mm."""
    return f"({1e3 * site[0]:.4g}, {1e3 * site[1]:.4g}) mm"


def _near(sites: list[Site]) -> Iterator[Finding]:
    nearest = [
        min((dist(site, other) for other in sites if other != site), default=0.0) for site in sites
    ]
    usual_m = sorted(nearest)[len(nearest) // 2]
    for one, other in combinations(sites, 2):
        if dist(one, other) < _NEAR * usual_m:
            yield warning(
                "places", f"{site_words(one)} and {site_words(other)}",
                f"{1e3 * dist(one, other):.2g} mm apart where sites are {1e3 * usual_m:.2g} mm",
                "a map cannot follow both, and a registration error looks like a change",
                "correct the place, or leave one of them out",
            )  # fmt: skip
