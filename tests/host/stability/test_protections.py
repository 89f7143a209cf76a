"""Each protection against its own absence: what it is for, and that it does nothing else.

| protection | without it |
| --- | --- |
| slew | a position that is wrong by less than a jump changes the force at once |
| jump | a sample that is far off is rendered |
| resync | a jump that stays ends the session |
| watchdog | the last force stays when no more samples come |
| onset | a force that does not begin at 0 is felt as a step at the surface |
| fade (outside = "zero") | the force ends at once beyond the trained depth |

Without losses, a tool that rests, with any noise of its encoder, or vibrates, at any rate, gets no
rougher force and no more energy with a protection than without: an account of energy once cut the
force of a resting hand.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from support.c import golden_forces
from support.small import passive_model, scene

from springpot.codegen.arrays import Samples
from springpot.codegen.coupling.linear_loop import HAND_MODELS
from springpot.codegen.make_plan import make_plan
from springpot.codegen.notes import HELD, LATCHED
from springpot.codegen.plan import Plan
from springpot.codegen.scene import Device, Guard, Runtime
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import build_and_load
from springpot.host.simulation.cases import hold_case
from springpot.host.simulation.hand_loop import HandLoop, Operator
from springpot.host.simulation.scenarios import Workspace
from springpot.host.stability.closed_loop import BuiltScene

NEVER = 1e9
WITHOUT: dict[str, Callable[[Plan], Plan]] = {
    "slew": lambda plan: replace(plan, output=replace(plan.output, slew_n=plan.dtype(NEVER))),
    "jump": lambda plan: replace(plan, guard=replace(plan.guard, max_step_m=plan.dtype(NEVER))),
    "watchdog": lambda plan: replace(
        plan, silence=replace(plan.silence, watchdog_s=plan.dtype(NEVER))
    ),
    "resync": lambda plan: replace(plan, guard=replace(plan.guard, resync_ticks=2**31)),
    "onset": lambda plan: replace(plan, onset_per_m=plan.dtype(NEVER)),
    "fade": lambda plan: replace(plan, fade_per_m=None if plan.fade_per_m is None else
                                 plan.dtype(NEVER)),
}  # fmt: skip
OUTSIDE_ZERO = replace(scene(), guard=Guard(outside="zero"))
Forces = dict[str, Callable[[Samples], tuple[Samples, Samples]]]


def rendered(plan: Plan, names: tuple[str, ...]) -> Forces:
    """Forces, N, and notes along positions: of the plan (""), and without each protection."""

    def along(replay: Replay) -> Callable[[Samples], tuple[Samples, Samples]]:
        def forces(position_m: Samples) -> tuple[Samples, Samples]:
            position = position_m.astype(plan.dtype)
            force, notes = replay.run(position, np.zeros_like(position))
            return force.astype(np.float64), notes

        return forces

    plans = {"": plan} | {name: WITHOUT[name](plan) for name in names}
    return {name: along(Replay(build_and_load(one))) for name, one in plans.items()}


def rising(depth_m: float, n: int, dt_s: float) -> Samples:
    """Half a second down to a depth, then there, (n,), m."""
    return depth_m * (1.0 - np.cos(np.pi * np.minimum(np.arange(n) * dt_s / 0.5, 1.0))) / 2.0


def roughness(position_m: Samples, force_n: Samples) -> tuple[float, float, float]:
    """Ripple, N; largest step, N; energy given to the hand, J; once it has settled."""
    x, f = position_m[len(position_m) // 4 :], force_n[len(force_n) // 4 :]
    return float(f.std()), float(np.abs(np.diff(f)).max()), float(-np.sum(f[:-1] * np.diff(x)))


@pytest.mark.parametrize("rate_hz", [100.0, 1000.0, 3000.0, 8000.0])
def test_no_protection_roughens_a_rest_or_a_vibration(rate_hz: float) -> None:
    """Noise of up to 5 steps of an encoder of 10 or 50 um, whatever the scene states."""
    model = golden_forces.model("hammerstein")
    plan = make_plan(model, replace(OUTSIDE_ZERO, runtime=Runtime(rate_hz=rate_hz)))
    forces = rendered(plan, tuple(WITHOUT))
    rng, depth_m, n = np.random.default_rng(0), model.trained.max_m, round(8 * rate_hz)
    for share in (0.03, 0.5, 0.97):
        at_m = rising(share * depth_m, n, plan.dt_s)
        motions = [
            at_m + step_m * rng.integers(-steps, steps, n, endpoint=True)
            for step_m in (10e-6, 50e-6) for steps in (0, 1, 5)
        ]  # fmt: skip
        for frequency_hz in rng.uniform(1.0, rate_hz / 2.0, 6):
            swing = np.sin(2.0 * np.pi * frequency_hz * np.arange(n) * plan.dt_s)
            motions += [at_m + amplitude_m * swing for amplitude_m in (20e-6, 100e-6)]
        for position_m in motions:
            force_n, notes = forces[""](position_m)
            assert not (notes[n // 4 :] & (HELD | LATCHED)).any()
            for name in WITHOUT:
                other_n, _ = forces[name](position_m)
                for has, may in zip(
                    roughness(position_m, force_n), roughness(position_m, other_n), strict=True
                ):
                    assert has <= may + 0.02 * abs(may) + 1e-9, name


@pytest.mark.few(1)
@pytest.mark.parametrize(("rate_hz", "stiffer"), [(100.0, 0.5), (8000.0, 8.0)])
def test_no_protection_moves_what_any_hand_holds(rate_hz: float, stiffer: float) -> None:
    """From a stiff pinch to one fingertip, knocked, with noise: the same to the last bit."""
    device = Device(mass_kg=0.1, viscous_nspm=3.0, position_noise_um=30.0)
    chosen = replace(scene(), runtime=Runtime(rate_hz=rate_hz), device=device)
    plan = make_plan(golden_forces.model("hammerstein").stiffened(stiffer), chosen)
    names = ("slew", "jump", "resync", "watchdog")
    plans = [plan, *(WITHOUT[name](plan) for name in names)]
    scenes = [BuiltScene(one, HandLoop(library), library, library)
              for one in plans for library in [build_and_load(one)]]  # fmt: skip
    for hand in HAND_MODELS:
        case, operator = (
            hold_case(Workspace.of(plan), scenes[0].felt, hand),
            Operator(hand.name, plan.loop_device),
        )
        traces = [one.loop.run(case.scenario, operator) for one in scenes]
        for name, other in zip(names, traces[1:], strict=True):
            assert np.array_equal(other.force_n, traces[0].force_n), (hand.name, name)


def most_in_a_tick(forces: Forces, name: str, position_m: Samples) -> float:
    return float(np.abs(np.diff(forces[name](position_m)[0])).max())


@pytest.mark.parametrize(("name", "wrong_m"), [("slew", 0.9e-3), ("jump", 5e-3)])
def test_a_wrong_sample_is_felt_without_it(name: str, wrong_m: float) -> None:
    """A spring ten times stiffer than the object of the recordings shows what a sample can do."""
    plan = make_plan(passive_model().stiffened(16.0), scene(), accept_unsafe=True)
    forces = rendered(plan, (name,))
    position_m = rising(0.3 * plan.model.trained.max_m, 1000, plan.dt_s)
    position_m[900] += wrong_m
    slew_n = float(plan.output.slew_n)
    # The force falls at once, but never grows faster than the slew.
    growth = {one: float(np.diff(forces[one](position_m)[0]).max()) for one in ("", name)}
    assert growth[""] <= 1.001 * slew_n
    assert growth[name] > (1.5 * slew_n if name == "slew" else 2.0 * growth[""])


def test_the_last_force_stays_without_a_watchdog() -> None:
    plan = make_plan(passive_model(), scene())
    forces = rendered(plan, ("watchdog",))
    position_m = rising(0.6 * plan.model.trained.max_m, 1000, plan.dt_s)
    position_m[700:] = np.nan
    assert forces[""](position_m)[0][-1] == 0.0 and forces["watchdog"](position_m)[0][-1] > 1.0


def test_the_path_between_samples_bends_by_the_velocity_as_late_as_it_is() -> None:
    """Behind a coupling, at the worst phase of strokes of 8 Hz, 5 ms lost: .05 N of 11.

    Taken for that of the last sample, and not for one of 4 ms before, it overshoots: .32 N.
    """
    plan = make_plan(golden_forces.model("hammerstein"), scene(mode="tool"))
    assert plan.velocity is not None
    prompt = replace(plan, velocity=replace(plan.velocity, lag=plan.dtype(0)))
    whole_m = 4e-3 * (1.0 - np.cos(2.0 * np.pi * 8.0 * np.arange(600) * 1e-3))
    kicks_n = []
    for forces in (rendered(each, ())[""] for each in (plan, prompt)):
        clean_n = forces(whole_m)[0]
        losses = [(np.arange(600) - begin) // 5 == 0 for begin in range(130, 500, 7)]
        felt_n = [forces(np.where(lost, np.nan, whole_m))[0] for lost in losses]
        kicks_n.append(max(
            (force_n - clean_n)[np.flatnonzero(lost)[-1] + 1 :].max()
            for force_n, lost in zip(felt_n, losses, strict=True)
        ))  # fmt: skip
    assert kicks_n[0] < 0.1 and kicks_n[1] > 0.25


def test_a_force_that_does_not_begin_at_zero_is_a_step_without_an_onset() -> None:
    """As of recordings with a dead load, or a surface that was found too deep."""
    model = passive_model()
    assert model.hammerstein is not None
    loaded = replace(model, hammerstein=replace(model.hammerstein, bias_n=1.0))
    forces = rendered(make_plan(loaded, scene()), ("onset",))
    position_m = np.linspace(-1e-4, 1.5e-4, 2000)
    assert most_in_a_tick(forces, "onset", position_m) > 0.9
    assert most_in_a_tick(forces, "", position_m) < 0.01


def test_the_force_ends_at_once_without_a_fade() -> None:
    plan = make_plan(passive_model(), OUTSIDE_ZERO)
    forces = rendered(plan, ("fade",))
    position_m = rising(1.2 * plan.model.trained.max_m, 2000, plan.dt_s)
    assert most_in_a_tick(forces, "fade", position_m) > 5.0 * most_in_a_tick(forces, "", position_m)
