"""What recordings say about the numbers of a fractional solid, and what they do not say.

A number that other values fit nearly as well is not quoted with an interval: it is named, with what
to record so that it would be known.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from springpot import Recording
from springpot.basics import Samples
from springpot.host.wings.material.law.fractional_solid import Solid
from springpot.host.wings.material.law.material import jackknife
from springpot.modelling import Coverage, find_coverage, find_cycles

_NEARLY = 1.02  # of the lowest RMS error
_ORDER_STEP = 3e-4  # to which the search for the order is carried
_BRANCHED = 5e-4  # of a stiffness: a sum of branches is the law within this
_PRELOAD = 0.02  # of the force's range, in the first sample
_RISING = 0.2  # of the mean stiffness: less is free air, in which a cell's offset is no load
_START = 0.05  # of the travel, about the first sample
_WIDEST_ORDER = 0.1  # half an interval
_WIDEST_SHARE = 0.2  # of the stiffness that was recorded, half an interval
_WIDER = "record a wider range of speeds, and longer holds"
_SINE = 0.95  # of the position's variance, at one frequency
_ENDS = (0.03, 0.97)
_HOLD = 10.0  # times the longest stroke: a hold that long shows relaxation without a second speed
_NAMES = ("stiffness_npm", "coefficient", "order", "instant_npm")


def law_metadata(
    solid: Solid,
    others: Sequence[Solid],
    profile: tuple[Samples, Samples],
    sizes_n: tuple[float, float, float],
    recordings: Sequence[Recording],
) -> dict[str, Any]:
    """Return provenance of a law, JSON values.

    others: fits that leave out one part each. profile: orders and the RMS error of each, N.
    sizes_n: RMS of force, of what the law misses, and of its rate dependence.
    """
    names = [name for name in _NAMES if getattr(solid, name) is not None]
    left_out = [[getattr(other, name) for name in _NAMES] for other in others]
    widths = {
        name: float(jackknife(np.array([getattr(other, name) for other in others])))
        for name in names
    }
    near = profile[0][profile[1] <= _NEARLY * profile[1].min()]
    low, high = float(near.min()), float(near.max())
    widths["order"] = max(widths["order"], (high - low) / 2)
    for name, width in widths.items():  # no narrower than the fit's own grid and branches
        rounding = _ORDER_STEP if name == "order" else _BRANCHED * abs(getattr(solid, name))
        widths[name] = float(np.hypot(width, rounding))
    coverage = find_coverage(recordings)
    unidentified = _unidentified(solid, widths, (low, high), sizes_n, coverage)
    if before := _unseen_before(recordings):
        unidentified = dict.fromkeys(names, before) | unidentified
    return {
        "n_parameters": len(names) + (solid.bias_n != 0.0),
        "material": {
            name: [getattr(solid, name), None if name in unidentified else widths[name]]
            for name in names
        },
        "left_out": left_out,
        "not_identified": unidentified,
        "residual_n": sizes_n[1],
        "residual_percent": 100.0 * sizes_n[1] / sizes_n[0] if sizes_n[0] else 0.0,
        "measured": _dynamic_points(recordings),
        "covered_hz": list(coverage.band_hz),
    }


def _dynamic_points(recordings: Sequence[Recording]) -> list[dict[str, float]]:
    """Return storage and loss, N/m, that cyclic recordings show, in order of frequency.

    Ramps with holds have many frequencies at once: what they lose in a cycle is no modulus of one.
    """
    found = [
        cycles
        for cycles in map(find_cycles, recordings)
        if cycles is not None and cycles.tone_share >= _SINE
    ]
    return [
        {
            "frequency_hz": cycles.frequency_hz,
            "storage_npm": cycles.stiffness_npm * float(np.cos(cycles.lead_rad)),
            "loss_npm": cycles.stiffness_npm * float(np.sin(cycles.lead_rad)),
        }
        for cycles in sorted(found, key=lambda cycles: cycles.frequency_hz)
    ]


def _unseen_before(recordings: Sequence[Recording]) -> str:
    """Say that a recording begins in a pressed object, whose memory of it is not known; or ""."""
    for recording in recordings:
        x, f = recording.position_m, recording.force_n
        load_n = float(f[0]) + float(recording.details.get("zero_force_n", 0.0))
        near = np.abs(x - x[0]) <= _START * np.ptp(x)
        if abs(load_n) <= _PRELOAD * np.ptp(f) or np.ptp(x[near]) == 0.0:
            continue
        slope = np.polyfit(x[near] - x[0], f[near], 1)[0]
        if slope > _RISING * np.ptp(f) / np.ptp(x):
            return (
                f"{recording.name} begins under {load_n:.3g} N, and the object still relaxes from "
                "what came before: record from before contact, or after a rest of ten recordings"
            )
    return ""


def _unidentified(
    solid: Solid,
    widths: dict[str, float],
    near: tuple[float, float],
    sizes_n: tuple[float, float, float],
    coverage: Coverage,
) -> dict[str, str]:
    """Name of each number that the recordings do not show, and why."""
    slowest_s, fastest_s = (1.0 / (2.0 * np.pi * hz) for hz in coverage.band_hz)
    why = _order_unidentified(solid, widths["order"], near, sizes_n, coverage)
    beyond = solid.time_s is not None and not fastest_s < solid.time_s < slowest_s
    if beyond and not why:
        why = (
            f"its relaxation time, {solid.time_s:.3g} s, lies beyond what the recordings hold "
            f"({fastest_s:.2g} to {slowest_s:.2g} s): {_WIDER}"
        )
    unidentified = {"order": why, "coefficient": why} if why else {}
    stiffness_npm = solid.dynamic_npm(coverage.band_hz[0])
    if why or widths["stiffness_npm"] > _WIDEST_SHARE * stiffness_npm:
        unidentified["stiffness_npm"] = why or "no hold is long enough to show it: hold longer"
    instant_npm = solid.instant_npm
    if instant_npm is not None and widths["instant_npm"] > _WIDEST_SHARE * instant_npm:
        unidentified["instant_npm"] = "no press is fast enough to show it: press faster"
    return unidentified


def _order_unidentified(
    solid: Solid,
    width: float,
    near: tuple[float, float],
    sizes_n: tuple[float, float, float],
    coverage: Coverage,
) -> str:
    _, missed_n, rate_n = sizes_n
    if coverage.one_speed and coverage.longest_hold_s < _HOLD * coverage.longest_stroke_s:
        return f"one speed of pressing only: {coverage.record_next[0]}"
    if not _ENDS[0] < solid.order < _ENDS[1]:
        return f"{solid.order:.2f} is the end of its range: this law is not the object's"
    if rate_n < missed_n:
        return (
            f"the law misses {missed_n:.3g} N rms, more than its rate dependence of {rate_n:.3g} "
            "N: record smaller depths, where the object is linear"
        )
    if width > _WIDEST_ORDER:
        low, high = min(near[0], solid.order - width), max(near[1], solid.order + width)
        return f"{max(low, 0.0):.2f} to {min(high, 1.0):.2f} fit nearly as well: {_WIDER}"
    return ""
