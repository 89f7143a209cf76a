"""A trial under way: what is shown, what was felt, what the journal will say of it."""

from dataclasses import dataclass, field
from typing import Any

from springpot.host.wings.study.session.conduct import PresentedTrial, Record
from springpot.host.wings.study.session.presses import PressWatch
from springpot.host.wings.study.session.screen_state import ScreenState


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
        """What the line `done` says of the presses."""
        return {**self.watch.summary(), "warnings": self.warnings}
