"""What the closed loop did: bounds, vibration, fidelity and energy of each case and hand."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace

import numpy as np

from springpot.codegen.arrays import Samples, rms
from springpot.codegen.coupling.linear_loop import CHECKED_HANDS, Hand
from springpot.codegen.make_plan import make_plan
from springpot.codegen.messages import log_progress, short_repr
from springpot.codegen.plan import Plan
from springpot.host.native.scene_library import SceneLibrary, build_and_load, without_coupling
from springpot.host.simulation.cases import (
    SHORT_HOLD_S,
    cases,
    hold_case,
    sample_loss_cases,
    stiff_case,
)
from springpot.host.simulation.hand_loop import HandLoop, Operator, Trace
from springpot.host.simulation.scenarios import Case, Workspace
from springpot.host.stability.losses import (
    SampleLossEffects,
    compare_with_lossless,
    ended,
    latched_s,
    longest_silence_ticks,
)

HIGH_PASS_HZ, LOW_HZ = 15.0, 0.5
MIN_LONG_HOLD_S = 6.0  # a hold that long shows vibrations from LOW_HZ on, in each third of it
MIN_GROWTH_SPEED_MPS = 2.5e-4  # growth of less is that of noise and of steps of the encoder
MAX_GROWTH_RATIO = 2.0


@dataclass(frozen=True)
class Vibration:
    """Vibration in the worst of some holds; None if none is long enough.

    lf_speed_mps: RMS of the speed from 0.5 to 15 Hz in a hold's last third. growth_ratio: of the
    RMS from 0.5 Hz on, last third over first, or its square over the second third if that is less:
    what grows evenly has the same there, and what has come to its size has 1.
    """

    lf_speed_mps: float | None = None
    growth_ratio: float | None = None

    @property
    def grows(self) -> bool:
        """True if a hold vibrates more and more."""
        return self.growth_ratio is not None and self.growth_ratio > MAX_GROWTH_RATIO


def measure_vibration(holds: Sequence[Samples], dt_s: float) -> Vibration:
    """holds: the tool's speed in each, (n,), m/s."""
    long_holds = [
        _hold(speed_mps, dt_s) for speed_mps in holds if len(speed_mps) * dt_s >= MIN_LONG_HOLD_S
    ]
    if not long_holds:
        return Vibration()
    return Vibration(max(low for low, _ in long_holds), max(growth for _, growth in long_holds))


def _hold(speed_mps: Samples, dt_s: float) -> tuple[float, float]:
    """Return the low-frequency speed of a hold, m/s, and by how much vibration grows in it."""
    n = len(speed_mps) // 3
    thirds = [speed_mps[i * n : (i + 1) * n] for i in range(3)]
    first, second, last = (
        max(band_rms(part, dt_s, LOW_HZ), MIN_GROWTH_SPEED_MPS) for part in thirds
    )
    low_mps = band_rms(thirds[-1], dt_s, LOW_HZ, HIGH_PASS_HZ)
    return low_mps, min(last / first, (last / second) ** 2)


def band_rms(signal: Samples, dt_s: float, above_hz: float, up_to_hz: float = np.inf) -> float:
    """RMS of a signal in a band: its spectrum under a Hann window."""
    n = len(signal)
    window = np.hanning(n)
    power = np.abs(np.fft.rfft((signal - signal.mean()) * window)) ** 2
    at_hz = np.fft.rfftfreq(n, dt_s)
    within = (at_hz > above_hz) & (at_hz <= up_to_hz)
    return float(np.sqrt(2.0 * power[within].sum() / (n * np.sum(window**2))))


DEEPEST = 1.3  # of the trained depth, beside what a proxy's spring gives
FARTHEST, _STEP = 3.0, 0.1  # of it too, for an object that bears a push no sooner
STIFFNESS_FACTOR = 10.0


@dataclass(frozen=True, eq=False)
class Outcome:
    """One case with one hand. model_only_n: the model alone under the same motion, (n,), N.

    late: with one more sample of delay than the device's own. latched_s: when the scene ended it;
    ended: and its force stayed at zero from then on.
    """

    case: Case
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
    losses: SampleLossEffects | None = None
    late: bool = False
    vibration: Vibration = field(default_factory=Vibration)
    latched_s: float | None = None
    ended: bool = False
    __repr__ = short_repr

    @property
    def case_name(self) -> str:
        """Name of the case."""
        return self.case.name

    @property
    def hold_speed_mps(self) -> float:
        """RMS speed of the tool where it is held, from 0.5 Hz on."""
        return math.hypot(self.hf_speed_mps, self.vibration.lf_speed_mps or 0.0)

    def as_dict(self) -> dict[str, object]:
        """Return keys of a case in `stability --json`."""
        names = (
            "hand", "bounded", "max_depth_m", "delay_samples", "max_force_n",
            "hf_speed_mps", "fidelity_percent", "energy_out_j", "latched_s", "ended",
        )  # fmt: skip
        lost = {} if self.losses is None else asdict(self.losses)
        measured = {name: getattr(self, name) for name in names}
        return {
            "case": self.case_name,
            **measured,
            **asdict(self.vibration),
            "grows": self.vibration.grows,
            **lost,
        }


@dataclass(frozen=True, eq=False)
class BuiltScene:
    """A scene, the model alone, and both built."""

    plan: Plan
    loop: HandLoop
    library: SceneLibrary
    model: SceneLibrary
    __repr__ = short_repr

    def force(self, position_m: Samples) -> Samples:
        """Return the model alone's force on a motion from a fresh state, N."""
        return self._along(self.model, position_m)

    def felt(self, position_m: Samples) -> Samples:
        """Return the scene's force on a motion from a fresh state, N: what a hand has to hold."""
        return self._along(self.library, position_m)

    def _along(self, library: SceneLibrary, position_m: Samples) -> Samples:
        velocity_mps = np.gradient(position_m, self.plan.dt_s)
        return library.new_state().run(position_m, velocity_mps)[0].astype(np.float64)


def rendered(plan: Plan, library: SceneLibrary, loop: type[HandLoop] = HandLoop) -> BuiltScene:
    """Return a scene that is built, and the model alone, built here where it is another."""
    model = without_coupling(plan)
    return BuiltScene(
        plan, loop(library), library, library if model is plan else build_and_load(model)
    )


def hold_outcomes(scene: BuiltScene) -> list[Outcome]:
    """Return short holds in every hand with the device's own delay: what `emit` decides by."""
    space = Workspace.of(scene.plan)
    return [
        case_outcome(scene, hold_case(space, scene.felt, hand, SHORT_HOLD_S), hand, more_delay)
        for hand, more_delay in CHECKED_HANDS
        if not more_delay
    ]


def closed_loop_outcomes(scene: BuiltScene, stiff: BuiltScene) -> Iterator[Outcome]:
    """Yield every case with every hand and delay. stiff: the object ten times stiffer."""
    for number, (hand, more_delay) in enumerate(CHECKED_HANDS):
        log_progress(f"closed loop, {hand.name} hand", number, len(CHECKED_HANDS))
        for case in cases(scene.plan, scene.felt, hand):
            yield case_outcome(scene, case, hand, more_delay)
        yield case_outcome(stiff, stiff_case(stiff.plan, stiff.felt, hand), hand, more_delay)
        yield from sample_loss_outcomes(scene, hand, more_delay)


def sample_loss_outcomes(scene: BuiltScene, hand: Hand, more_delay: int) -> Iterator[Outcome]:
    """Yield the cases that lose samples, beside the same without a loss."""
    clean_outcomes: dict[str, Outcome] = {}
    for case, clean in sample_loss_cases(scene.plan, scene.felt, hand):
        if clean.name not in clean_outcomes:
            clean_outcomes[clean.name] = case_outcome(scene, clean, hand, more_delay)
        # A stroke may be deep without any loss: then the losses are not to blame.
        clean_m = clean_outcomes[clean.name].max_depth_m
        outcome = case_outcome(scene, case, hand, more_delay, clean_m)
        without = clean_outcomes[clean.name].trace
        losses = compare_with_lossless(
            scene.plan, scene.library, case.scenario, outcome.trace, without
        )
        yield replace(outcome, losses=losses)


def stiff_plan(plan: Plan) -> Plan:
    """The same model ten times stiffer, with the coupling that auto picks for it; of one axis."""
    coupling = replace(plan.scene.coupling, mode="auto")
    scene = replace(plan.scene, coupling=coupling)
    return make_plan(plan.model.stiffened(STIFFNESS_FACTOR), scene)


def _deepest_m(rendered: BuiltScene, space: Workspace, case: Case) -> float:
    """Return the maximum plausible depth, m; of a push, as deep as the object itself bears it.

    An object that relaxes, or is not stiffer when deep, bears a push only far below the trained
    depth, without any vibration. The depth rises as the push does: an object that begins at a depth
    has rested there, and bears less than it does so soon after the press.
    """
    deepest_m = space.at(DEEPEST)
    push_n = float(case.scenario.push_n.max())
    if push_n > 0.0:
        rise = case.scenario.push_n / push_n
        for share in np.arange(DEEPEST, FARTHEST, _STEP):
            depth_m = space.free_m + rise * (space.at(float(share)) - space.free_m)
            if rendered.force(depth_m)[-1] >= push_n:
                return space.at(float(share) + _STEP)
    return deepest_m


def case_outcome(
    rendered: BuiltScene, case: Case, hand: Hand, more_delay: int, clean_m: float = 0.0
) -> Outcome:
    """One case with one hand; more_delay: samples beyond the delay of the scene's device.

    clean_m: how deep the same case goes without what it loses, m.
    """
    plan, space = rendered.plan, Workspace.of(rendered.plan)
    operator = Operator(hand.name, plan.loop_device.with_delay(more_delay))
    trace = rendered.loop.run(case.scenario, operator, space.free_m)
    model_only_n = rendered.force(trace.position_m)
    min_n, max_n = float(plan.output.min_n), float(plan.output.max_n)
    allowed = (trace.force_n >= min_n) & (trace.force_n <= max_n)
    deepest_m = float(trace.position_m.max())
    give_m = max_n / plan.coupling.coupling.stiffness_npm if plan.at_proxy else 0.0
    # Without a sample no force may grow: the tool goes on meanwhile, as fast as it is.
    silent_s = longest_silence_ticks(case.scenario) * plan.dt_s
    missed_m = silent_s * float(np.abs(trace.velocity_mps).max())
    may_m = max(_deepest_m(rendered, space, case), clean_m) + give_m + missed_m
    inside = case.must_be_quiet or case.faster_than_trained or deepest_m <= may_m
    still = [trace.velocity_mps[part] for part in case.hold_ticks or (slice(None),)]
    error_n = rms(trace.felt_n - model_only_n)
    return Outcome(
        case=case,
        hand=hand.name,
        delay_samples=operator.device.delay_samples,
        late=more_delay > 0,
        bounded=bool(allowed.all() and inside and trace.not_finite == 0),
        max_depth_m=deepest_m,
        max_force_n=float(trace.force_n.max()),
        hf_speed_mps=max(band_rms(speed_mps, plan.dt_s, HIGH_PASS_HZ) for speed_mps in still),
        fidelity_percent=float(100.0 * error_n / max(np.abs(model_only_n).max(), 1e-9)),
        energy_out_j=-float(np.sum(trace.felt_n[:-1] * np.diff(trace.position_m))),
        trace=trace,
        model_only_n=model_only_n,
        vibration=measure_vibration(still if case.must_be_quiet else (), plan.dt_s),
        latched_s=latched_s(plan, trace),
        ended=ended(plan, trace),
    )
