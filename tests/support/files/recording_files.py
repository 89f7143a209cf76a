"""Files of recordings, built from stated facts: a pressed object, a motion, a table's layout."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]
_RELAXES_S = (0.1, 1.0)
_CELLS = {"t": "{:.6f}", "x": "{:.7g}", "f": "{:.7g}", "n": "{:.0f}", "0": "{:.1f}"}


@dataclass(frozen=True)
class PressedObject:
    """A stiffening object that relaxes: force of its peak at its stroke, pressed slowly.

    loss: share of the force that relaxes, in two Maxwell branches.
    """

    stroke_m: float
    peak_n: float
    power: float = 1.6
    loss: float = 0.3

    def force(self, position_m: Samples, dt_s: float) -> Samples:
        """Force along a motion, N; each branch is stepped exactly for a ramp between samples."""
        elastic_n = self.peak_n * (np.maximum(position_m, 0.0) / self.stroke_m) ** self.power
        force_n = (1.0 - self.loss) * elastic_n
        for relaxes_s in _RELAXES_S:
            keep = float(np.exp(-dt_s / relaxes_s))
            gain = relaxes_s / dt_s * (1.0 - keep)
            held_n, branch_n = 0.0, np.zeros_like(elastic_n)
            for k, step_n in enumerate(np.diff(elastic_n), 1):
                held_n = keep * held_n + gain * step_n
                branch_n[k] = held_n
            force_n += self.loss * branch_n
        return np.maximum(force_n, 0.0)


def motion(kind: str, stroke_m: float, rate_hz: float, seconds: float) -> Samples:
    """Positions from 0: cycles of three speeds, one press that is held, or one ramp in and out."""
    time_s = np.arange(round(rate_hz * seconds)) / rate_hz
    share = time_s / seconds
    if kind == "cycles":  # one cycle in the first 60 %, two in the next 30, two in the last 10
        turns = np.interp(share, (0.0, 0.6, 0.9, 1.0), (0.0, 1.0, 3.0, 5.0))
        return 0.5 * stroke_m * (1.0 - np.cos(2.0 * np.pi * turns))
    knots = {"hold": (0.05, 0.2, 0.8, 0.95), "ramp": (0.05, 0.5, 0.5, 0.95)}[kind]
    return np.interp(share, knots, (0.0, stroke_m, stroke_m, 0.0))


def _motion(facts: Mapping[str, Any]) -> Samples:
    kind, seconds = facts.get("motion", "cycles"), float(facts.get("seconds", 10.0))
    return motion(kind, facts["stroke_mm"] * 1e-3, float(facts.get("rate_hz", 200.0)), seconds)


def pressed_object(facts: Mapping[str, Any]) -> PressedObject:
    """The object with a force of the stated peak along the stated motion."""
    stroke_m, peak_n = facts["stroke_mm"] * 1e-3, float(facts["peak_n"])
    dt_s = 1.0 / float(facts.get("rate_hz", 200.0))
    found_n = PressedObject(stroke_m, 1.0).force(_motion(facts), dt_s).max()
    return PressedObject(stroke_m, peak_n / float(found_n))


def recorded(facts: Mapping[str, Any]) -> tuple[Samples, Samples, Samples]:
    """Time, position and force that the stated rig has recorded, in SI units."""
    rate_hz = float(facts.get("rate_hz", 200.0))
    position_m = _motion(facts)
    force_n = pressed_object(facts).force(position_m, 1.0 / rate_hz)
    force_n += np.random.default_rng(1).normal(0.0, facts.get("noise_n", 0.0), len(force_n))
    time_s = np.arange(len(force_n)) / rate_hz + facts.get("begins_s", 0.0)
    return time_s, position_m, force_n


def table(facts: Mapping[str, Any]) -> str:
    """The text of a file: lines above, header, units, rows; a column is a channel and its unit.

    "x 1e-3" is the position in mm, "f -1" the force turned round, "n" the row's number, "0" zeros,
    a word in quotes stands in each row.
    """
    channels = dict(zip("txf", recorded(facts), strict=True))
    count = len(channels["t"])
    channels |= {"n": np.arange(count, dtype=float), "0": np.zeros(count)}
    mark, comma = facts.get("delimiter", ","), facts.get("decimal_comma", False)
    columns = [_column(text, channels, comma, facts) for text in facts["columns"]]
    rows = [mark.join(row) + facts.get("row_end", "") for row in zip(*columns, strict=True)]
    for row, text in facts.get("glitches", []):
        rows[row] = text
    above = [*facts.get("above", [])]
    above += [mark.join(facts[key]) for key in ("header", "units") if key in facts]
    return facts.get("line_end", "\n").join([*above, *rows, *facts.get("below", []), ""])


def _column(
    text: str, channels: Mapping[str, Samples], comma: bool, facts: Mapping[str, Any]
) -> Sequence[str]:
    if text.startswith("'"):
        return [text.strip("'")] * len(channels["t"])
    channel, _, unit = text.partition(" ")
    form = facts.get("cells", {}).get(channel, _CELLS[channel])
    cells = [form.format(value) for value in channels[channel] / float(unit or 1.0)]
    return [cell.replace(".", ",") for cell in cells] if comma else cells


def write_table(path: Path, facts: Mapping[str, Any]) -> None:
    """Write the file in its encoding."""
    path.write_bytes(table(facts).encode(facts.get("encoding", "utf-8")))
