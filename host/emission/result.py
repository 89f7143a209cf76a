"""What was emitted: its sizes against the budget, what it leaves of the object's stiffness."""

from dataclasses import dataclass
from pathlib import Path

from springpot.codegen.coupling.linear_loop import CHECKED_HANDS
from springpot.codegen.errors import BudgetError
from springpot.codegen.make_plan import MIN_FELT_FRACTION
from springpot.codegen.messages import counted_noun
from springpot.codegen.plan import Plan
from springpot.codegen.scene import Budget
from springpot.codegen.types import JsonObject
from springpot.host.emission.boards import TickCost
from springpot.host.native.toolchain import Footprint
from springpot.host.stability.check import Check
from springpot.host.stability.linear import plan_margin, plans_at_higher_rates
from springpot.host.stability.verdict import MAX_QUIET_SPEED_MPS

# Keys of `emit --json` that the manifest has too.
_OF_MANIFEST = ("units", "left_out", "orders", "coupling", "outside", "accept_unsafe")


@dataclass(frozen=True)
class Emission:
    """Result of `emit`. footprint, compile_s, check: None without a compiler; notices say why.

    selftest_bytes: flash that the self-test adds. cost: of a tick, on an emulated board.

    unmeasured: why there is no footprint, and what to install; empty where there is one.

    >>> emission = emit("c", model=model)
    >>> emission.ram_bytes < 1000
    True
    """

    folder: Path
    plan: Plan
    manifest: JsonObject
    hash: str
    footprint: Footprint | None
    selftest_bytes: int | None
    cost: TickCost
    unmeasured: str
    ram_bytes: int
    write_s: float
    compile_s: float | None
    check: Check | None
    notices: tuple[str, ...]

    def __repr__(self) -> str:
        flash = f"flash {self.flash_bytes}, " if self.footprint else ""
        return f"Emission({str(self.folder)!r}, {flash}RAM {self.ram_bytes} bytes)"

    @property
    def flash_bytes(self) -> int | None:
        """Code, constants and initialised data of the scene; None without a compiler."""
        return self.footprint.flash_bytes if self.footprint else None

    @property
    def stack_bytes(self) -> int | None:
        """Deepest stack of a call; None without a compiler that reports it."""
        return self.footprint.stack_bytes if self.footprint else None

    def as_dict(self) -> JsonObject:
        """Return keys of `emit --json`."""
        return {
            "out": str(self.folder),
            "hash": self.hash,
            "flash_bytes": self.flash_bytes,
            "selftest_bytes": self.selftest_bytes,
            "ram_bytes": self.ram_bytes,
            "stack_bytes": self.stack_bytes,
            "instructions": self.cost.usual,
            "instructions_after_silence": self.cost.after_silence,
            **{key: self.manifest.get(key) for key in _OF_MANIFEST},
            "stability": self.check.as_dict() if self.check else None,
            "write_s": self.write_s,
            "compile_s": self.compile_s,
        }


def over_budget(emission: Emission, budget: Budget) -> str:
    """Return all sizes that are over the budget, with the budget's; nothing if all fit.

    Raises BudgetError if a size that has a budget is not known: which, why, what to do.
    """
    missing = emission.unmeasured
    whys = {"flash": missing, "stack": missing or "this compiler does not report it: use gcc"}
    over = []
    for what, has, may in (
        ("flash", emission.flash_bytes, budget.flash_bytes),
        ("RAM", emission.ram_bytes, budget.ram_bytes),
        ("stack", emission.stack_bytes, budget.stack_bytes),
    ):
        if may is not None and has is None:
            raise BudgetError(
                f"{what}: could not be measured for its budget of {may} bytes: {whys[what]}; or "
                "remove the budget's key"
            )
        if may is not None and has is not None and has > may:
            over.append(f"{what}: {has} bytes, the scene's budget is {may}")
    return "; ".join(over)


def coupling_notices(plan: Plan) -> list[str]:
    """Warn if a hand feels less than 80 % of the stiffness, or if `auto` left no spare delay."""
    felt_npm, object_npm = plan.coupling.felt_npm, plan.stiffness_npm
    notices = []
    margin = plan_margin(plan, CHECKED_HANDS)
    if plan.scene.coupling.mode == "auto" and not margin.is_stable:
        notices.append(
            f"warning: the {margin.hand_text} holds {margin.object_text} only "
            f"{margin.least:.2g} times as stiff as it is: state the device's delay, or take a "
            "faster loop"
        )
    if felt_npm >= MIN_FELT_FRACTION * object_npm:
        return notices
    why = "the scene states that coupling"
    if plan.scene.coupling.mode == "auto":
        late = plan.loop_device.delay_samples
        behind = f", {counted_noun(late, 'sample')} late," if late else ""
        why = f"a loop at {1.0 / plan.dt_s:g} Hz{behind} holds no stiffer one"
    return [
        *notices,
        f"warning: the hand feels {1e-3 * felt_npm:.3g} of the object's {1e-3 * object_npm:.3g} "
        f"N/mm, for {why}: {_remedy(plan)}",
    ]


def vibration_notices(checked: Check) -> list[str]:
    """Warn if a hold vibrates so that a hand feels it."""
    loudest = checked.loudest
    if loudest.hold_speed_mps <= MAX_QUIET_SPEED_MPS:
        return []
    return [
        f"warning: a hold vibrates with {1e3 * loudest.hold_speed_mps:.2g} mm/s in the "
        f"{loudest.hand} hand: see `springpot stability`"
    ]


def rate_notices(plan: Plan) -> list[str]:
    """Say that a scene without a rate does not tick at that of the recordings; else nothing."""
    if not plan.chose_rate:
        return []
    return [
        f"warning: the scene ticks at {1.0 / plan.dt_s:g} Hz, for at the recordings' "
        f"{1.0 / plan.model.dt_s:g} Hz a hand would feel less than "
        f"{100 * MIN_FELT_FRACTION:g} % of the object's stiffness: if the device "
        "is served at another rate, state [runtime] rate_hz"
    ]


def _remedy(plan: Plan) -> str:
    """Return what would leave a hand more of the object's stiffness: a faster loop, less delay."""
    if plan.scene.coupling.mode != "auto":
        return 'state a stiffer [coupling], or mode = "auto", or "off" if `stability` allows it'
    if not plan.model.exact_at_any_rate:
        return (
            "record at a higher rate, or take a kind of model that holds at any rate (hammerstein)"
        )
    faster = list(plans_at_higher_rates(plan))
    enough = [
        candidate
        for candidate in faster
        if candidate.coupling.felt_npm >= MIN_FELT_FRACTION * plan.stiffness_npm
    ]
    remedy = next(iter(enough or faster), plan)
    if remedy.coupling.felt_npm <= plan.coupling.felt_npm:
        return "a device of less delay and more damping is needed, or [device] states yours"
    return (
        f"{plan.model.kind} holds at any rate: [runtime] rate_hz = {1.0 / remedy.dt_s:g} gives "
        f"{1e-3 * remedy.coupling.felt_npm:.3g} N/mm, if the device is served at it and "
        "`springpot stability` finds that good"
    )
