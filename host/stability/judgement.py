"""Grade outcomes of the checks by what a hand feels."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

from springpot.host.stability.closed_loop import Outcome

QUIET_MPS = 1e-3
FAITHFUL_PERCENT = 10.0


class Grade(IntEnum):
    """From the least to the gravest."""

    ENDS = 0
    GOOD = 1
    LOOK = 2
    BAD = 3

    @property
    def word(self) -> str:
        """As pages print it, beside its colour."""
        return self.name.lower()


@dataclass(frozen=True, eq=False)
class Judgement:
    """An outcome, how good it is, and why.

    unbounded: its force or depth is, or it vibrates more and more, or it goes on, or ends, against
    what it should. kicks: losses of samples are felt.
    """

    outcome: Outcome
    grade: Grade
    words: str
    unbounded: bool = False
    loud: bool = False
    kicks: bool = False
    unfaithful: bool = False

    @property
    def ends(self) -> bool:
        """Whether the scene has to end the case."""
        return self.outcome.played.ends

    @property
    def grows(self) -> bool:
        """Whether it vibrates more and more."""
        return self.outcome.vibration.grows

    @property
    def beyond(self) -> tuple[int, float]:
        """Sorts judgements, the gravest last."""
        return self.grade, self.outcome.fidelity_percent


def judge(outcome: Outcome) -> Judgement:
    """One outcome. Lost samples at four times the trained speed warn, and do not condemn."""
    if outcome.played.ends:
        return _judge_end(outcome)
    lossy, vibration = outcome.losses is not None, outcome.vibration
    ends = outcome.latched_s is not None
    unbounded = not outcome.bounded or vibration.grows or ends
    speed_mps = math.hypot(outcome.hf_speed_mps, vibration.lf_speed_mps or 0.0)
    loud = outcome.played.quiet and speed_mps > QUIET_MPS
    faults = () if outcome.losses is None else outcome.losses.faults
    differs = outcome.fidelity_percent > FAITHFUL_PERCENT
    unfaithful = differs and not lossy and not outcome.played.stiffer
    reasons = [
        words
        for holds, words in (
            (not outcome.bounded, "not bounded"),
            (vibration.grows, "vibrates more and more on a hold"),
            (ends, "ends, though enough samples come"),
            (loud, f"vibrates with {1e3 * speed_mps:.2g} mm/s on a hold"),
            *((True, words) for words in faults),
            (unfaithful, "felt otherwise than the model"),
        )
        if holds
    ]
    bad = unbounded or (faults and not outcome.played.beyond)
    grade = Grade.BAD if bad else Grade.LOOK if reasons else Grade.GOOD
    if not reasons:
        reasons = ["no kick"] if lossy else ["bounded, quiet"] if outcome.played.quiet else [
            "bounded"
        ]  # fmt: skip
    if outcome.played.stiffer and differs:
        reasons.append("felt softer than it is, as its coupling means it to be")
    return Judgement(outcome, grade, ", ".join(reasons), unbounded, loud, bool(faults), unfaithful)


def _judge_end(outcome: Outcome) -> Judgement:
    """Too few samples come: the scene has to end it, whatever the hand does then."""
    if outcome.ended:
        words = f"ends after {1e3 * (outcome.latched_s or 0.0):.0f} ms, as it should"
        return Judgement(outcome, Grade.ENDS, words)
    return Judgement(outcome, Grade.BAD, "goes on though too few samples come", unbounded=True)


def judged_cases(outcomes: Sequence[Outcome]) -> list[Judgement]:
    """Of each case the hand and delay that fares worst; the gravest case first."""
    worst: dict[str, Judgement] = {}
    for found in map(judge, outcomes):
        case = found.outcome.case
        if case not in worst or found.beyond > worst[case].beyond:
            worst[case] = found
    return sorted(worst.values(), key=lambda item: item.beyond, reverse=True)
