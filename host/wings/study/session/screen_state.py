"""What a participant's screen shows and asks, and what a participant can do there."""

import re
from dataclasses import dataclass
from typing import Literal

from pydantic import TypeAdapter

from springpot.host.wings.study.definition import Study

LONGEST_TEXT = 1000  # characters of an answer in words
_CLOSED = {"extra": "forbid", "strict": True}
_QUESTIONS = {
    "similarity": "How similar are the two? 0: entirely different. 100: the same.",
    "constant": "Which one is stiffer?",
    "staircase": "Which one is stiffer?",
    "quest+": "Which one is stiffer?",
    "abx": "Which one is the same as X?",
    "same-different": "Are the two the same, or different?",
}
TOO_DEEP, TOO_FAST = "Less deep, please.", "Slower, please."
FEEL_ALL = "Please press all of them before you answer."


@dataclass(frozen=True)
class Ask:
    """A question. min, max: of a whole number; choices: of a choice."""

    kind: Literal["number", "choice", "text"]
    question: str
    min: float = 0
    max: float = 100
    choices: tuple[str, ...] = ()

    def accepts(self, typed: str) -> bool:
        """Return whether it is an answer to this question."""
        if self.kind == "number":
            return bool(re.fullmatch("-?[0-9]{1,9}", typed)) and self.min <= int(typed) <= self.max
        if self.kind == "choice":
            return typed in self.choices
        return typed.strip() != "" and len(typed) <= LONGEST_TEXT


@dataclass(frozen=True)
class ScreenState:
    """All that is shown.

    slots: what can be felt, such as ("Left", "Right"), or nothing. active: the one under the tool;
    wanted: the one that was chosen and is not there yet. guideline_m: how deep one may press.
    """

    title: str
    instruction: str
    slots: tuple[str, ...] = ()
    active: int | None = None
    wanted: int | None = None
    ask: Ask | None = None
    guideline_m: float | None = None

    def accepts(self, act: "Act") -> bool:
        """Return whether a participant can do that here."""
        if act.kind == "slot":
            return isinstance(act.value, int) and 0 <= act.value < len(self.slots)
        if act.kind == "answer":
            return self.ask is not None and self.ask.accepts(str(act.value))
        return self.ask is None and not self.slots


@dataclass(frozen=True)
class Act:
    """What a participant did. value: index of a slot, an answer as typed; 0 of "next"."""

    kind: Literal["slot", "answer", "next"]
    value: int | str


@dataclass(frozen=True)
class SentAct:
    """An act as a page sends it, with the number of the state that it saw."""

    __pydantic_config__ = _CLOSED

    state: int
    kind: Literal["slot", "answer", "next"]
    value: int | str


_SENT: TypeAdapter[SentAct] = TypeAdapter(SentAct)


def read_act(body: bytes) -> tuple[int, Act]:
    """Return the number of the state that an act answers, and the act; raises ValueError."""
    sent = _SENT.validate_json(body)
    if isinstance(sent.value, str) != (sent.kind == "answer"):
        raise ValueError(f"{sent.kind}: not its kind of value")
    return sent.state, Act(sent.kind, sent.value)


def slots(study: Study) -> tuple[str, ...]:
    """Return names of what can be felt in a trial, left to right."""
    return ("A", "B", "X") if study.method == "abx" else ("Left", "Right")


def answers(study: Study) -> tuple[str, ...]:
    """Return what can be answered; none: a number from 0 to 100."""
    if study.method == "similarity":
        return ()
    if study.method == "abx":
        return "A", "B"
    return ("same", "different") if study.method == "same-different" else ("left", "right")


def trial_question(study: Study) -> Ask:
    """Return what the screen asks in a trial."""
    question = study.ask or _QUESTIONS[study.method]
    choices = answers(study)
    return Ask("choice" if choices else "number", question, choices=choices)
