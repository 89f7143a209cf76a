"""Grade outcomes of the checks by what a hand feels."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum

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


class Fault(Enum):
    """What is not good about an outcome: how the verdict begins its sentence on it."""

    UNBOUNDED = "Not bounded"
    GROWS = "Vibrates more and more on"
    ENDS = "Ends, though enough samples come, on"
    GOES_ON = "Goes on, though too few samples come, on"
    LOUD = "Vibrates above 1 mm/s on"
    KICKS = "Lost samples are felt on"
    FAST_KICKS = "Lost samples are felt, at four times the trained speed, on"
    UNFAITHFUL = "Fidelity error above 10 % of peak on"


# Force or depth has no bound, or it vibrates more and more, or it goes on, or ends, against what it
# should.
_UNBOUNDED = {Fault.UNBOUNDED, Fault.GROWS, Fault.ENDS, Fault.GOES_ON}


@dataclass(frozen=True, eq=False)
class Judgement:
    """An outcome, how good it is, and why."""

    outcome: Outcome
    grade: Grade
    words: str
    faults: frozenset[Fault] = frozenset()

    @property
    def unbounded(self) -> bool:
        """Whether the scene is not to be held for it."""
        return not _UNBOUNDED.isdisjoint(self.faults)

    @property
    def beyond(self) -> tuple[int, float]:
        """Sorts judgements, the gravest last."""
        return self.grade, self.outcome.fidelity_percent


def judge(outcome: Outcome) -> Judgement:
    """One outcome. Lost samples at four times the trained speed warn, and do not condemn."""
    if outcome.ended and outcome.played.ends:
        words = f"ends after {1e3 * (outcome.latched_s or 0.0):.0f} ms, as it should"
        return Judgement(outcome, Grade.ENDS, words)
    found = _faults(outcome)
    if found:
        grave = _UNBOUNDED | {Fault.KICKS}
        grade, reasons = Grade.LOOK if grave.isdisjoint(found) else Grade.BAD, list(found.values())
    else:
        quiet = "bounded, quiet" if outcome.played.quiet else "bounded"
        grade, reasons = Grade.GOOD, [quiet if outcome.losses is None else "no kick"]
    if outcome.played.stiffer and outcome.fidelity_percent > FAITHFUL_PERCENT:
        reasons.append("felt softer than it is, as its coupling means it to be")
    return Judgement(outcome, grade, ", ".join(reasons), frozenset(found))


def _faults(outcome: Outcome) -> dict[Fault, str]:
    """What is not good, in words."""
    played, vibration, losses = outcome.played, outcome.vibration, outcome.losses
    if played.ends:  # too few samples come: the scene has to end it, whatever the hand does then
        return {Fault.GOES_ON: "goes on though too few samples come"}
    speed_mps = math.hypot(outcome.hf_speed_mps, vibration.lf_speed_mps or 0.0)
    differs = outcome.fidelity_percent > FAITHFUL_PERCENT
    kicks = ", ".join(losses.faults) if losses else ""
    loud = f"vibrates with {1e3 * speed_mps:.2g} mm/s on a hold"
    found = {
        Fault.UNBOUNDED: "" if outcome.bounded else "not bounded",
        Fault.GROWS: "vibrates more and more on a hold" if vibration.grows else "",
        Fault.ENDS: "" if outcome.latched_s is None else "ends, though enough samples come",
        Fault.LOUD: loud if played.quiet and speed_mps > QUIET_MPS else "",
        Fault.FAST_KICKS if played.beyond else Fault.KICKS: kicks,
        Fault.UNFAITHFUL: "felt otherwise than the model"
        if differs and losses is None and not played.stiffer
        else "",
    }
    return {fault: words for fault, words in found.items() if words}


def judged_cases(outcomes: Sequence[Outcome]) -> list[Judgement]:
    """Of each case the hand and delay that fares worst; the gravest case first."""
    worst: dict[str, Judgement] = {}
    for found in map(judge, outcomes):
        case = found.outcome.case
        if case not in worst or found.beyond > worst[case].beyond:
            worst[case] = found
    return sorted(worst.values(), key=lambda item: item.beyond, reverse=True)
