"""The experimenter's terminal: what to put under the tool, and four keys. Codes, never names."""

from collections.abc import Callable
from typing import Protocol

from springpot.console import say
from springpot.host.wings.study.session.conduct import SessionStoppedError

KEYS = (
    "Enter: it is in place; v: void this trial, it comes again at the end; q: stop, go on later; "
    "r: reset, where a watchdog took the force away"
)


class PressedKeys(Protocol):
    """Where keys come from: a terminal."""

    def pressed(self) -> str:
        """Return keys since the last look."""
        ...


class TrialVoidedError(Exception):
    """The experimenter took the trial back."""


class Experimenter:
    """Reports what to do, and obeys keys."""

    def __init__(
        self,
        keys: PressedKeys,
        report: Callable[[str], None] = say,
        reset: Callable[[], None] = lambda: None,
    ) -> None:
        self._keys, self.report, self._reset = keys, report, reset

    def look(self) -> bool:
        """Return whether Enter was pressed since the last look.

        Raises TrialVoidedError for v, SessionStoppedError for q.
        """
        pressed = self._keys.pressed()
        if "r" in pressed:
            self._reset()
        if "q" in pressed:
            raise SessionStoppedError(
                "stopped by the experimenter: the same command goes on with this session"
            )
        if "v" in pressed:
            raise TrialVoidedError
        return "\n" in pressed or "\r" in pressed
