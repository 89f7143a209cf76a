"""The place on the surface that a recording pressed: one each, since a model is of presses."""

from collections.abc import Callable, Sequence
from math import dist

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import PLACE, split_unit
from springpot.trainer.recordings.formats.units import factor_to_si
from springpot.trainer.recordings.recording import Recording

SAME_PLACE_M = 1e-4  # no printed grid and no stage is finer

Site = tuple[float, float]  # x and y, m


def place_m(
    where: str,
    header: Sequence[str],
    read: Callable[[int], Samples],
    names: tuple[str, str] = PLACE,
    below: Sequence[str] = (),
) -> tuple[float, float] | None:
    """Return x and y of the place that two columns state, m; None without them.

    read: the numbers of a column, (n,). below: the row of units. A stage that trembles stays.
    Raises DataError for one column alone, and if the tool moves along the surface.
    """
    labels = [split_unit(cell, "position") for cell in header]
    found_m = []
    for name in names:
        for k, (label, own) in enumerate(labels):
            if name.casefold() in (label.casefold(), header[k].casefold()):
                unit = own or "".join(below[k : k + 1]).strip("()[]{} ")
                factor = factor_to_si(unit, "position", f"{where}, column {header[k]!r}")
                found_m.append(read(k) * factor)
    if not found_m:
        return None
    if len(found_m) != 2:
        raise DataError(f"{where}: {' and '.join(names)} belong together: give one column of each")
    if np.ptp(found_m, axis=1).max() > SAME_PLACE_M:
        raise DataError(
            f"{where}: the tool moves along the surface, and a model is of presses of one place "
            "each: cut it into one file a place"
        )
    x_m, y_m = np.median(found_m, axis=1).tolist()
    return x_m, y_m


def sites_of(recordings: Sequence[Recording]) -> dict[Site, list[int]]:
    """Numbers of the recordings of each site, in the order of recording.

    Recordings without a place are of no site.
    """
    sites: dict[Site, list[int]] = {}
    for number, recording in enumerate(recordings):
        if recording.place_m is not None:
            here = recording.place_m
            known = next((site for site in sites if dist(site, here) < SAME_PLACE_M), here)
            sites.setdefault(known, []).append(number)
    return sites


def site_words(site: Site) -> str:
    """Write a site as messages show it, in mm."""
    return f"({1e3 * site[0]:.4g}, {1e3 * site[1]:.4g}) mm"
