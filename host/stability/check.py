"""The stability check: linear loop, small-signal maps, closed loop; and what it all means."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from springpot.codegen.coupling.linear_loop import DESIGN_HAND
from springpot.codegen.errors import UnsafeError
from springpot.codegen.messages import short_repr
from springpot.codegen.plan import Plan
from springpot.codegen.types import JsonObject
from springpot.host.native.scene_library import SceneLibrary, build_and_load
from springpot.host.stability.closed_loop import (
    BuiltScene,
    Outcome,
    closed_loop_outcomes,
    rendered,
    stiff_plan,
)
from springpot.host.stability.linear import (
    is_stable,
    linear_loop_sentence,
    require_stable,
    scene_loop,
    spectral_radius,
    stiffness_limits,
)
from springpot.host.stability.small_signal import SmallSignalMap, small_signal_map
from springpot.host.stability.verdict import (
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
    """Parts (a) and (b): what `emit` decides by. scene_map: coupling, smoothing and delay too."""

    plan: Plan
    spectral_radius: float
    model_map: SmallSignalMap
    scene_map: SmallSignalMap
    __repr__ = short_repr

    @property
    def stable(self) -> bool:
        """Whether `emit` would take it."""
        return is_stable(self.plan, scene_loop(self.plan, DESIGN_HAND))

    def as_dict(self) -> JsonObject:
        return {
            "scene": self.plan.scene.name,
            "spectral_radius": self.spectral_radius,
            "stable": self.stable,
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
        loop = linear_loop_sentence(self.check.stable, self.check.spectral_radius)
        return f"Stability({loop} {len(self.outcomes)} cases of the closed loop)"

    def as_dict(self) -> JsonObject:
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

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the small-signal map of the scene on matplotlib's axes, on new ones if none given.

        Return the axes. Raises UsageError where matplotlib is not installed.
        """
        axes = axes_for_plot(ax)
        self.check.scene_map.draw(axes)
        axes.set_title(self.check.plan.scene.name, loc="left", fontsize=9)
        return axes

    @property
    def recommendation(self) -> str:
        """The verdict in words."""
        checked, plan = self.check, self.check.plan
        sentences = [
            linear_loop_sentence(checked.stable, checked.spectral_radius),
            *closed_loop_sentences(self.outcomes, checked.stable),
            *passivity_sentences(checked.model_map),
            *device_sentences(plan),
        ]
        return " ".join(sentences)

    def require_bounded(self) -> None:
        """Raise UnsafeError where the linear loop is not stable or the closed loop not bounded."""
        require_stable(self.check.plan)
        why = refusal_reason(self.check.plan.scene.name, self.outcomes)
        if why:
            raise UnsafeError(why)


def check(plan: Plan, library: SceneLibrary) -> Check:
    """Parts (a) and (b) of a scene that is built."""
    return _checked(rendered(plan, library))


def stability(plan: Plan) -> Stability:
    """Everything, through the C that would be emitted."""
    stiff = stiff_plan(plan)
    scene, hard = (rendered(item, build_and_load(item)) for item in (plan, stiff))
    return Stability(_checked(scene), stiff, tuple(closed_loop_outcomes(scene, hard)))


def _checked(scene: BuiltScene) -> Check:
    plan, delay = scene.plan, scene.plan.loop_device.delay_samples
    model_map = small_signal_map(plan, scene.model, 0)
    same = scene.model is scene.library and delay == 0
    return Check(
        plan=plan,
        spectral_radius=spectral_radius(plan),
        model_map=model_map,
        scene_map=model_map if same else small_signal_map(plan, scene.library, delay),
    )
