"""Coverage of a set of recordings: how deep, how fast and how long it presses, and what is next."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from springpot import Recording
from springpot.basics import short_repr
from springpot.modelling import find_strokes

_STILL = 0.02  # of the travel: less is no motion
_HOLD_S = 0.2
_TURN = 0.3  # of a stroke: a shorter rest is where it turns round
_MAX_SAMPLES = 20_000
_SAME_SPEED = 1.3
_SPEED_RANGE = 10.0
_DEPTH_BANDS = 3
_TOP = _DEPTH_BANDS - 1
_LONG_HOLD_S = 5.0
_NO_FORCE = 0.05  # of the peak


@dataclass(frozen=True)
class Coverage:
    """strokes: (deepest position, m, mean speed, m/s, duration, s); holds: (position, m, s).

    band_hz: frequencies that the recordings hold, from the slowest cycle or the longest recording
    to the fastest stroke. low_m, high_m: of all positions in the object.
    """

    strokes: tuple[tuple[float, float, float], ...]
    holds: tuple[tuple[float, float], ...]
    low_m: float
    high_m: float
    band_hz: tuple[float, float]
    __repr__ = short_repr

    @property
    def longest_stroke_s(self) -> float:
        """Time that the slowest stroke takes without its holds, s."""
        slowest_mps = min((stroke[1] for stroke in self.strokes), default=np.inf)
        return (self.high_m - self.low_m) / slowest_mps

    @property
    def longest_hold_s(self) -> float:
        return max((hold[1] for hold in self.holds), default=0.0)

    @property
    def one_speed(self) -> bool:
        speeds = [stroke[1] for stroke in self.strokes]
        return not speeds or max(speeds) < _SAME_SPEED * min(speeds)

    @property
    def speeds_mps(self) -> list[float]:
        """Lower ends of the columns of the table: half decades."""
        speeds = [stroke[1] for stroke in self.strokes]
        if not speeds:
            return []
        first, last = (int(np.floor(2 * np.log10(v))) for v in (min(speeds), max(speeds)))
        return [10.0 ** (k / 2) for k in range(first, last + 1)]

    def table(self) -> list[dict[str, Any]]:
        """One row a band of depth: strokes that end in it, by speed, and its longest hold."""
        edges = np.linspace(self.low_m, self.high_m, _DEPTH_BANDS + 1)
        bands = np.clip(np.searchsorted(edges, [s[0] for s in self.strokes], "right") - 1, 0, _TOP)
        held = np.clip(np.searchsorted(edges, [h[0] for h in self.holds], "right") - 1, 0, _TOP)
        ends = [*self.speeds_mps, np.inf]
        return [
            {
                "depth_m": [float(edges[k]), float(edges[k + 1])],
                "strokes": [
                    sum(1 for band, stroke in zip(bands, self.strokes, strict=True)
                        if band == k and low <= stroke[1] < high)
                    for low, high in pairwise(ends)
                ],
                "longest_hold_s": max(
                    (hold[1] for band, hold in zip(held, self.holds, strict=True) if band == k),
                    default=0.0,
                ),
            }
            for k in range(_DEPTH_BANDS)
        ]  # fmt: skip

    @property
    def record_next(self) -> list[str]:
        """Presses that would show more of the object, most useful first."""
        speeds = [stroke[1] for stroke in self.strokes]
        found = []
        if not speeds:
            return ["press in and out: nothing moves"]
        if max(speeds) < _SPEED_RANGE * min(speeds):
            found.append(
                f"press at three speeds or more, a factor of ten apart (these go from "
                f"{1e3 * min(speeds):.3g} to {1e3 * max(speeds):.3g} mm/s)"
            )
        if self.longest_hold_s < _LONG_HOLD_S:
            found.append(
                f"hold at depth for {_LONG_HOLD_S:g} s or more (longest: {self.longest_hold_s:.2g} "
                "s), or relaxation beyond the strokes is guessed"
            )
        for row in self.table():
            if not sum(row["strokes"]):
                low, high = (1e3 * edge for edge in row["depth_m"])
                found.append(f"press to {low:.3g} .. {high:.3g} mm: no stroke ends there")
        return found

    def as_dict(self) -> dict[str, Any]:
        """JSON values."""
        return {
            "speeds_mps": self.speeds_mps,
            "table": self.table(),
            "band_hz": list(self.band_hz),
            "record_next": self.record_next,
        }


def find_coverage(recordings: Sequence[Recording]) -> Coverage:
    """Strokes and holds of all recordings."""
    strokes, holds = [], []
    for recording in recordings:
        found = find_strokes(recording)
        for begin, end, speed_mps in found:
            part = recording.position_m[begin : end + 1]
            strokes.append((float(part.max()), speed_mps, (end - begin) * recording.dt_s))
        stroke_s = np.median([end - begin for begin, end, _ in found] or [0]) * recording.dt_s
        holds += _holds(recording, max(_HOLD_S, _TURN * float(stroke_s)))
    longest_s = max(recording.duration_s for recording in recordings)
    shortest_s = min((stroke[2] for stroke in strokes), default=longest_s / 2)
    return Coverage(
        strokes=tuple(strokes),
        holds=tuple(holds),
        low_m=min(map(_lowest_m, recordings)),
        high_m=max(float(recording.position_m.max()) for recording in recordings),
        band_hz=(1.0 / longest_s, max(0.5 / shortest_s, 1.0 / longest_s)),
    )


def _lowest_m(recording: Recording) -> float:
    """Lowest position in the object, m: without force, what is below 0 is the tool's way there."""
    below = recording.position_m < 0.0
    peak_n = float(np.abs(recording.force_n).max())
    if below.any() and np.median(np.abs(recording.force_n[below])) < _NO_FORCE * peak_n:
        return min(0.0, float(recording.position_m.max()))
    return float(recording.position_m.min())


def _holds(recording: Recording, min_s: float) -> list[tuple[float, float]]:
    """Rests within the object of at least min_s: position and duration, s."""
    step = max(1, len(recording.position_m) // _MAX_SAMPLES)
    thinned = recording.position_m[::step]
    still_m = _STILL * float(np.ptp(thinned))
    begin, low, high = 0, float(thinned[0]), float(thinned[0])
    found = []
    for k, position_m in enumerate([*thinned.tolist(), np.inf]):
        if max(high, position_m) - min(low, position_m) <= still_m:
            low, high = min(low, position_m), max(high, position_m)
            continue
        seconds = (k - begin) * step * recording.dt_s
        if seconds >= min_s and low > float(thinned.min()) + 2 * still_m:
            found.append((0.5 * (low + high), seconds))
        begin, low, high = k, position_m, position_m
    return found
