"""Mistakes in files of recordings: a wrong unit, sign or column, or a fault of the rig."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from support.files.recording_files import Samples, recorded

Columns = tuple[Samples, Samples, Samples]  # time in s, position in mm, force in N
_HEIGHT_MM = 20.0


def mistaken(facts: Mapping[str, Any], name: str, mistake: Mapping[str, Any]) -> str:
    """The text of a file whose header says time_s, position_mm, force_N."""
    time_s, position_m, force_n = recorded(facts)
    position = position_m * 1e3
    if name in FAULTS:
        columns = FAULTS[name]((time_s, position, force_n))
    else:
        by_height = float(mistake.get("position_by_height", 0.0)) / _HEIGHT_MM
        columns = (
            time_s * mistake.get("time", 1.0),
            position * (by_height or mistake.get("position", 1.0)),
            force_n * mistake.get("force", 1.0),
        )
    lines = [f"{t:.9g},{x:.8g},{f:.8g}" for t, x, f in zip(*columns, strict=True)]
    return "\n".join(["time_s,position_mm,force_N", *lines, ""])


def _shifted(samples: Samples, count: int) -> Samples:
    return np.interp(np.arange(len(samples)) - count, np.arange(len(samples)), samples)


def _with(samples: Samples, where: Any, value: float) -> Samples:
    changed = samples.copy()
    changed[where] = value
    return changed


def _in_order(c: Columns, rows: Any) -> Columns:
    return (c[0][rows], c[1][rows], c[2][rows])


def _held(c: Columns) -> Columns:
    rows = np.arange(len(c[0]))
    for begin in (300, 900, 1500):
        rows[begin : begin + 20] = begin
    return c[0], c[1][rows], c[2][rows]


def _backlash(position: Samples, play: float) -> Samples:
    """A sensor that follows the tool only beyond the play of its gear."""
    followed = position.copy()
    for k in range(1, len(position)):
        low, high = position[k] - play, position[k]
        followed[k] = min(max(followed[k - 1], low), high)
    return followed


def _inertia(c: Columns) -> Samples:
    """Force of a mass that is as great as a quarter of the peak at the fastest turn."""
    acceleration = np.gradient(np.gradient(c[1], c[0]), c[0])
    return acceleration * (0.25 * float(c[2].max()) / float(np.abs(acceleration).max()))


def _low_passed(samples: Samples, count: float) -> Samples:
    """First order, with a time constant of so many samples."""
    found = samples.copy()
    for k in range(1, len(samples)):
        found[k] = found[k - 1] + (samples[k] - found[k - 1]) / count
    return found


FAULTS: dict[str, Callable[[Columns], Columns]] = {
    "swapped": lambda c: (c[0], c[2], c[1]),
    "gap": lambda c: (c[0], 30.0 - c[1], c[2]),
    "late": lambda c: (c[0], c[1], _shifted(c[2], 8)),
    "early": lambda c: (c[0], c[1], _shifted(c[2], -4)),
    "compliance": lambda c: (c[0], c[1] + c[2] * (0.3 * np.ptp(c[1]) / np.ptp(c[2])), c[2]),
    "force_spike": lambda c: (c[0], c[1], _with(c[2], 11, 25.0 * float(c[2].max()))),
    "position_spike": lambda c: (c[0], _with(c[1], 700, 12.0 * float(c[1].max())), c[2]),
    "tare": lambda c: (c[0], c[1], c[2] + 0.15 * float(c[2].max())),
    "zero": lambda c: (c[0], c[1] + 0.4 * np.ptp(c[1]), c[2]),
    "clipped": lambda c: (c[0], c[1], np.minimum(c[2], 0.4 * float(c[2].max()))),
    "coarse": lambda c: (c[0], c[1], np.round(c[2] / c[2].max() * 12) * c[2].max() / 12),
    "held": _held,
    "restarts": lambda c: (np.where(c[0] < 5.0, c[0], c[0] - 5.0), c[1], c[2]),
    "shuffled": lambda c: _in_order(c, np.random.default_rng(2).permutation(len(c[0]))),
    "doubled_rows": lambda c: _in_order(c, np.repeat(np.arange(len(c[0])), 2)),
    "cut_out": lambda c: _in_order(c, np.delete(np.arange(len(c[0])), slice(600, 900))),
    "no_decimals": lambda c: (c[0], np.round(c[1]), c[2]),
    "dead_force": lambda c: (c[0], c[1], np.zeros(len(c[0]))),
    "dropouts": lambda c: (c[0], c[1], _with(c[2], np.r_[400:402, 900:902, 1710:1712], 0.0)),
    "wrapped": lambda c: (c[0], np.mod(c[1], 0.6 * np.ptp(c[1])), c[2]),
    "backlash": lambda c: (c[0], _backlash(c[1], 0.15 * float(np.ptp(c[1]))), c[2]),
    "mass": lambda c: (c[0], c[1], c[2] + _inertia(c)),
    "nan_row": lambda c: (c[0], c[1], _with(c[2], 500, np.nan)),
    "hum": lambda c: (c[0], c[1], c[2] + 0.05 * c[2].max() * np.sin(2.0 * np.pi * 50.1 * c[0])),
    "saturated_position": lambda c: (c[0], np.minimum(c[1], 0.6 * float(c[1].max())), c[2]),
    "filtered": lambda c: (c[0], c[1], _low_passed(c[2], 10.0)),
    "drift": lambda c: (c[0], c[1], c[2] + 0.25 * c[2].max() * c[0] / c[0][-1]),
}
