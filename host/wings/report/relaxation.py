"""What the force does while the tool is held still: that of the C, and the measured one."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from springpot.basics import Samples
from springpot.emission import Plan
from springpot.native import Replay
from springpot.simulation import RISE_S, Workspace, holding
from springpot.validation import Series

HOLD_FOR_S = 60.0
_SHARE = 0.6  # of the trained depth
_SETTLED = 0.005  # of the force at the beginning: less than this of a way to go is none
_STILL = 0.02  # of a recording's travel: the tool is held while it moves by no more
_MIN_HOLD_S = 1.0


@dataclass(frozen=True, eq=False)
class Hold:
    """A tool held still from time 0 on; arrays (n,).

    measured_n: None where nobody measured. name: of the recording, or of what was done.
    """

    name: str
    depth_m: float
    dt_s: float
    force_n: Samples
    measured_n: Samples | None = None

    @property
    def seconds(self) -> float:
        return len(self.force_n) * self.dt_s


def scene_hold(plan: Plan, replay: Replay) -> Hold:
    """Press the emitted C to 60 % of its trained depth, and hold it there for a minute."""
    space = Workspace.of(plan)
    motion, seconds = holding(space, (_SHARE,), HOLD_FOR_S)
    time_s = np.arange(round(seconds / plan.dt_s), dtype=np.float64) * plan.dt_s
    force_n, _ = replay.run(motion(time_s))
    still = np.asarray(force_n[round(RISE_S / plan.dt_s) :], dtype=np.float64)
    return Hold("the emitted C", space.at(_SHARE), plan.dt_s, still)


def recorded_hold(series: Sequence[Series]) -> Hold | None:
    """The longest stretch, of a second at least, in which a press holds under load."""
    presses = list(series)
    found = [hold for item in presses if (hold := _longest_hold(item)) is not None]
    return max(found, key=lambda hold: hold.seconds, default=None)


def relaxed_share(force_n: Samples) -> float:
    """How much of its first value a held force loses until its last one."""
    return float(1.0 - force_n[-1] / force_n[0]) if force_n[0] else 0.0


def settled_after_s(hold: Hold) -> float:
    """When a held force of the C has come as near to its last value as it stays."""
    rest_n = np.abs(hold.force_n - hold.force_n[-1])
    moving = np.flatnonzero(rest_n > _SETTLED * np.abs(hold.force_n[0]))
    return float((moving[-1] + 1) * hold.dt_s) if len(moving) else 0.0


def _longest_hold(item: Series) -> Hold | None:
    travel_m = float(np.ptp(item.position_m))
    reach = round(_MIN_HOLD_S / item.dt_s)
    best: tuple[int, int] = (0, 0)
    begin = 0
    position_m = item.position_m
    while begin + reach <= len(position_m):
        window = position_m[begin : begin + reach]
        if np.ptp(window) > _STILL * travel_m or not _loaded(item, begin):
            begin += max(1, reach // 20)
            continue
        away = np.abs(position_m[begin:] - np.median(window)) > _STILL * travel_m
        end = begin + (int(np.argmax(away)) if away.any() else len(away))
        best = max(best, (begin, end), key=lambda edges: edges[1] - edges[0])
        begin = end
    begin, end = best
    if end - begin < reach:
        return None
    return Hold(item.name, float(np.median(position_m[begin:end])), item.dt_s,
                item.predicted_n[begin:end], item.measured_n[begin:end])  # fmt: skip


def _loaded(item: Series, at: int) -> bool:
    """Whether there is a force to relax: a tenth of the recording's greatest."""
    return bool(np.abs(item.measured_n[at]) > 0.1 * np.abs(item.measured_n).max())
