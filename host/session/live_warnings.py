"""What a session warns of while it runs: beyond what was recorded, or the force is held back."""

from collections.abc import Callable

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.notes import CLAMPED, HELD, LATCHED, LIMITED, OUTSIDE
from springpot.codegen.plan import Plan
from springpot.codegen.types import JsonObject
from springpot.host.native.c_library import COLUMN, NONE, LoopRows, empty_rows
from springpot.host.session.outcome import LOWER, NOTE_WORDS, UPPER, clamped_at_lower_limit
from springpot.trainer.models.predict import SPEED_WINDOW_S, WARN_SPEED_RATIO

WINDOW_S = 0.05  # rows are looked at together
CALM_S = 0.5  # without the condition: it is over
HELD_SHARE = 0.1  # of the ticks of a window: a single lost sample is no warning
_DEEP, _FAST = "deeper than was recorded", "faster than four times the recorded speed"

Alarm = Callable[[str], None]


class LiveWarnings:
    """Takes the rows of a loop, and gives `alarm` a line when a condition begins.

    A condition that lasts is one warning, from its first tick to half a second after its last one.
    The line is empty where another message says it.
    """

    def __init__(self, plan: Plan, alarm: Alarm) -> None:
        """plan: of the scene that is rendered."""
        self._alarm, self._dt_s, self._contact = alarm, plan.dt_s, plan.contact
        self._min_n, self._max_m = float(plan.output.min_n), float(plan.range.max_m)
        self._fast_mps = WARN_SPEED_RATIO * plan.model.trained.max_mps
        self._ticks = max(1, round(WINDOW_S / plan.dt_s))
        self._last_n = np.zeros(1)
        self._recent_m = np.full(max(1, round(SPEED_WINDOW_S / plan.dt_s)), np.nan)
        self._waiting = empty_rows(0)
        self._events: dict[str, list[JsonObject]] = {}
        self._last_s: dict[str, float] = {}

    def append(self, rows: LoopRows) -> None:
        """Take the next rows; whole windows of them are looked at."""
        self._waiting = np.concatenate((self._waiting, rows))
        while len(self._waiting) >= self._ticks:
            window, self._waiting = self._waiting[: self._ticks], self._waiting[self._ticks :]
            self._look(window)

    def finish(self) -> list[JsonObject]:
        """Return all of them, after the end: time_s of the first tick, what, count of ticks."""
        if len(self._waiting):
            self._look(self._waiting)
        events = [event for kind in self._events.values() for event in kind]
        return sorted(events, key=lambda event: float(event["time_s"]))

    def _look(self, rows: LoopRows) -> None:
        """Note the ticks that were too fast, too deep, held, latched or clamped."""
        notes = rows[:, COLUMN["notes"]].astype(int)
        called = (rows[:, COLUMN["call"]].astype(int) & NONE) == 0
        notes = np.where(called & (notes > 0), notes, 0)  # negative ones are errors
        position_m, force_n = rows[:, COLUMN["position_m"]], rows[:, COLUMN["returned_n"]]
        # Mean over the last ticks at each row; NaN where a position is not known.
        seen_m = np.concatenate((self._recent_m, np.where(notes & HELD, np.nan, position_m)))
        before = len(self._recent_m)
        speed_mps = np.abs(seen_m[before:] - seen_m[:-before]) / (before * self._dt_s)
        self._recent_m = seen_m[-before:]
        inside = position_m > 0.0 if self._contact else np.isfinite(position_m)
        fast = called & inside & (speed_mps > self._fast_mps) & (self._fast_mps > 0.0)
        joined = np.concatenate((self._last_n, force_n))
        low = clamped_at_lower_limit(np.append(0, notes), joined, self._min_n)[1:]
        self._last_n = force_n[-1:]
        outside, latched = (notes & OUTSIDE) > 0, (notes & LATCHED) > 0
        held = ((notes & HELD) > 0) & ~latched
        time_s = rows[:, COLUMN["time_s"]]
        deepest_mm = np.max(1e3 * position_m, where=outside, initial=0.0)
        fastest_mps = np.max(speed_mps, where=fast, initial=0.0)
        depth = f"{_DEEP}, {deepest_mm:.4g} of {1e3 * self._max_m:.4g} mm"
        self._note(_DEEP, time_s[outside], depth)
        speed = f"{_FAST}, {fastest_mps:.4g} of {self._fast_mps:.4g} m/s"
        self._note(_FAST, time_s[fast], speed)
        self._note(UPPER, time_s[((notes & CLAMPED) > 0) & ~low])
        if self._min_n < 0.0:  # at 0 an object ends to push and does not pull
            self._note(LOWER, time_s[low])
        self._note(NOTE_WORDS[LIMITED], time_s[(notes & LIMITED) > 0])
        if held.sum() > HELD_SHARE * self._ticks:
            self._note(NOTE_WORDS[HELD], time_s[held])
        self._note(NOTE_WORDS[LATCHED], time_s[latched], "")

    def _note(self, what: str, time_s: Samples, words: str | None = None) -> None:
        """Count ticks with a condition; alarm where it begins. words: in place of `what`."""
        if not len(time_s):
            return
        events = self._events.setdefault(what, [])
        begins = time_s[0] - self._last_s.get(what, -np.inf) > CALM_S
        self._last_s[what] = float(time_s[-1])
        if begins:
            line = what if words is None else words
            self._alarm(f"{time_s[0]:.1f} s: warning: {line}" if line else "")
            events.append({"time_s": round(float(time_s[0]), 4), "what": what, "count": 0})
        events[-1]["count"] += len(time_s)
