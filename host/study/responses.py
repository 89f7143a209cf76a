"""What people answered: one row a trial that counts, with the names behind the blinding codes."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Response:
    """One finished trial.

    session: 0 is practice. number: of the trial in its session, from 1. pair: index into
    `Study.pair`. shown: names of the stimuli in the slots, left to right (of abx: A, B, X).
    swapped: whether the pair's right stimulus was in the first slot. answer: similarity: the
    number; constant, staircase, quest+: "left" or "right", the slot that was chosen; abx: "A" or
    "B"; same-different: "same" or "different". correct: of the methods that know; None of
    similarity. seconds: from shown to answered. presses: of all slots; deepest_m, fastest_mps: in
    contact. warnings: that were given. log: the trial's rows, None where there is no device.
    """

    participant: str
    session: int
    number: int
    attempt: int
    pair: int
    shown: tuple[str, ...]
    swapped: bool
    answer: float | str
    correct: bool | None
    seconds: float
    presses: int
    deepest_m: float
    fastest_mps: float
    warnings: int
    log: Path | None


@dataclass(frozen=True)
class Reply:
    """One answer to a question at the end; question: index into `Study.question`."""

    participant: str
    question: int
    answer: str
