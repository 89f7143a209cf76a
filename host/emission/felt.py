"""What the coupling leaves of the object's stiffness, and what would leave more."""

from dataclasses import replace

from springpot.codegen.errors import SpringpotError
from springpot.codegen.make_plan import FELT_SHARE, SERVED_HZ, make_plan
from springpot.codegen.messages import number_of
from springpot.codegen.plan import Plan


def felt_notices(plan: Plan) -> list[str]:
    """Warn if a hand feels less than 80 % of the stiffness, or if not every hand holds the loop."""
    felt_npm, object_npm = plan.coupling.felt_npm, plan.stiffness_npm
    notices = []
    if not plan.coupling.every_hand:
        notices.append(
            f"warning: no coupling at {1.0 / plan.dt_s:g} Hz is stable with every hand: let no "
            "hand hold it before `springpot stability` says so, or take a faster loop"
        )
    if felt_npm >= FELT_SHARE * object_npm:
        return notices
    return [
        *notices,
        f"warning: the hand feels {1e-3 * felt_npm:.3g} of the object's {1e-3 * object_npm:.3g} "
        f"N/mm, for {_why(plan)}: {_remedy(plan)}",
    ]


def rate_notices(plan: Plan) -> list[str]:
    """Say that a scene without a rate does not tick at that of the recordings; else nothing."""
    if not plan.chose_rate:
        return []
    return [
        f"warning: the scene ticks at {1.0 / plan.dt_s:g} Hz, for at the recordings' "
        f"{1.0 / plan.model.dt_s:g} Hz a hand would feel less than {100 * FELT_SHARE:g} % of the "
        "object's stiffness: if the device is served at another rate, state [runtime] rate_hz"
    ]


def _why(plan: Plan) -> str:
    if plan.scene.coupling.mode != "auto":
        return "the scene states that coupling"
    late = plan.loop_device.delay_samples
    behind = f", {number_of(late, 'sample')} late," if late else ""
    return f"a loop at {1.0 / plan.dt_s:g} Hz{behind} holds no stiffer one"


def _remedy(plan: Plan) -> str:
    if plan.scene.coupling.mode != "auto":
        return 'state a stiffer [coupling], or mode = "auto", or "off" if `stability` allows it'
    if not plan.model.exact_at_any_rate:
        return (
            "record at a higher rate, or take a kind of model that holds at any rate (hammerstein)"
        )
    found = max(
        (faster for rate in SERVED_HZ if (faster := _at_rate(plan, rate)) is not None),
        key=lambda faster: (faster[1] >= FELT_SHARE * plan.stiffness_npm, -faster[0]),
        default=None,
    )
    if found is None or found[1] <= plan.coupling.felt_npm:
        return "a device of less delay and more damping is needed, or [device] states yours"
    rate_hz, felt_npm = found
    return (
        f"{plan.model.kind} holds at any rate: [runtime] rate_hz = {rate_hz:g} gives "
        f"{1e-3 * felt_npm:.3g} N/mm, if the device is served at it"
    )


def _at_rate(plan: Plan, rate_hz: float) -> tuple[float, float] | None:
    """A higher rate, Hz, and the stiffness that is felt there, N/m."""
    if rate_hz * plan.dt_s <= 1.001:
        return None
    scene = replace(plan.scene, runtime=replace(plan.scene.runtime, rate_hz=rate_hz))
    try:
        return rate_hz, make_plan(plan.model, scene, plan.accept_unsafe).coupling.felt_npm
    except SpringpotError:
        return None
