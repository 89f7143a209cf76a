"""Protocols of an object that is pressed at many places, `[places]` of a file."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import dist
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from annotated_types import Interval, Len
from pydantic import TypeAdapter

from springpot import UsageError
from springpot.console import checked_keys
from springpot.simulation import Profile, load_protocol

_SHORT_HZ = (0.5, 5.0)  # of the presses to the deepest force: enough for the amount of a place
_Metre = Annotated[float, Interval(ge=-1, le=1)]
_Length = Annotated[float, Interval(gt=0, le=1)]
_Site = tuple[float, float]


@dataclass(frozen=True)
class PlacesTable:
    """Keys of `[places]`: m, and how many sites are pressed fully, and how many shortly.

    sites: "spread" over span_m from 0, 0 on, or a list of x and y.
    """

    __pydantic_config__ = {"extra": "forbid"}  # noqa: RUF012, the name that pydantic asks for
    full: Annotated[int, Interval(ge=1, le=400)] = 5
    short: Annotated[int, Interval(ge=0, le=400)] | None = None
    span_m: tuple[_Length, _Length] | None = None
    sites: Literal["spread"] | Annotated[list[tuple[_Metre, _Metre]], Len(4, 400)] = "spread"


_ADAPTER = TypeAdapter(PlacesTable)


def places_protocol(content: dict[str, Any], path: Path, seed: int) -> list[Profile]:
    """The paper's presses at some sites, and two of them at the others.

    The first sites lie far apart, and are pressed fully. Raises UsageError naming what is wrong.
    """
    if beside := sorted(set(content) - {"places"}):
        raise UsageError(f"{path}: {beside[0]}: [places] stands alone in a protocol")
    text = json.dumps(content["places"])
    keys = list(PlacesTable.__dataclass_fields__)
    table = checked_keys(_ADAPTER, text, f"{path}: places", lambda _place: keys)
    sites = _far_first(_sites(table, path))
    presses = load_protocol("paper", seed)
    deepest_n = max(press.metadata["amplitude_n"] for press in presses)
    few = [
        press for press in presses
        if press.metadata["amplitude_n"] == deepest_n
        and press.metadata["frequency_hz"] in _SHORT_HZ
    ]  # fmt: skip
    found = []
    for number, site in enumerate(sites, start=1):
        its = presses if number <= table.full else few
        found += [replace(press, name=f"{number:03d}-{press.name}", place_m=site) for press in its]
    return found


def _sites(table: PlacesTable, path: Path) -> list[_Site]:
    """The sites of a table, (x, y), m, each once."""
    if table.sites != "spread":
        if table.span_m is not None or table.short is not None:
            raise UsageError(f"{path}: places: with a list of sites leave span_m and short out")
        return list(dict.fromkeys(table.sites))
    if table.span_m is None:
        raise UsageError(f"{path}: places: span_m is missing: give it, or a list of sites")
    count = table.full + (20 if table.short is None else table.short)
    if count < 4:
        raise UsageError(f"{path}: places: {count} sites: a map needs four or more")
    return _rows(count, *table.span_m)


def _rows(count: int, wide_m: float, high_m: float) -> list[_Site]:
    """Sites in rows, as square a grid as there is for so many."""
    rows = max(2, round(np.sqrt(count * high_m / wide_m)))
    found = []
    for row, y_m in enumerate(np.linspace(0.0, high_m, rows).tolist()):
        its = count * (row + 1) // rows - count * row // rows
        found += [(x_m, y_m) for x_m in np.linspace(0.0, wide_m, its).tolist()]
    return found


def _far_first(sites: Sequence[_Site]) -> list[_Site]:
    """The sites, the middle one first, and each next one farthest from those before."""
    middle = tuple(np.mean(sites, axis=0).tolist())
    order = [min(sites, key=lambda site: dist(site, middle))]
    while len(order) < len(sites):
        left = [site for site in sites if site not in order]
        order.append(max(left, key=lambda site: min(dist(site, known) for known in order)))
    return order
