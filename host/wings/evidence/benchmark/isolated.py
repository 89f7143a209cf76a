"""What is measured of the front and the picks alone on the machine: paced ticks, the closed loop,
instructions on the target's emulated board."""

import tempfile
from pathlib import Path
from typing import Any

from springpot import (
    Model,
    Recording,
    Runtime,
    Scene,
    SpringpotError,
    UnsafeError,
    read_model,
)
from springpot.basics import Number, Target
from springpot.checks import require_stable, stability
from springpot.emission import RESYNC, backward_velocity, make_plan, write_emission
from springpot.host.wings.evidence.benchmark.measure import NAME, bench_scene
from springpot.native import (
    Board,
    Replay,
    TickTimes,
    built,
    default_board,
    missing,
    run_batch,
    steps,
)

ISOLATED_PACED_S = 2.0
PACED_TRIES = 3
DISTURBED = 5.0  # times the median: other work had the processor in one of 100 ticks
COUNTED_TICKS = 4000


def measure_isolated(model_file: Path, number: Number, recording: Recording) -> dict[str, Any]:
    """Return paced ticks, and the closed loop of the scene to be emitted."""
    model = read_model(model_file)
    return {**paced_ticks(model, number, recording), **closed_loop(model, number)}


def paced_ticks(model: Model, number: Number, recording: Recording) -> dict[str, float]:
    """Time ticks at the recordings' rate with cold caches, ns; the calmest of up to three runs."""
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
    """Return the scene that `emit --pick` emits: a coupling only if a hand needs one."""
    runtime = Runtime(number=number, target=target)
    return Scene(schema=1, name=name, model="model.spm", runtime=runtime)


def closed_loop(model: Model, number: Number) -> dict[str, Any]:
    """Run the cases without losses, all hands; `bounded` if every one is, and if `emit` accepts."""
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


def missing_for(target: Target) -> str:
    """Return what is missing to run ticks as on the target; nothing if they can be run."""
    board = default_board(target)
    return missing(board) if board else "a PC has no emulated board: give --target"


def measure_on_target(
    model_file: Path, number: Number, recording: Recording, target: Target
) -> dict[str, Any]:
    """Count `instructions` on the target's board; None, with `instructions_why`, if it cannot."""
    if why := missing_for(target):
        return unmeasured_on(why)
    board = default_board(target)
    assert board is not None, "nothing of it is missing"
    try:
        counted = _counted(model_file, number, recording, board)
    except SpringpotError as error:
        return unmeasured_on(str(error))
    return {"instructions": counted, "instructions_why": f"emulated {board.name}"}


def unmeasured_on(why: str) -> dict[str, Any]:
    """Return keys of `measure_on_target` if nothing was measured, with the reason."""
    return {"instructions": None, "instructions_why": why}


def _counted(model_file: Path, number: Number, recording: Recording, board: Board) -> int:
    """Return the most instructions of a tick over the recording's begin; restarts apart."""
    scene = bench_scene(number, board.target)
    plan = make_plan(read_model(model_file), scene, accept_unsafe=True)
    position = recording.position_m[:COUNTED_TICKS].astype(plan.dtype)
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        folder = Path(scratch) / "c"
        write_emission(plan, scene, model_file, folder)
        calls = steps(position, backward_velocity(position, plan.dt_s))
        batch = run_batch(folder, board, calls)
    # A restart fills its filters once, and is no tick of a loop.
    return int(batch.instructions[(batch.notes & RESYNC) == 0].max())
