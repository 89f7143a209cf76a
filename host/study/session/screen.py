"""The participant's screen: its states and acts."""

from dataclasses import dataclass
from typing import Literal

from springpot.host.native.loop_library import LoopRows


@dataclass(frozen=True)
class Ask:
    """What is asked."""

    kind: Literal["number", "choice", "text"]
    question: str
    min: float = 0
    max: float = 100
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class ScreenState:
    """What is shown."""

    title: str
    instruction: str
    slots: tuple[str, ...] = ()
    active: int | None = None
    wanted: int | None = None
    ask: Ask | None = None
    guideline_m: float | None = None


@dataclass(frozen=True)
class Act:
    """What the participant did."""

    kind: Literal["slot", "answer", "next"]
    value: int | str


class ParticipantScreen:
    """The page."""

    address = ""

    def __enter__(self) -> "ParticipantScreen":
        return self

    def __exit__(self, *_error: object) -> None: ...

    def show(self, state: ScreenState) -> None: ...
    def append(self, rows: LoopRows) -> None: ...
    def warn(self, text: str) -> None: ...
    def next_act(self, s: float) -> Act | None: ...
