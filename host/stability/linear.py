"""The linear loop of a scene: what `emit` refuses, and what it would allow instead."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

from springpot.codegen.coupling.auto import select_coupling
from springpot.codegen.coupling.gains import (
    is_unit_error,
    max_published_damping_nspm,
    published_step_is_stable,
    require_plausible_damping,
)
from springpot.codegen.coupling.linear_loop import DESIGN_HAND, HAND_MODELS, Hand, LinearLoop
from springpot.codegen.errors import SpringpotError, UnsafeError
from springpot.codegen.make_plan import SERVED_HZ, make_plan
from springpot.codegen.messages import counted_noun
from springpot.codegen.plan import Plan
from springpot.codegen.types import JsonObject


def scene_loop(plan: Plan, hand: Hand, more_delay: int = 0) -> LinearLoop:
    """The linear loop of a plan with a hand."""
    smoothing = 1.0 if plan.smooth_alpha is None else float(plan.smooth_alpha)
    device = plan.loop_device.with_delay(more_delay)
    return LinearLoop(plan.dt_s, plan.coupling.coupling, hand, device, smoothing)


def is_stable(plan: Plan, loop: LinearLoop) -> bool:
    """Whether a loop may be held: stable with the object where it is stiffest, and all softer."""
    return (
        float(loop.spectral_radius(plan.stiffness_npm)[0]) < 1.0
        and loop.max_stiffness_npm() > plan.stiffness_npm
        and not is_unit_error(plan.coupling.coupling)
    )


def linear_loop_sentence(stable: bool, radius: float) -> str:
    """What the linear loop means for a hand, in a sentence."""
    if not stable:
        return "Unstable: do not hold the device with this scene."
    return f"The linear loop is stable (radius {radius:.4f})."


def plans_at_higher_rates(plan: Plan) -> Iterator[Plan]:
    """The plan at each higher rate that devices are served at, the lowest first."""
    for rate_hz in SERVED_HZ:
        if rate_hz * plan.dt_s > 1.001:
            scene = replace(plan.scene, runtime=replace(plan.scene.runtime, rate_hz=rate_hz))
            with suppress(SpringpotError):  # of a scene that cannot tick so fast
                yield make_plan(plan.model, scene, accept_unsafe=True)


def stiffness_limits(plan: Plan) -> JsonObject:
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
        f"{object_npmm:.4g} N/mm, this coupling allows {limit_npmm:.3g} N/mm"
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
    choice = select_coupling(plan.stiffness_npm, plan.dt_s, device, 1.0, plan.coupling.coupling)
    found, loop = choice.coupling, LinearLoop(plan.dt_s, choice.coupling, DESIGN_HAND, device)
    if not is_stable(plan, loop):
        return (
            f"no coupling is stable at {1 / plan.dt_s:g} Hz with "
            f"{counted_noun(device.delay_samples, 'sample')} of delay: {_what_holds_it(plan)}"
        )
    return (
        f'this would be stable: coupling.mode = "{found.mode}", stiffness_npm = '
        f"{found.stiffness_npm:g}, damping_nspm = {found.damping_nspm:g}, mass_kg = "
        f"{found.mass_kg:g}, no smoothing, no delay or a faster loop"
    )


def _what_holds_it(plan: Plan) -> str:
    """The lowest rate at which a coupling is stable, if there is one, or what else would help."""
    less_delay = "take a device of less delay" if plan.loop_device.delay_samples else ""
    either = f", or {less_delay}" if less_delay else ""
    if not plan.model.exact_at_any_rate:
        way = "record at a higher rate, or take a kind of model that holds at any (hammerstein)"
        return way + either
    for faster in plans_at_higher_rates(plan):
        if is_stable(faster, scene_loop(faster, DESIGN_HAND)):
            return f"raise runtime.rate_hz to {1.0 / faster.dt_s:g}{either}"
    return (
        f"nor at a higher rate: {1e-3 * plan.stiffness_npm:.4g} N/mm are stiffer than a device "
        f"can render{': ' + less_delay if less_delay else ''}"
    )
