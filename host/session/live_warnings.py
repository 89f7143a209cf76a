"""What a session warns of while it runs: beyond what was recorded, or the force is held back.

A condition that lasts is one warning, from its first tick to half a second after its last one.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.notes import CLAMPED, HELD, LATCHED, LIMITED, OUTSIDE
from springpot.codegen.types import JsonObject
from springpot.host.native.c_library import COLUMN, NONE, LoopRows, empty_rows
from springpot.host.session.outcome import LOWER, NOTE_WORDS, UPPER, clamped_low

WINDOW_S = 0.05  # rows are looked at together
CALM_S = 0.5  # without the condition: it is over
LINE_S = 1.0  # at most one line in this time
FASTER = 4.0  # than the trained speed, inside the object
HELD_SHARE = 0.1  # of the ticks of a window: a single lost sample is no warning
MAX_EVENTS = 50  # of a kind: the last one counts the ticks of all further ones
_SPEED_S = 0.01  # of motion to a speed: an encoder's step is no speed

Alarm = Callable[[str, bool], None]
Ticks = NDArray[np.bool_]


@dataclass
class _Condition:
    """words: what it is. unit, scale, allowed: of `worst`, the furthest value, where it has one."""

    words: str
    unit: str = ""
    scale: float = 1.0
    allowed: float = 0.0
    said_elsewhere: bool = False
    share: float = 0.0
    begin_s: float = 0.0
    last_s: float = -np.inf
    count: int = 0
    worst: float = 0.0
    announced: bool = False

    def figure(self) -> str:
        if not self.unit:
            return ""
        return f", {self.scale * self.worst:.4g} of {self.scale * self.allowed:.4g} {self.unit}"


class LiveWarnings:
    """Takes the rows of a loop, and gives `alarm` lines, and whether something began with each.

    The line is empty where another message says it.
    """

    def __init__(self, plan: Plan, alarm: Alarm) -> None:
        """plan: of the scene that is rendered."""
        trained, self._contact = plan.model.trained, plan.contact
        self._alarm, self._dt_s = alarm, plan.dt_s
        self._min_n, self._fast_mps = float(plan.output.min_n), FASTER * trained.max_mps
        self._ticks = max(1, round(WINDOW_S / plan.dt_s))
        self._before = max(1, round(_SPEED_S / plan.dt_s))  # ticks
        self._last_n = np.zeros(1)
        self._recent_m = np.full(self._before, np.nan)
        self._waiting = empty_rows(0)
        self._events: list[JsonObject] = []
        self._over: dict[str, str] = {}  # what ended since the last line, and how to say it
        self._silent_until_s = -np.inf
        self._conditions = {
            "deep": _Condition("deeper than was recorded", "mm", 1e3, float(plan.range.max_m)),
            "fast": _Condition("faster than four times the recorded speed", "m/s", 1.0,
                               self._fast_mps),
            "clamped": _Condition(UPPER),
            "pulls": _Condition(LOWER),
            "limited": _Condition(NOTE_WORDS[LIMITED]),
            "held": _Condition(NOTE_WORDS[HELD], share=HELD_SHARE),
            "latched": _Condition(NOTE_WORDS[LATCHED], said_elsewhere=True),
        }  # fmt: skip

    def append(self, rows: LoopRows) -> None:
        """Take the next rows; whole windows of them are looked at."""
        self._waiting = np.concatenate((self._waiting, rows))
        while len(self._waiting) >= self._ticks:
            window, self._waiting = self._waiting[: self._ticks], self._waiting[self._ticks :]
            self._look(window)

    def finish(self) -> list[JsonObject]:
        """All of them, after the end: time_s of the first tick, what, count of ticks."""
        if len(self._waiting):
            self._look(self._waiting)
            self._waiting = empty_rows(0)
        for condition in self._conditions.values():
            if condition.count:
                self._end(condition)
        return sorted(self._events, key=lambda event: float(event["time_s"]))

    def _look(self, rows: LoopRows) -> None:
        now_s, time_s = float(rows[-1, COLUMN["time_s"]]), rows[:, COLUMN["time_s"]]
        for name, (ticks, values) in self._found(rows).items():
            condition = self._conditions[name]
            if ticks.sum() > condition.share * self._ticks:
                self._count(condition, time_s[ticks], values[ticks])
            elif condition.count and now_s - condition.last_s > CALM_S:
                self._end(condition)
        self._speak(now_s)

    def _found(self, rows: LoopRows) -> dict[str, tuple[Ticks, NDArray[np.float64]]]:
        """Of each condition: whether each tick has it, and how far it goes."""
        notes = rows[:, COLUMN["notes"]].astype(int)
        called = (rows[:, COLUMN["call"]].astype(int) & NONE) == 0
        notes = np.where(called & (notes > 0), notes, 0)  # negative ones are errors
        position_m, force_n = rows[:, COLUMN["position_m"]], rows[:, COLUMN["returned_n"]]
        speed_mps = self._speeds(np.where(notes & HELD, np.nan, position_m))
        inside = position_m > 0.0 if self._contact else np.isfinite(position_m)
        fast = called & inside & (speed_mps > self._fast_mps) & (self._fast_mps > 0.0)
        latched = (notes & LATCHED) > 0
        joined = np.concatenate((self._last_n, force_n))
        low = clamped_low(np.append(0, notes), joined, self._min_n)[1:]
        self._last_n = force_n[-1:]
        outside = (notes & OUTSIDE) > 0
        return {
            "deep": (outside, position_m),
            "fast": (fast, speed_mps),
            "clamped": (((notes & CLAMPED) > 0) & ~low, force_n),
            # At 0 an object ends to push and does not pull: nothing to be told.
            "pulls": (low & (self._min_n < 0.0), force_n),
            "limited": ((notes & LIMITED) > 0, force_n),
            "held": (((notes & HELD) > 0) & ~latched, force_n),
            "latched": (latched, force_n),
        }

    def _speeds(self, position_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Mean speed of the last ticks at each row, m/s; NaN where a position is not known."""
        joined = np.concatenate((self._recent_m, position_m))
        self._recent_m = joined[-self._before :]
        moved_m = joined[self._before :] - joined[: -self._before]
        return np.asarray(np.abs(moved_m) / (self._before * self._dt_s))

    def _count(
        self, condition: _Condition, time_s: NDArray[np.float64], values: NDArray[np.float64]
    ) -> None:
        if not condition.count:
            condition.begin_s, condition.worst = float(time_s[0]), 0.0
            condition.announced = False
            if condition.said_elsewhere:
                self._alarm("", True)
        condition.count += len(time_s)
        condition.last_s = float(time_s[-1])
        condition.worst = max(condition.worst, float(np.fmax.reduce(values)))

    def _end(self, condition: _Condition) -> None:
        before = [event for event in self._events if event["what"] == condition.words]
        if len(before) >= MAX_EVENTS:
            before[-1]["count"] += condition.count
        else:
            begin_s = round(condition.begin_s, 4)
            self._events.append(
                {"time_s": begin_s, "what": condition.words, "count": condition.count}
            )
        if not condition.said_elsewhere:
            lasted_s = condition.last_s - condition.begin_s + self._dt_s
            over = "over" if condition.announced else f"at {condition.begin_s:.1f} s"
            told = f"{over}: {condition.words}{condition.figure()}, for {lasted_s:.2g} s"
            self._over[condition.words] = told
        condition.count = 0

    def _speak(self, now_s: float) -> None:
        """One line of all that is new, where the last one was long enough ago.

        What ended and began again meanwhile is given as what begins.
        """
        new = [item for item in self._conditions.values()
               if item.count and not item.announced and not item.said_elsewhere]  # fmt: skip
        if now_s >= self._silent_until_s and (new or self._over):
            parts = {item.words: f"warning: {item.words}{item.figure()}" for item in new}
            parts |= {words: told for words, told in self._over.items() if words not in parts}
            self._alarm(f"{now_s:.1f} s: {'; '.join(parts.values())}", bool(new))
            self._silent_until_s, self._over = now_s + LINE_S, {}
            for item in new:
                item.announced = True
