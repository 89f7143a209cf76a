"""Describe a map to the page: where its grid lies, and how finely the page surveys it."""

import math
from typing import Any

from springpot.emission import Plan

_ACROSS = 40  # steps of a survey along the longer side, at least: some 1600 presses
_CELLS = 16384  # as sp_page_survey_cells
_PRESS_S = 0.2


def map_entry(plan: Plan) -> dict[str, Any]:
    """Return the grid, m, and the survey of a scene with places: its places have every node.

    The object is pressed to depth_m within press_ticks at each of `survey` places, along x and y.
    """
    hammerstein = plan.model.hammerstein
    assert hammerstein is not None and hammerstein.places is not None
    places = hammerstein.places
    steps = [nodes - 1 for nodes in places.nodes]
    finer = max(1, math.ceil(_ACROSS / max(steps)))
    while finer > 1 and math.prod(finer * its + 1 for its in steps) > _CELLS:
        finer -= 1
    return {
        "first_m": places.first_m.tolist(),
        "last_m": places.last_m.tolist(),
        "nodes": list(places.nodes),
        "survey": [finer * its + 1 for its in steps],
        "depth_m": float(plan.range.max_m),
        "press_ticks": max(50, round(_PRESS_S / plan.dt_s)),
    }
