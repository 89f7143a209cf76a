"""The participant's screen: a page in a browser on this machine, for a keyboard alone.

It shows the tip of the tool, the surface and the deepest permitted penetration, and nothing of the
object. An act counts for the state that the participant saw, once; what comes later is dropped.
"""

import json
import threading
from collections import deque
from collections.abc import Iterator
from dataclasses import asdict
from http import HTTPStatus

import numpy as np

from springpot.figures import Answer, PageEvent, PageServer, PageWatcher, page_text
from springpot.host.wings.study.session.screen_state import (
    LONGEST_TEXT,
    Act,
    ScreenState,
    read_act,
)
from springpot.loop import COLUMN, NONE, LoopRows

DEEPEST_M = 0.012  # some more than the deepest training of the paper
_EVERY_S = 0.016  # a frame of a screen
_MAX_ACTS = 64  # that wait
# In the order in which they use each other.
_SCRIPTS = ("link.js", "picture.js", "warning.js", "answer.js", "view.js", "main.js")
_WELCOME = ScreenState("Welcome", "Please wait.")


class _LookingPage(PageWatcher):
    """One page; it gets the newest of all, however much came in between."""

    def __init__(self, screen: "ParticipantScreen") -> None:
        self._screen = screen
        self._got = [-1, screen.newest()[1][0], -1]

    def news(self) -> Iterator[PageEvent]:
        names = ("state", "warning", "position")
        for k, (number, data) in enumerate(self._screen.newest()):
            if number != self._got[k]:
                self._got[k] = number
                yield names[k], json.dumps(data)


class ParticipantScreen(PageServer[_LookingPage]):
    """Serves the page of a session's participant, as a context manager."""

    def __init__(self, deepest_m: float = DEEPEST_M) -> None:
        """deepest_m: the deepest guideline of the study; one scale for all, as it can be felt."""
        context = {"scripts": _SCRIPTS, "deepest_m": deepest_m, "longest": LONGEST_TEXT}
        super().__init__(
            page_text("screen.html", context, "springpot.host.wings.study"), "events", _EVERY_S
        )
        self._deepest_m = deepest_m
        self._changed = threading.Condition()
        self._acts: deque[Act] = deque(maxlen=_MAX_ACTS)
        self._number, self._state, self._answered = 0, _WELCOME, True
        self._warning = (0, "")
        self._position: tuple[int, float | None] = (0, None)

    def show(self, state: ScreenState) -> None:
        """Replace what is shown; acts that have not been taken yet are forgotten."""
        if state.guideline_m is not None and not 0 < state.guideline_m <= self._deepest_m:
            raise ValueError(f"guideline_m {state.guideline_m}: beyond {self._deepest_m}")
        with self._changed:
            self._acts.clear()
            self._number, self._state, self._answered = self._number + 1, state, False

    def append(self, rows: LoopRows) -> None:
        """Take rows of the loop, of which the newest is shown; never waits."""
        called = (rows[:, COLUMN["call"]].astype(int) & NONE) == 0
        positions_m = rows[called, COLUMN["position_m"]]
        positions_m = positions_m[np.isfinite(positions_m)]
        if len(positions_m):
            self._position = (self._position[0] + 1, round(float(positions_m[-1]), 6))

    def warn(self, text: str) -> None:
        """Say it on the page for some two seconds, with a sound."""
        self._warning = (self._warning[0] + 1, text)

    def next_act(self, timeout_s: float) -> Act | None:
        """Return what the participant did next in the state shown, or None after so long."""
        with self._changed:
            self._changed.wait_for(lambda: self._acts, timeout_s)
            return self._acts.popleft() if self._acts else None

    def newest(self) -> tuple[tuple[int, object], ...]:
        """Return state, warning and position, each with a number that tells it from others."""
        with self._changed:
            state = {"number": self._number, "answered": self._answered, **asdict(self._state)}
        return (self._number, state), self._warning, self._position

    def watcher(self) -> _LookingPage:
        return _LookingPage(self)

    def posted(self, name: str, body: bytes) -> Answer:
        if name != "act":
            return HTTPStatus.NOT_FOUND, ""
        try:
            number, act = read_act(body)
        except ValueError:
            return HTTPStatus.BAD_REQUEST, ""
        with self._changed:
            if number != self._number or self._answered:
                return HTTPStatus.OK, json.dumps({"accepted": False})
            if not self._state.accepts(act):
                return HTTPStatus.BAD_REQUEST, ""
            self._answered = act.kind != "slot"
            self._acts.append(act)
            self._changed.notify_all()
        return HTTPStatus.OK, json.dumps({"accepted": True})
