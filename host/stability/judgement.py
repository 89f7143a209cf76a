"""What the checks mean for a hand: outcomes graded, figures of the device in sentences."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

from springpot.codegen.plan import Plan
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
    slow_mps = vibration.lf_speed_mps or 0.0
    fast, slow = outcome.hf_speed_mps > QUIET_MPS, slow_mps > QUIET_MPS
    loud = outcome.played.quiet and (fast or slow)
    faults = () if outcome.losses is None else outcome.losses.faults
    unfaithful = not lossy and not outcome.stiffer and outcome.fidelity_percent > FAITHFUL_PERCENT
    reasons = [
        words
        for holds, words in (
            (not outcome.bounded, "not bounded"),
            (vibration.grows, "vibrates more and more on a hold"),
            (ends, "ends, though enough samples come"),
            (loud and fast, f"vibrates with {1e3 * outcome.hf_speed_mps:.2g} mm/s on a hold"),
            (loud and slow, f"sways with {1e3 * slow_mps:.2g} mm/s below 15 Hz on a hold"),
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
    if outcome.stiffer and outcome.fidelity_percent > FAITHFUL_PERCENT:
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


def device_advice(plan: Plan) -> Iterator[str]:
    """Yield what the largest force and the noise of the velocity, where stated, mean."""
    device = plan.scene.device
    if device.max_force_n is not None and device.max_force_n < plan.max_force_n:
        yield (
            f"The scene's force may reach {plan.max_force_n:.3g} N and its device gives "
            f"{device.max_force_n:g} N, so `run` will refuse it: set guard.max_force_n = "
            f"{device.max_force_n:g}."
        )
    if device.velocity_noise_mps and plan.needs_device_velocity:
        noise_n = plan.coupling.coupling.damping_nspm * device.velocity_noise_mps
        yield (
            f"The device's velocity, noisy by {device.velocity_noise_mps:.2g} m/s, puts "
            f"{noise_n:.2g} N of noise into the force: "
            'device.velocity = "estimate" does without it.'
        )
