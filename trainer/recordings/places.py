"""The place on the surface that a recording pressed: one each, since a model is of presses."""

from collections.abc import Sequence
from math import dist

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.recording import Recording

SAME_PLACE_M = 1e-4  # what no printed grid and no stage tells apart

Site = tuple[float, float]  # x and y, m


def require_one_place(name: str, path_m: Samples) -> tuple[float, float]:
    """Return x and y of the place where the tool stays, m; a stage that trembles stays.

    path_m: x and y of each sample, (n, 2). Raises DataError if the tool moves along the surface.
    """
    spans_m = np.ptp(path_m, axis=0)
    if spans_m.max() > SAME_PLACE_M:
        ways = ", ".join(
            f"{axis} {1e3 * along.min():.4g} to {1e3 * along.max():.4g} mm"
            for axis, along in zip("xy", path_m.T, strict=True)
        )
        raise DataError(
            f"{name}: the tool moves along the surface ({ways}), and a model is of presses of one "
            "place each: cut it into one file a place"
        )
    x_m, y_m = np.median(path_m, axis=0).tolist()
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
