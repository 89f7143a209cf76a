"""The stability check: linear loop, small-signal maps, closed loop; and what it all means."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

from springpot.codegen.coupling.auto import choose_coupling
from springpot.codegen.coupling.gains import (
    is_unit_error,
    max_published_damping_nspm,
    published_step_is_stable,
    require_plausible_damping,
)
from springpot.codegen.coupling.linear_loop import DESIGN_HAND, HAND_MODELS, Hand, LinearLoop
from springpot.codegen.errors import UnsafeError
from springpot.codegen.plan.plan import Plan
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.native.trial_build import built, uncoupled
from springpot.host.simulation.hand_loop import HandLoop
from springpot.host.stability.closed_loop import (
    MORE_DELAY,
    Outcome,
    Rendered,
    run_closed_loop,
    stiff_plan,
)
from springpot.host.stability.judgement import Grade, device_advice, judge
from springpot.host.stability.small_signal import Map, small_signal_map


@dataclass(frozen=True, eq=False)
class Check:
    """Parts (a) and (b): what `emit` decides by. scene_map: coupling, smoothing and delay too."""

    plan: Plan
    spectral_radius: float
    model_map: Map
    scene_map: Map

    @property
    def stable(self) -> bool:
        """Whether `emit` would take it."""
        return is_stable(self.plan, scene_loop(self.plan, DESIGN_HAND))

    def as_dict(self) -> dict[str, Any]:
        return {
            "scene": self.plan.scene.name,
            "spectral_radius": self.spectral_radius,
            "stable": self.stable,
            "device": self.plan.loop_device.as_dict(self.plan.dt_s),
            "limit": limits(self.plan),
            **self.model_map.as_dict(),
            "scene_map": self.scene_map.as_dict(),
        }


@dataclass(frozen=True, eq=False)
class Stability:
    """The whole check. stiff: plan of the object ten times stiffer."""

    check: Check
    stiff: Plan
    outcomes: tuple[Outcome, ...]

    @property
    def whole(self) -> tuple[Outcome, ...]:
        """The cases in which every sample comes, or goes wrong in a way of its own."""
        return tuple(outcome for outcome in self.outcomes if outcome.losses is None)

    def as_dict(self) -> dict[str, Any]:
        """Keys of `stability --json`."""
        return {
            **self.check.as_dict(),
            "coupling": self.check.plan.coupling.why,
            "felt_stiffness_npm": self.check.plan.coupling.felt_npm,
            "stiff": {
                "coupling": self.stiff.coupling.why,
                "felt_stiffness_npm": self.stiff.coupling.felt_npm,
            },
            "closed_loop": [outcome.as_dict() for outcome in self.outcomes],
            "recommendation": self.recommendation,
        }

    @property
    def recommendation(self) -> str:
        """The verdict in words."""
        return " ".join(_verdict(self))


def scene_loop(plan: Plan, hand: Hand, more_delay: int = 0) -> LinearLoop:
    """The linear loop of a plan with a hand."""
    smoothing = 1.0 if plan.smooth_alpha is None else float(plan.smooth_alpha)
    device = plan.loop_device.later(more_delay)
    return LinearLoop(plan.dt_s, plan.coupling.coupling, hand, device, smoothing)


def is_stable(plan: Plan, loop: LinearLoop) -> bool:
    """Whether a loop may be held: stable with the object where it is stiffest, and all softer."""
    return (
        float(loop.spectral_radius(plan.stiffness_npm)[0]) < 1.0
        and loop.max_stiffness_npm() > plan.stiffness_npm
        and not is_unit_error(plan.coupling.coupling)
    )


def loop_words(stable: bool, radius: float) -> str:
    """What the linear loop means for a hand, in a sentence."""
    if not stable:
        return "Unstable: do not hold the device with this scene."
    return f"The linear loop is stable (radius {radius:.4f})."


def limits(plan: Plan) -> dict[str, Any]:
    """What would be allowed: the object's stiffness by hand and delay; damping of Algorithm 1."""
    coupling = plan.coupling.coupling
    return {
        "object_stiffness_npm": plan.stiffness_npm,
        "max_stiffness_npm": {
            f"{hand.name}, {more} more samples": scene_loop(plan, hand, more).max_stiffness_npm()
            for hand in HAND_MODELS
            for more in (0, 1)
        },
        "published_step_is_stable": published_step_is_stable(coupling, plan.dt_s),
        "published_max_damping_nspm": max_published_damping_nspm(coupling, plan.dt_s),
        "design_hand": DESIGN_HAND.name,
    }


def spectral_radius(plan: Plan) -> float:
    """Of the linear loop with the design hand, the object at its maximum tangent stiffness."""
    return float(scene_loop(plan, DESIGN_HAND).spectral_radius(plan.stiffness_npm)[0])


def require_stable(plan: Plan) -> None:
    """Raise UnsafeError for a radius >= 1 or a unit error, naming gains that are stable."""
    if plan.couple is not None:
        require_plausible_damping(plan.coupling.coupling)
    loop, object_npmm = scene_loop(plan, DESIGN_HAND), 1e-3 * plan.stiffness_npm
    if is_stable(plan, loop):
        return
    radius, limit_npmm = spectral_radius(plan), 1e-3 * loop.max_stiffness_npm()
    found = (
        f"spectral radius {radius:.4g} with the {DESIGN_HAND.name} hand, object "
        f"{object_npmm:.3g} N/mm, this coupling allows {limit_npmm:.3g} N/mm"
    )
    if radius < 1.0:
        found += ": an object as stiff as that is passed where this one is touched first"
    raise UnsafeError(
        f"{plan.scene.name}: the loop is unstable ({found}): {_what_is_stable(plan)}; "
        "or emit with --accept-unsafe, for replay only"
    )


def _what_is_stable(plan: Plan) -> str:
    """Gains that would do without smoothing, or that none do at this rate and delay."""
    device = plan.loop_device
    choice = choose_coupling(plan.stiffness_npm, plan.dt_s, device, 1.0, plan.coupling.coupling)
    found, loop = choice.coupling, LinearLoop(plan.dt_s, choice.coupling, DESIGN_HAND, device)
    if not is_stable(plan, loop):
        return (
            f"no coupling is stable at {1 / plan.dt_s:g} Hz with {device.delay_samples} samples "
            "of delay: raise runtime.rate_hz, or take a device of less delay"
        )
    return (
        f'this would be stable: coupling.mode = "{found.mode}", stiffness_npm = '
        f"{found.stiffness_npm:g}, damping_nspm = {found.damping_nspm:g}, mass_kg = "
        f"{found.mass_kg:g}, no smoothing, no delay or a faster loop"
    )


def check(plan: Plan, library: SceneLibrary) -> Check:
    """Parts (a) and (b) of a scene that is built."""
    with ExitStack() as stack:
        model = _model_library(plan, library, stack)
        return _checked(plan, library, model)


def stability(plan: Plan) -> Stability:
    """Everything, through the C that would be emitted."""
    stiff = stiff_plan(plan)
    with ExitStack() as stack:
        scene, hard = (_rendered(item, stack) for item in (plan, stiff))
        checked = _checked(plan, scene.library, scene.model)
        outcomes = tuple(run_closed_loop(scene, hard))
    return Stability(checked, stiff, outcomes)


def _checked(plan: Plan, library: SceneLibrary, model: SceneLibrary) -> Check:
    delay = plan.loop_device.delay_samples
    model_map = small_signal_map(plan, model, 0)
    same = model is library and delay == 0
    return Check(
        plan=plan,
        spectral_radius=spectral_radius(plan),
        model_map=model_map,
        scene_map=model_map if same else small_signal_map(plan, library, delay),
    )


def _rendered(plan: Plan, stack: ExitStack) -> Rendered:
    library = stack.enter_context(built(plan))
    return Rendered(plan, HandLoop(library), library, _model_library(plan, library, stack))


def _model_library(plan: Plan, library: SceneLibrary, stack: ExitStack) -> SceneLibrary:
    model = uncoupled(plan)
    return library if model is plan else stack.enter_context(built(model))


def _verdict(result: Stability) -> Iterator[str]:
    checked, plan = result.check, result.check.plan
    judged = [judge(item) for item in result.outcomes]
    yield loop_words(checked.stable, checked.spectral_radius)
    kicks = [item for item in judged if item.kicks]
    grave = [item for item in kicks if item.grade == Grade.BAD]
    found = {
        "Not bounded": [item for item in judged if item.unbounded],
        "Vibrates above 1 mm/s on": [item for item in judged if item.loud],
        "Lost samples are felt as a kick on": grave,
        "Lost samples are felt as a kick, at four times the trained speed, on": [
            item for item in kicks if item not in grave
        ],
        "Fidelity error above 10 % of peak on": [item for item in judged if item.unfaithful],
    }
    for what, items in found.items():
        if items:
            yield f"{what}: {_named([item.outcome for item in items])}."
    if not any(found.values()) and checked.stable:
        yield f"All cases are bounded and quiet with all hands; {_differs_by(result)}."
    active, cells = checked.model_map.active(False)
    if active:
        yield (
            f"The model is not passive in {active} of {cells} small-signal cells: a light hand "
            "may feel it buzz; hammerstein, or boosted with --monotone, has none."
        )
    yield from device_advice(plan)
    yield f"Coupling {plan.coupling.why}."


def _differs_by(result: Stability) -> str:
    """How far what is felt is from the model, by the greatest figure of each part."""
    stiff = max(item.fidelity_percent for item in result.whole if item.stiffer)
    whole = max(item.fidelity_percent for item in result.whole if not item.stiffer)
    lossy = [item.fidelity_percent for item in result.outcomes
             if item.losses is not None and judge(item).grade != Grade.UNJUDGED]  # fmt: skip
    return (
        f"what is felt differs from the model by at most {whole:.1f} % of peak, with lost samples "
        f"by {max(lossy, default=0.0):.1f} %, with the object ten times stiffer by {stiff:.1f} %"
    )


def _named(items: Sequence[Outcome]) -> str:
    """Each case once, with the hands that it happened to."""
    hands: dict[str, list[str]] = {}
    for item in items:
        late = f", delay {item.delay_samples}" if item.late else ""
        hands.setdefault(item.case, []).append(f"{item.hand}{late}")
    every = len(HAND_MODELS) * len(MORE_DELAY)
    return ", ".join(
        f"{case} ({'every hand' if len(found) == every else '; '.join(found)})"
        for case, found in hands.items()
    )
