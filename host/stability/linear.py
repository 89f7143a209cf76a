"""The linear loop of a scene: what `emit` refuses, and what it would allow instead."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace

from springpot.codegen.coupling.auto import select_coupling
from springpot.codegen.coupling.gains import (
    is_implausible,
    max_published_damping_nspm,
    published_step_is_stable,
    require_plausible_damping,
)
from springpot.codegen.coupling.linear_loop import (
    CHECKED_HANDS,
    DESIGN_HAND,
    HAND_MODELS,
    Hand,
    LinearLoop,
)
from springpot.codegen.coupling.loop_margin import LoopMargin, compute_loop_margin
from springpot.codegen.errors import SpringpotError, UnsafeError
from springpot.codegen.make_plan import SERVED_HZ, make_plan
from springpot.codegen.messages import counted_noun
from springpot.codegen.plan import Plan
from springpot.codegen.types import JsonObject

OWN_DELAY = tuple((hand, extra) for hand, extra in CHECKED_HANDS if not extra)


def scene_loop(plan: Plan, hand: Hand, extra_delay: int = 0) -> LinearLoop:
    """Return the linear loop of a plan with a hand, its object a spring."""
    smoothing = 1.0 if plan.smooth_alpha is None else float(plan.smooth_alpha)
    device = plan.loop_device.with_delay(extra_delay)
    return LinearLoop(plan.dt_s, plan.coupling.coupling, hand, device, smoothing)


def plan_margin(plan: Plan, hands: Sequence[tuple[Hand, int]] = OWN_DELAY) -> LoopMargin:
    """Compute the gain margin of a plan's loop in the worst of the hands."""
    smoothing = 1.0 if plan.smooth_alpha is None else float(plan.smooth_alpha)
    coupling = plan.coupling.coupling
    return compute_loop_margin(
        plan.tangent, coupling, plan.dt_s, plan.loop_device, smoothing, hands
    )


def is_stable(plan: Plan) -> bool:
    """Return True if every hand can hold the scene, at every depth and on all softer objects."""
    return plan_margin(plan).is_stable and not is_implausible(plan.coupling.coupling)


def margin_sentence(margin: LoopMargin, hands: str = "every hand") -> str:
    """Say whether a hand may hold the device, and by what margin; hands: those asked."""
    if not margin.is_stable:
        return (
            f"Unstable in the {margin.hand_text}, which holds {margin.object_text} only "
            f"{margin.least:.2g} times as stiff as it is: do not hold the device with this scene."
        )
    return (
        f"Stable in {hands}, up to {margin.least:.2g} times the stiffness of {margin.object_text}."
    )


def plans_at_higher_rates(plan: Plan) -> Iterator[Plan]:
    """Yield the plan at each higher rate that devices are served at, the lowest first."""
    for rate_hz in SERVED_HZ:
        if rate_hz * plan.dt_s > 1.001:
            scene = replace(plan.scene, runtime=replace(plan.scene.runtime, rate_hz=rate_hz))
            with suppress(SpringpotError):  # of a scene that cannot tick so fast
                yield make_plan(plan.model, scene, accept_unsafe=True)


def stiffness_limits(plan: Plan) -> JsonObject:
    """Return the limits: the object's stiffness by hand and delay; damping of Algorithm 1."""
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
    """Return the loop's spectral radius with the design hand and a spring of the largest secant."""
    return float(scene_loop(plan, DESIGN_HAND).spectral_radius(plan.stiffness_npm)[0])


def require_stable(plan: Plan) -> None:
    """Raise UnsafeError if a hand cannot hold the scene, or for a unit error; name gains that do.

    Every hand of CHECKED_HANDS, with the device's own delay.
    """
    if plan.couple is not None:
        require_plausible_damping(plan.coupling.coupling)
    if is_stable(plan):
        return
    margin = plan_margin(plan)
    raise UnsafeError(
        f"{plan.scene.name}: the loop is unstable (the {margin.hand_text} holds "
        f"{margin.object_text} only {margin.least:.2g} times as stiff as it is, "
        f"{1e-3 * plan.stiffness_npm:.4g} N/mm): "
        f"{_what_is_stable(plan)}; or emit with --accept-unsafe, for replay only"
    )


def _what_is_stable(plan: Plan) -> str:
    """Gains that would do without smoothing, or that none do at this rate and delay."""
    device = plan.loop_device
    choice = select_coupling(
        plan.tangent, plan.stiffness_npm, plan.dt_s, device, 1.0, plan.coupling.coupling
    )
    remedy = replace(plan, coupling=choice, smooth_alpha=None)
    if not is_stable(remedy):
        return (
            f"no coupling is stable at {1 / plan.dt_s:g} Hz with "
            f"{counted_noun(device.delay_samples, 'sample')} of delay: {_other_remedy(plan)}"
        )
    gains = choice.coupling
    if gains.mode == "off":
        return 'this would be stable: coupling.mode = "off", no smoothing'
    return (
        f'this would be stable: coupling.mode = "{gains.mode}", stiffness_npm = '
        f"{gains.stiffness_npm:g}, damping_nspm = {gains.damping_nspm:g}, mass_kg = "
        f"{gains.mass_kg:g}, without smoothing; a hand feels {1e-3 * choice.felt_npm:.3g} of its "
        f"{1e-3 * plan.stiffness_npm:.4g} N/mm then"
    )


def _other_remedy(plan: Plan) -> str:
    """The lowest rate at which a coupling is stable, if there is one, or what else would help."""
    less_delay = "take a device of less delay" if plan.loop_device.delay_samples else ""
    either = f", or {less_delay}" if less_delay else ""
    if not plan.model.exact_at_any_rate:
        way = "record at a higher rate, or take a kind of model that holds at any (hammerstein)"
        return way + either
    for faster in plans_at_higher_rates(plan):
        if is_stable(faster):
            return f"raise runtime.rate_hz to {1.0 / faster.dt_s:g}{either}"
    return (
        f"nor at a higher rate: {1e-3 * plan.stiffness_npm:.4g} N/mm are stiffer than a device "
        f"can render{': ' + less_delay if less_delay else ''}"
    )
