"""The time of a point's tick as WebAssembly, beside that of the same portable C on this machine."""

import math
import time
from pathlib import Path
from typing import Any

import numpy as np

from springpot import MismatchError, Recording, SpringpotError, read_model
from springpot.basics import Number
from springpot.emission import Plan, backward_velocity, make_plan
from springpot.host.wings.evidence.benchmark.measure import bench_scene
from springpot.native import (
    Replay,
    SceneLibrary,
    missing_node,
    missing_tools,
    run_in_node,
    scene_module,
    written,
)

NODE_TICKS = 10_000  # at once: a browser's clock has steps of 0.1 ms
_TIMED_S = 0.1  # again and again for so long, and the lowest, as in node


def untimed() -> str:
    """Why ticks cannot be timed in node here; nothing where they can."""
    return missing_tools("wasm32") or missing_node()


def time_in_node(model_file: Path, number: Number, recording: Recording) -> dict[str, Any]:
    """`node_tick_ns` and `portable_tick_ns`, of one run; None where not timed, `node_why` says why.

    Over the recording's first 10 000 samples, repeated where it is shorter.
    """
    unknown = {"node_tick_ns": None, "portable_tick_ns": None}
    if why := untimed():
        return unknown | {"node_why": why}
    plan = make_plan(read_model(model_file), bench_scene(number, "wasm32"), accept_unsafe=True)
    position = np.resize(recording.position_m, NODE_TICKS).astype(plan.dtype)
    try:
        node_ns, portable_ns = node_and_portable_ns(plan, position)
    except SpringpotError as error:
        return unknown | {"node_why": str(error)}
    return {"node_tick_ns": node_ns, "portable_tick_ns": portable_ns, "node_why": None}


def node_and_portable_ns(plan: Plan, position: np.ndarray) -> tuple[float, float]:
    """Time of a tick, ns, in node and of the same C built here; each the lowest of many.

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
