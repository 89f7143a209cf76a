"""What outcomes mean: each graded by what a hand feels, and the verdict on all in words."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum

from springpot.codegen.coupling.linear_loop import CHECKED
from springpot.codegen.plan import Plan
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.simulation.cases import held_case
from springpot.host.simulation.hand_loop import HandLoop
from springpot.host.simulation.scenarios import Workspace
from springpot.host.stability.closed_loop import Outcome, Rendered, case_outcome
from springpot.host.stability.small_signal import Map

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


def outcome_words(outcomes: Sequence[Outcome], stable: bool) -> Iterator[str]:
    """Sentences on the closed loop. stable: whether the linear loop is."""
    judged = [judge(item) for item in outcomes]
    for fault in Fault:
        if found := [item.outcome for item in judged if fault in item.faults]:
            yield f"{fault.value}: {_named(found)}."
    if not any(item.faults for item in judged) and stable:
        yield f"All cases are bounded and quiet with all hands; {_differs_by(outcomes)}."
    ended = [item for item in judged if item.grade == Grade.ENDS]
    if ended:
        last_ms = 1e3 * max(item.outcome.latched_s or 0.0 for item in ended)
        names = ", ".join(dict.fromkeys(item.outcome.case for item in ended))
        yield (
            f"Not counted: {names}, for too few samples come: the scene ends them after at most "
            f"{last_ms:.0f} ms, as it should."
        )


def map_words(model_map: Map) -> Iterator[str]:
    """A sentence on active cells of the model."""
    active, cells = model_map.active(False)
    if active:
        yield (
            f"The model is not passive in {active} of {cells} small-signal cells: a light hand "
            "may feel it buzz; hammerstein has none."
        )


def device_words(plan: Plan) -> Iterator[str]:
    """Sentences on the device and the coupling."""
    may_n, most_n = plan.scene.device.max_force_n, plan.max_force_n
    if may_n is not None and may_n < most_n:
        yield (
            f"The scene's force may reach {most_n:.3g} N and its device gives {may_n:g} N, so "
            f"`run` will refuse it: set guard.max_force_n = {may_n:g}."
        )
    yield f"Coupling {plan.coupling.why}."


def vibrates(plan: Plan, library: SceneLibrary) -> bool:
    """Tell if a scene vibrates above 1 mm/s in some hand that holds still."""
    scene, space = Rendered(plan, HandLoop(library), library, library), Workspace.of(plan)
    held = (
        case_outcome(scene, held_case(space, scene.felt, hand), hand, more)
        for hand, more in CHECKED
    )
    return any(Fault.LOUD in judge(outcome).faults for outcome in held)


def why_unbounded(scene: str, outcomes: Sequence[Outcome]) -> str:
    """Why a scene is not to be held, though its linear loop is stable; empty if nothing says so."""
    unbounded = [item.outcome for item in map(judge, outcomes) if item.unbounded]
    if not unbounded:
        return ""
    return (
        f"{scene}: the closed loop is not bounded on {_named(unbounded)}: do not hold "
        "the device with this scene; what may do is a higher guard.max_force_n if the force "
        "reaches it, coupling.mode = auto, a higher runtime.rate_hz, a passive model (hammerstein),"
        " a device of less delay or a softer object"
    )


def _differs_by(outcomes: Sequence[Outcome]) -> str:
    """How far what is felt is from the model, by the greatest figure of each part."""
    whole = [item for item in outcomes if item.losses is None]
    stiff = max(item.fidelity_percent for item in whole if item.played.stiffer)
    soft = max(item.fidelity_percent for item in whole if not item.played.stiffer)
    lossy = [item for item in outcomes if item.losses is not None and not item.played.ends]
    percent = max((item.fidelity_percent for item in lossy), default=0.0)
    return (
        f"what is felt differs from the model by at most {soft:.1f} % of peak, with lost samples "
        f"by {percent:.1f} %, with the object ten times stiffer by {stiff:.1f} %"
    )


def _named(items: Sequence[Outcome]) -> str:
    """Each case once, with the hands that it happened to."""
    hands: dict[str, list[str]] = {}
    for item in items:
        late = f", delay {item.delay_samples}" if item.late else ""
        hands.setdefault(item.case, []).append(f"{item.hand}{late}")
    return ", ".join(
        f"{case} ({'every hand' if len(found) == len(CHECKED) else '; '.join(found)})"
        for case, found in hands.items()
    )
