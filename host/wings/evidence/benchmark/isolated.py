"""Isolated timing: the front and the picks measured after the sweep, on a machine left to them."""

from pathlib import Path
from typing import Any

from springpot import Model, Recording, Runtime, Scene, UnsafeError, read_model
from springpot.basics import Number, Target
from springpot.checks import require_stable, stability
from springpot.emission import backward_velocity, make_plan
from springpot.host.wings.evidence.benchmark.measure import NAME, bench_scene
from springpot.native import Replay, TickTimes, built

ISOLATED_PACED_S = 2.0
PACED_TRIES = 3
DISTURBED = 5.0  # times the median: other work had the processor in one of 100 ticks


def measure_isolated(model_file: Path, number: Number, recording: Recording) -> dict[str, Any]:
    """Paced ticks, and the closed loop of the scene to be emitted."""
    model = read_model(model_file)
    return {**paced_ticks(model, number, recording), **closed_loop(model, number)}


def paced_ticks(model: Model, number: Number, recording: Recording) -> dict[str, float]:
    """Times of ticks at the recordings' rate with cold caches, ns; the calmest of up to three."""
    plan = make_plan(model, bench_scene(number), accept_unsafe=True)
    position = recording.position_m.astype(plan.dtype)
    velocity = backward_velocity(position, plan.dt_s)
    with built(plan) as library:
        tries: list[TickTimes] = []
        while not tries or (len(tries) < PACED_TRIES and tries[-1].p99 > DISTURBED * tries[-1].p50):
            tries.append(
                Replay(library).tick_times(position, velocity, plan.dt_s, ISOLATED_PACED_S)
            )
    ticks = min(tries, key=lambda times: times.p99)
    return {
        "tick_ns_p50": ticks.p50,
        "tick_ns_p99": ticks.p99,
        "tick_ns_p999": ticks.p999,
        "tick_ns_max": ticks.max,
    }


def rendered_scene(name: str, number: Number, target: Target = "host") -> Scene:
    """The scene that `emit --pick` emits: a coupling only where a hand needs one."""
    runtime = Runtime(number=number, target=target)
    return Scene(schema=1, name=name, model="model.spm", runtime=runtime)


def closed_loop(model: Model, number: Number) -> dict[str, Any]:
    """The cases without losses, all hands; `bounded` if every one is. None where `emit` refuses."""
    try:
        plan = make_plan(model, rendered_scene(NAME, number))
        require_stable(plan)
        found = stability(plan)
    except UnsafeError as error:
        return {"bounded": False, "verdict": str(error), "closed_loop": []}
    outcomes = [outcome.as_dict() for outcome in found.whole]
    evaluated = [outcome for outcome in found.whole if not outcome.stiffer]
    return {
        "bounded": found.check.stable and all(outcome.bounded for outcome in found.whole),
        "spectral_radius": found.check.spectral_radius,
        "coupling": found.check.plan.coupling.why,
        "worst_fidelity_percent": max(outcome.fidelity_percent for outcome in evaluated),
        "verdict": found.as_dict()["recommendation"],
        "closed_loop": outcomes,
    }
