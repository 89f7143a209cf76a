"""Presses at a grid of places: the paper's at the corners and in the middle, two at the others."""

from dataclasses import replace

import numpy as np

from springpot.host.recording.protocols import Profile, load_protocol


def grid_profiles(side: int, span_m: float = 0.03) -> list[Profile]:
    """Profiles at side x side places from (0, 0) to (span_m, span_m)."""
    at_m = np.linspace(0.0, span_m, side).tolist()
    sites = [(x_m, y_m) for y_m in at_m for x_m in at_m]
    full = {(x_m, y_m) for x_m in (at_m[0], at_m[-1]) for y_m in (at_m[0], at_m[-1])}
    full.add((at_m[side // 2], at_m[side // 2]))
    whole = load_protocol("paper", 0)
    short = [press for press in whole[-9:] if press.metadata["frequency_hz"] in (0.5, 5.0)]
    return [
        replace(press, name=f"{number:03d}-{press.name}", place_m=site)
        for number, site in enumerate(sites, start=1)
        for press in (whole if site in full else short)
    ]
