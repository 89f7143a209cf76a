"""A trial under way: presses, how deep and how fast; and when that is too much."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from springpot.basics import Samples
from springpot.host.wings.study.session.conduct import PresentedTrial, Record
from springpot.host.wings.study.session.screen_state import ScreenState
from springpot.host.wings.study.session.switched import MAX_PLACES, PlacedNotes
from springpot.loop import COLUMN, LoopRows

_SPEED_S = 0.01  # speed is the change of position over so long: a device's own may not be there
_PRESSED_M = 2e-4  # an approach that only grazes the surface is no press


@dataclass(frozen=True)
class PressLimits:
    """What is too deep and too fast; None: unknown. deepest_m, fastest_mps."""

    deepest_m: float | None = None
    fastest_mps: float | None = None


@dataclass
class PressCount:
    """Of one place: presses, and the extremes in contact."""

    presses: int = 0
    deepest_m: float = 0.0
    fastest_mps: float = 0.0


@dataclass
class PressWatch:
    """Follows the rows of a loop through one trial; `too_deep`, `too_fast`: in the newest rows."""

    dt_s: float
    limits: PressLimits = field(default_factory=PressLimits)
    counts: list[PressCount] = field(
        default_factory=lambda: [PressCount() for _ in range(MAX_PLACES + 1)]
    )
    too_deep: bool = False
    too_fast: bool = False

    def __post_init__(self) -> None:
        self._earlier_m = np.zeros(0)
        self._pressing = False

    def append(self, rows: LoopRows) -> None:
        """Take the next rows."""
        if not len(rows):
            return
        position_m = np.nan_to_num(rows[:, COLUMN["position_m"]])
        place = PlacedNotes.of(rows[:, COLUMN["notes"]]).place
        speed_mps = self._speed_mps(position_m)
        inside = position_m > 0
        for k, count in enumerate(self.counts):
            felt = inside & (place == k)
            if felt.any():
                count.deepest_m = max(count.deepest_m, float(position_m[felt].max()))
                count.fastest_mps = max(count.fastest_mps, float(speed_mps[felt].max()))
        self._count_presses(position_m, place)
        deepest_m, fastest_mps = self.limits.deepest_m, self.limits.fastest_mps
        self.too_deep = deepest_m is not None and bool((position_m > deepest_m).any())
        self.too_fast = fastest_mps is not None and bool((speed_mps[inside] > fastest_mps).any())

    def summary(self) -> dict[str, Any]:
        """Return what the journal keeps of a trial, over all its slots."""
        counts = self.counts[1:]
        return {
            "presses": sum(count.presses for count in counts),
            "deepest_m": round(max(count.deepest_m for count in counts), 6),
            "fastest_mps": round(max(count.fastest_mps for count in counts), 6),
        }

    def _count_presses(self, position_m: Samples, place: Samples) -> None:
        """Count presses: one begins below `_PRESSED_M` and ends at the surface."""
        edges = np.where(position_m > _PRESSED_M, 1, np.where(position_m <= 0, -1, 0))
        changes = np.flatnonzero(edges)
        for k in changes[np.diff(edges[changes], prepend=1 if self._pressing else -1) != 0]:
            self._pressing = bool(edges[k] > 0)
            if self._pressing:
                self.counts[int(place[k])].presses += 1

    def _speed_mps(self, position_m: Samples) -> Samples:
        """Return speed of every sample, (n,), by the difference over `_SPEED_S`."""
        back = max(1, round(_SPEED_S / self.dt_s))
        if not len(self._earlier_m):
            self._earlier_m = np.full(back, position_m[0])
        whole = np.concatenate((self._earlier_m, position_m))
        self._earlier_m = whole[-back:]
        return np.abs(whole[back:] - whole[:-back]) / (back * self.dt_s)


@dataclass
class RunningTrial:
    """One trial under way. felt: slots that were pressed; pressed: all of them."""

    shown: PresentedTrial
    record: Record
    watch: PressWatch
    state: ScreenState
    felt: set[int] = field(default_factory=set)
    pressed: bool = False
    warnings: int = 0
    warned_s: float = 0.0

    def details(self) -> dict[str, Any]:
        """Return what the line `done` says of the presses."""
        return {**self.watch.summary(), "warnings": self.warnings}
