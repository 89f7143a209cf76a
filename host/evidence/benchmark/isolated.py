"""What is measured of the front and the picks alone on the machine: paced ticks, the closed loop,
instructions on the target's emulated board, or ticks in node for a web page."""

import math
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from springpot import Model, Recording, Scene, SpringpotError, read_model
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.errors import MismatchError, UnsafeError
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.notes import RESYNC
from springpot.codegen.scene import Number, Runtime, Target
from springpot.host.boards.boards import Board, default_board, missing
from springpot.host.boards.emulator import run_batch, steps
from springpot.host.emission.emission import write_emission
from springpot.host.evidence.benchmark.measure import NAME, bench_scene
from springpot.host.native.replay import Replay, TickTimes
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.native.toolchain import missing_tools
from springpot.host.native.trial_build import built, written
from springpot.host.stability.check import stability
from springpot.host.stability.linear import require_stable
from springpot.host.wasm.wasm_module import scene_module
from springpot.host.wasm.wasm_node import missing_node, run_in_node

ISOLATED_PACED_S = 2.0
PACED_TRIES = 3
DISTURBED = 5.0  # times the median: other work had the processor in one of 100 ticks
COUNTED_TICKS = 4000
NODE_TICKS = 10_000  # at once: a browser's clock has steps of 0.1 ms
_TIMED_S = 0.1  # again and again for so long, and the lowest, as in node


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
    if target == "wasm32":
        return missing_tools("wasm32") or missing_node()
    board = default_board(target)
    return missing(board) if board else "a PC has no emulated board: give --target"


def measure_on_target(
    model_file: Path, number: Number, recording: Recording, target: Target
) -> dict[str, Any]:
    """Measure ticks as on the target: `instructions`; of a page `node_tick_ns`, `portable_tick_ns`.

    None if they cannot be measured; `instructions_why` or `node_why` then says why.
    """
    if why := missing_for(target):
        return unmeasured_on(target, why)
    board = default_board(target)
    try:
        if board is not None:
            counted = _counted(model_file, number, recording, board)
            return {"instructions": counted, "instructions_why": f"emulated {board.name}"}
        plan = make_plan(read_model(model_file), bench_scene(number, target), accept_unsafe=True)
        position = np.resize(recording.position_m, NODE_TICKS).astype(plan.dtype)
        node_ns, portable_ns = node_and_portable_ns(plan, position)
    except SpringpotError as error:
        return unmeasured_on(target, str(error))
    return {"node_tick_ns": node_ns, "portable_tick_ns": portable_ns, "node_why": None}


def unmeasured_on(target: Target, why: str) -> dict[str, Any]:
    """Return keys of `measure_on_target` if nothing was measured, with the reason."""
    if target == "wasm32":
        return {"node_tick_ns": None, "portable_tick_ns": None, "node_why": why}
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


def node_and_portable_ns(plan: Plan, position: np.ndarray) -> tuple[float, float]:
    """Return time of a tick, ns, in node and of the same C built here; each the lowest of many.

    The plan is for wasm32: its C has no vector units of this processor. Raises MismatchError where
    the two do not return the same bits.
    """
    velocity = backward_velocity(position, plan.dt_s)
    with written(plan) as folder:
        library = SceneLibrary(folder)
        state = library.new_state()
        times = [math.inf]
        until = time.perf_counter() + _TIMED_S
        while time.perf_counter() < until:
            state.reset()
            begin = time.perf_counter_ns()
            state.run(position, velocity)
            times.append((time.perf_counter_ns() - begin) / len(position))
        force_n, notes = Replay(library).run(position, velocity)
        ticks = run_in_node(scene_module(folder), plan.scene.runtime.prefix, position, velocity)
    same = ticks.force_n.tobytes() == force_n.tobytes() and ticks.notes.tobytes() == notes.tobytes()
    if ticks.selftest or not same:
        raise MismatchError("the wasm module differs from this machine's C: report clang and node")
    return ticks.tick_ns, min(times)
