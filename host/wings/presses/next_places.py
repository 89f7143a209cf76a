"""Places to press next on an object with a map: between neighbours that differ most."""

import shlex
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, QhullError

from springpot import Model, Recording, UsageError
from springpot.basics import write_file

COUNT = 6  # places to press before the map is looked at again
_NEAREST_M = 2e-3  # of two places: what a place is off by on a rig is a quarter of that
_Places = NDArray[np.float64]


def next_places(sites_m: _Places, worth: NDArray[np.float64], count: int = COUNT) -> _Places:
    """Return places, (count, 2), m, that tell most about a map.

    sites_m: of those recorded, (n, 2). worth: how stiff the object is at each, (n,). Each place is
    the middle of the triangle of neighbours with the greatest range of worth times the root of its
    area: a lump is looked at more closely, level ground where the sites are far apart. Fewer, or
    none, where sites are too near each other or in one line.
    """
    known_m, known = list(sites_m), list(worth)
    level = 0.05 * float(np.mean(np.abs(worth)))  # so that level ground counts too
    for _ in range(count):
        try:
            corners = Delaunay(np.array(known_m)).simplices
        except QhullError:
            break
        at_m, its = np.array(known_m)[corners], np.array(known)[corners]
        sides_m = np.linalg.norm(at_m - np.roll(at_m, 1, axis=1), axis=2)
        across, along = at_m[:, 1] - at_m[:, 0], at_m[:, 2] - at_m[:, 0]
        area_m2 = 0.5 * np.abs(across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0])
        score = (np.ptp(its, axis=1) + level) * np.sqrt(area_m2)
        score[sides_m.max(axis=1) < 2.0 * _NEAREST_M] = 0.0
        best = int(np.argmax(score))
        if not score[best] > 0.0:
            break
        known_m.append(at_m[best].mean(axis=0))
        known.append(float(its[best].mean()))
    return np.array(known_m[len(sites_m) :]).reshape(-1, 2)


def places_of(recordings: Sequence[Recording], model: Model) -> _Places:
    """Places to press next for a model with a map, (n, 2), m; none for another model."""
    law = model.hammerstein
    sites = list(dict.fromkeys(each.place_m for each in recordings if each.place_m is not None))
    if law is None or law.places is None or not sites:
        return np.zeros((0, 2))
    worth = [float(np.sum(law.places.mixed_n(site))) for site in sites]
    return np.round(next_places(np.array(sites), np.array(worth)), 4)


def write_places(path: Path, places_m: _Places) -> None:
    """Write a protocol of these places. Raises UsageError where the file cannot be written."""
    sites = ", ".join(f"[{x:g}, {y:g}]" for x, y in places_m)
    write_lines(path, ["[places]", "full = 1", f"sites = [{sites}]"])


def places_words(places_m: _Places, path: Path | None) -> str:
    """Name the places, and what to do with them."""
    named = ", ".join(f"({1e3 * x:g}, {1e3 * y:g})" for x, y in places_m)
    how = (
        "--next FILE.toml writes them as a protocol for springpot record"
        if path is None
        else f"springpot record --protocol {shlex.quote(str(path))} --device URL --out FOLDER"
    )
    return f"at {named} mm, between neighbours that differ most\n{how}"


def write_lines(path: Path, lines: Sequence[str]) -> None:
    """Write a protocol. Raises UsageError where the file cannot be written."""
    head = "# springpot record --device URL --protocol THIS_FILE.toml --out FOLDER"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_file(path, ("\n".join([head, *lines]) + "\n").encode())
    except OSError as error:
        raise UsageError(
            f"--next {path}: {error.strerror}: give a file that can be written"
        ) from None
