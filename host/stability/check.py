"""The stability check: linear loop, small-signal maps, closed loop; and what it all means."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from springpot.codegen.coupling.loop_margin import LoopMargin
from springpot.codegen.errors import UnsafeError
from springpot.codegen.messages import short_repr
from springpot.codegen.plan import Plan
from springpot.codegen.types import JsonObject
from springpot.host.native.scene_library import SceneLibrary, build_and_load
from springpot.host.stability.closed_loop import (
    BuiltScene,
    Outcome,
    closed_loop_outcomes,
    hold_outcomes,
    rendered,
    stiff_plan,
)
from springpot.host.stability.linear import (
    is_stable,
    margin_sentence,
    plan_margin,
    plans_at_higher_rates,
    require_stable,
    spectral_radius,
    stiffness_limits,
)
from springpot.host.stability.small_signal import SmallSignalMap, small_signal_map
from springpot.host.stability.verdict import (
    MAX_STABLE_SPEED_MPS,
    closed_loop_sentences,
    device_sentences,
    passivity_sentences,
    refusal_reason,
)
from springpot.trainer.recordings.recording import axes_for_plot

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False)
class Check:
    """Results that `emit` decides by. scene_map: with coupling, smoothing and delay.

    holds: of the emitted C in the closed loop with each hand.
    """

    plan: Plan
    model_map: SmallSignalMap
    scene_map: SmallSignalMap
    holds: tuple[Outcome, ...]
    __repr__ = short_repr

    @property
    def margin(self) -> LoopMargin:
        """Gain margin over all hands at the device's own delay."""
        return plan_margin(self.plan)

    @property
    def loudest(self) -> Outcome:
        """The hold that vibrates most."""
        return max(self.holds, key=lambda hold: hold.hold_speed_mps)

    @property
    def stable(self) -> bool:
        """True if `emit` accepts the scene: by its gain margin, and by holds of the emitted C."""
        return is_stable(self.plan) and self.loudest.hold_speed_mps <= MAX_STABLE_SPEED_MPS

    @property
    def sentence(self) -> str:
        """The verdict."""
        if self.loudest.hold_speed_mps > MAX_STABLE_SPEED_MPS and self.margin.is_stable:
            return (
                f"Unstable in the {self.loudest.hand} hand, in which a hold vibrates with "
                f"{1e3 * self.loudest.hold_speed_mps:.3g} mm/s: do not hold the device with this "
                "scene."
            )
        return margin_sentence(self.margin)

    def require_stable(self) -> None:
        """Raise UnsafeError if the margin is too small, or a hold of the emitted C vibrates."""
        require_stable(self.plan)  # by the margin; it names gains that do
        if not self.stable:
            raise UnsafeError(
                f'{self.plan.scene.name}: {self.sentence} Take coupling.mode = "auto", a passive '
                "model (hammerstein), a finer encoder or less delay; or emit with "
                "--accept-unsafe, for replay only"
            )

    def as_dict(self) -> JsonObject:
        """Return keys of `stability --json` that the check knows."""
        return {
            "scene": self.plan.scene.name,
            "spectral_radius": spectral_radius(self.plan),
            "stable": self.stable,
            "held_times_as_stiff": self.margin.least,
            "worst_hand": self.margin.hand.name,
            "expected_vibration_mps": self.margin.vibration_mps,
            "hold_vibration_mps": self.loudest.hold_speed_mps,
            "device": self.plan.loop_device.as_dict(self.plan.dt_s),
            "limit": stiffness_limits(self.plan),
            **self.model_map.as_dict(),
            "scene_map": self.scene_map.as_dict(),
        }


@dataclass(frozen=True, eq=False)
class Stability:
    """The whole check. stiff: plan of the object ten times stiffer.

    >>> stability(model=model).check.stable
    True
    """

    check: Check
    stiff: Plan
    outcomes: tuple[Outcome, ...]

    def __repr__(self) -> str:
        return f"Stability({self._headline} {len(self.outcomes)} cases of the closed loop)"

    def as_dict(self) -> JsonObject:
        """Return keys of `stability --json`."""
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

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the small-signal map of the scene on matplotlib's axes, on new ones if none given.

        Return the axes. Raises UsageError where matplotlib is not installed.
        """
        axes = axes_for_plot(ax)
        self.check.scene_map.draw(axes)
        axes.set_title(self.check.plan.scene.name, loc="left", fontsize=9)
        return axes

    @property
    def _headline(self) -> str:
        """Begin the verdict: with the closed loop, if that refuses, before small motions."""
        if self.check.stable and refusal_reason(self.check.plan.scene.name, self.outcomes):
            return (
                f"Do not hold the device with this scene. In small motions: {self.check.sentence}"
            )
        return self.check.sentence

    @property
    def recommendation(self) -> str:
        """The verdict in words."""
        checked, plan = self.check, self.check.plan
        sentences = [
            self._headline,
            *closed_loop_sentences(self.outcomes, checked.stable),
            *passivity_sentences(checked.model_map),
            *device_sentences(plan),
        ]
        return " ".join(sentences)

    def require_bounded(self) -> None:
        """Raise UnsafeError where a hand cannot hold the scene, or a case is not bounded."""
        self.check.require_stable()
        why = refusal_reason(self.check.plan.scene.name, self.outcomes)
        if why:
            raise UnsafeError(f"{why}. {_remedy(self.check.plan)}")


def _remedy(plan: Plan) -> str:
    """Return the lowest rate at which no case is refused, or what else would help."""
    for faster in plans_at_higher_rates(plan):
        if is_stable(faster) and not refusal_reason("", stability(faster).outcomes):
            return (
                f"With runtime.rate_hz = {1.0 / faster.dt_s:g} it holds, if the device is served "
                "at that rate"
            )
    others = [
        'coupling.mode = "auto"' if plan.scene.coupling.mode != "auto" else "",
        "a passive model (hammerstein)" if plan.model.regressor is not None else "",
        "a device of less delay" if plan.loop_device.delay_samples else "",
        "a device of more mass and damping ([device] states yours)",
    ]
    return f"Take {', '.join(filter(None, others))}, or a softer object"


def check(plan: Plan, library: SceneLibrary) -> Check:
    """Check a scene that is built: gain margin, holds, and small-signal maps."""
    return _checked(rendered(plan, library))


def require_held(plan: Plan, library: SceneLibrary) -> None:
    """Raise UnsafeError for an emission that was accepted as unstable, before a hand has it."""
    if plan.accept_unsafe:
        check(plan, library).require_stable()


def stability(plan: Plan) -> Stability:
    """Everything, through the C that would be emitted."""
    stiff = stiff_plan(plan)
    scene, hard = (rendered(item, build_and_load(item)) for item in (plan, stiff))
    return Stability(_checked(scene), stiff, tuple(closed_loop_outcomes(scene, hard)))


def _checked(scene: BuiltScene) -> Check:
    """Map small motions of the model and of the scene, and let hands hold it."""
    plan, delay = scene.plan, scene.plan.loop_device.delay_samples
    model_map = small_signal_map(plan, scene.model, 0)
    same = scene.model is scene.library and delay == 0
    return Check(
        plan=plan,
        model_map=model_map,
        scene_map=model_map if same else small_signal_map(plan, scene.library, delay),
        holds=tuple(hold_outcomes(scene)),
    )
