"""What the checks mean for a hand: outcomes graded, figures of the device in sentences."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

from springpot.codegen.plan.plan import Plan
from springpot.host.stability.closed_loop import Outcome

QUIET_MPS = 1e-3
FAITHFUL_PERCENT = 10.0


class Grade(IntEnum):
    """From the least to the gravest."""

    UNJUDGED = 0
    GOOD = 1
    LOOK = 2
    BAD = 3

    @property
    def word(self) -> str:
        """As pages print it, beside its colour."""
        return {"UNJUDGED": "not judged"}.get(self.name, self.name.lower())


@dataclass(frozen=True, eq=False)
class Judgement:
    """An outcome, how good it is, and why. kicks: losses of samples are felt."""

    outcome: Outcome
    grade: Grade
    words: str
    unbounded: bool = False
    loud: bool = False
    kicks: bool = False
    unfaithful: bool = False

    @property
    def beyond(self) -> tuple[int, float]:
        """Sorts judgements, the gravest last."""
        return self.grade, self.outcome.fidelity_percent


def judge(outcome: Outcome) -> Judgement:
    """One outcome. Lost samples at four times the trained speed warn, and do not condemn."""
    if not outcome.played.judged:
        return Judgement(outcome, Grade.UNJUDGED, "a session ends at such a rate of samples")
    lossy = outcome.losses is not None
    unbounded = not outcome.bounded
    loud = outcome.played.quiet and outcome.hf_speed_mps > QUIET_MPS
    kicks = outcome.losses is not None and outcome.losses.kicks
    unfaithful = not lossy and not outcome.stiffer and outcome.fidelity_percent > FAITHFUL_PERCENT
    reasons = [
        words
        for holds, words in (
            (unbounded, "not bounded"),
            (loud, f"vibrates with {1e3 * outcome.hf_speed_mps:.2g} mm/s on a hold"),
            (kicks, "lost samples are felt as a kick"),
            (unfaithful, "felt otherwise than the model"),
        )
        if holds
    ]
    bad = unbounded or (kicks and not outcome.played.beyond)
    grade = Grade.BAD if bad else Grade.LOOK if reasons else Grade.GOOD
    if not reasons:
        reasons = ["no kick"] if lossy else ["bounded, quiet"] if outcome.played.quiet else [
            "bounded"
        ]  # fmt: skip
    if outcome.stiffer and outcome.fidelity_percent > FAITHFUL_PERCENT:
        reasons.append("felt softer than it is, as its coupling means it to be")
    return Judgement(outcome, grade, ", ".join(reasons), unbounded, loud, kicks, unfaithful)


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
