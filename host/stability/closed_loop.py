"""What the closed loop did: bounds, vibration, fidelity and energy of each case and hand."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.coupling.linear_loop import HAND_MODELS, Hand
from springpot.codegen.plan.plan import Plan, make_plan
from springpot.codegen.progress import at_step
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.simulation.hand_loop import HandLoop, Operator, Trace
from springpot.host.simulation.losses import TAKEN, losing_cases
from springpot.host.simulation.scenarios import Case, Workspace, cases, hold_case

HIGH_PASS_HZ = 15.0
DEEPEST = 1.3  # of the trained depth, beside what a proxy's spring gives
STIFFER = 10.0
MORE_DELAY = (0, 1)  # samples, beyond the device's own
# A loss is not felt where the force changes no faster than this, of the changes without one.
KICK_SHARE, KICK_N = 1.5, 0.1
_TOUCH = 0.05  # of the trained depth, and of the peak force: contact beyond doubt


@dataclass(frozen=True)
class Losses:
    """What losses of samples did to the force.

    force_step_n: its greatest change in a tick of contact; model_force_step_n: that of the model
    alone on the same motion. zero_ticks: of no force, with a sample, where the model alone has one.
    clean_...: of the same strokes without a loss.
    """

    force_step_n: float
    clean_force_step_n: float
    model_force_step_n: float
    zero_ticks: int
    clean_zero_ticks: int

    @property
    def kicks(self) -> bool:
        """Whether a hand feels it."""
        natural_n = max(self.clean_force_step_n, self.model_force_step_n)
        allowed_n = KICK_SHARE * natural_n + KICK_N
        return self.zero_ticks > self.clean_zero_ticks or self.force_step_n > allowed_n


@dataclass(frozen=True, eq=False)
class Outcome:
    """One case with one hand. model_only_n: the model alone under the same motion, (n,), N.

    late: with one more sample of delay than the device's own.
    """

    played: Case

    hand: str
    delay_samples: int
    bounded: bool
    max_depth_m: float
    max_force_n: float
    hf_speed_mps: float
    fidelity_percent: float
    energy_out_j: float
    trace: Trace
    model_only_n: Samples
    losses: Losses | None = None
    late: bool = False

    @property
    def case(self) -> str:
        """Name of the case."""
        return self.played.name

    @property
    def stiffer(self) -> bool:
        """Whether the object was made stiffer."""
        return self.played.stiffer

    def as_dict(self) -> dict[str, object]:
        names = (
            "hand", "case", "bounded", "max_depth_m", "delay_samples", "max_force_n",
            "hf_speed_mps", "fidelity_percent", "energy_out_j",
        )  # fmt: skip
        lost = {} if self.losses is None else asdict(self.losses)
        return {**{name: getattr(self, name) for name in names}, **lost}


@dataclass(frozen=True, eq=False)
class Rendered:
    """A scene, the model alone, and both built."""

    plan: Plan
    loop: HandLoop
    library: SceneLibrary
    model: SceneLibrary

    def force(self, position_m: Samples) -> Samples:
        """The model alone's force on a motion from a fresh state, N."""
        force_n, _ = self.model.new_state().run(position_m, np.zeros_like(position_m))
        return force_n.astype(np.float64)


def run_closed_loop(scene: Rendered, stiff: Rendered) -> Iterator[Outcome]:
    """Every case with every hand and delay. stiff: the object ten times stiffer."""
    steps = len(HAND_MODELS) * len(MORE_DELAY)
    for number, hand in enumerate(HAND_MODELS):
        listed = [(scene, case) for case in cases(scene.plan, scene.force, hand)]
        hold = hold_case("stiff", Workspace.of(stiff.plan), stiff.force, hand, stiffer=True)
        for later, more_delay in enumerate(MORE_DELAY):
            at_step(f"closed loop, {hand.name} hand", number * len(MORE_DELAY) + later, steps)
            for rendered, case in [*listed, (stiff, hold)]:
                yield case_outcome(rendered, case, hand, more_delay)
            yield from lossy_outcomes(scene, hand, more_delay)


def lossy_outcomes(scene: Rendered, hand: Hand, more_delay: int) -> Iterator[Outcome]:
    """The cases that lose samples, beside the same without a loss."""
    found: dict[str, Outcome] = {}
    for case, clean in losing_cases(scene.plan, scene.force, hand):
        if clean.name not in found:
            found[clean.name] = case_outcome(scene, clean, hand, more_delay)
        outcome = case_outcome(scene, case, hand, more_delay)
        without = found[clean.name]
        losses = Losses(
            force_step_n=_step_n(scene.plan, outcome, outcome.trace.force_n),
            clean_force_step_n=_step_n(scene.plan, without, without.trace.force_n),
            model_force_step_n=_step_n(scene.plan, outcome, outcome.model_only_n),
            zero_ticks=_zero_ticks(scene.plan, case, outcome),
            clean_zero_ticks=_zero_ticks(scene.plan, clean, without),
        )
        yield replace(outcome, losses=losses)


def _zero_ticks(plan: Plan, case: Case, outcome: Outcome) -> int:
    model_n = outcome.model_only_n
    touching = _touching(plan, outcome) & (model_n > _TOUCH * model_n.max())
    sampled = (case.scenario.dropped == TAKEN) & np.isfinite(case.scenario.error_m)
    sampled[1:] &= sampled[:-1]  # what a silence began with is not known before its second one
    return int(np.sum((outcome.trace.force_n == 0.0) & touching & sampled))


def _step_n(plan: Plan, outcome: Outcome, force_n: Samples) -> float:
    """Greatest change in a tick of contact: a tool that leaves the object is let go at once."""
    touching = _touching(plan, outcome)
    steps_n = np.abs(np.diff(force_n))
    return float(steps_n[touching[1:] & touching[:-1]].max(initial=0.0))


def _touching(plan: Plan, outcome: Outcome) -> NDArray[np.bool_]:
    space = Workspace.of(plan)
    return outcome.trace.position_m > space.base_m + _TOUCH * space.span_m


def stiff_plan(plan: Plan) -> Plan:
    """The same model ten times stiffer, with the coupling that auto picks for it."""
    scene = replace(plan.scene, coupling=replace(plan.scene.coupling, mode="auto"))
    return make_plan(plan.model.stiffened(STIFFER), scene)


def high_passed_rms(speed_mps: Samples, dt_s: float) -> float:
    """RMS of a signal above 15 Hz: its spectrum under a Hann window."""
    n = len(speed_mps)
    window = np.hanning(n)
    power = np.abs(np.fft.rfft((speed_mps - speed_mps.mean()) * window)) ** 2
    above = np.fft.rfftfreq(n, dt_s) > HIGH_PASS_HZ
    return float(np.sqrt(2.0 * power[above].sum() / (n * np.sum(window**2))))


def case_outcome(rendered: Rendered, case: Case, hand: Hand, more_delay: int) -> Outcome:
    """One case with one hand; more_delay: samples beyond the delay of the scene's device."""
    plan, space = rendered.plan, Workspace.of(rendered.plan)
    operator = Operator(hand.name, plan.loop_device.later(more_delay))
    trace = rendered.loop.run(case.scenario, operator, space.free_m)
    model_only_n = rendered.force(trace.position_m)
    min_n, max_n = float(plan.output.min_n), float(plan.output.max_n)
    allowed = (trace.force_n >= min_n) & (trace.force_n <= max_n)
    deepest_m = float(trace.position_m.max())
    give_m = max_n / plan.coupling.coupling.stiffness_npm if plan.at_proxy else 0.0
    inside = deepest_m <= space.base_m + DEEPEST * space.span_m + give_m
    still = case.still or (slice(0, len(trace.velocity_mps)),)
    error_n = np.sqrt(np.mean((trace.felt_n - model_only_n) ** 2))
    return Outcome(
        played=case,
        hand=hand.name,
        delay_samples=operator.device.delay_samples,
        late=more_delay > 0,
        bounded=bool(allowed.all() and inside and trace.not_finite == 0),
        max_depth_m=deepest_m,
        max_force_n=float(trace.force_n.max()),
        hf_speed_mps=max(high_passed_rms(trace.velocity_mps[part], plan.dt_s) for part in still),
        fidelity_percent=float(100.0 * error_n / max(np.abs(model_only_n).max(), 1e-9)),
        energy_out_j=-float(np.sum(trace.felt_n[:-1] * np.diff(trace.position_m))),
        trace=trace,
        model_only_n=model_only_n,
    )
