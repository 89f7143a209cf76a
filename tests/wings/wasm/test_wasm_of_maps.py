"""Maps as WebAssembly, held and slid over: the bits of this machine's C and of the reference."""

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from codegen.stages.test_lateral import SLIDING, slid
from codegen.stages.test_placed import called, placed
from support.paths import TESTS
from support.small import press, scene, wandering

from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.lateral import run_lateral
from springpot.codegen.reference.run import run_reference
from springpot.codegen.scene import Scene
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.native.toolchain import missing_tools
from springpot.host.native.trial_build import written
from springpot.host.wings.wasm.wasm_module import scene_module
from springpot.host.wings.wasm.wasm_node import missing_node

LACKING = missing_tools("wasm32") or missing_node()
pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(LACKING), reason=LACKING or "-")]
SCRIPT = TESTS / "support" / "c" / "map_ticks.mjs"


def motion(seed: int) -> np.ndarray:
    """x, y and depth, (n, 3), m: presses over the map and beyond it, and what devices do wrong."""
    rng = np.random.default_rng(seed)
    depth_m = np.concatenate([1.2 * press(6.0), wandering(seed)[:300], press(2.0), np.zeros(5)])
    turn = rng.uniform(6.0, 18.0) * np.arange(len(depth_m)) / len(depth_m)
    found = np.column_stack([0.01 + 0.015 * np.sin(turn), 0.012 * np.cos(turn), depth_m])
    found[250:, 0] += 0.3
    found[100:103, 1] = np.nan
    found[150] = 5e3
    return np.concatenate([found, np.full((40, 3), np.nan), found[-3:]])


def in_node(
    folder: Path, call: str, rows: np.ndarray, scratch: Path
) -> tuple[np.ndarray, np.ndarray]:
    """Forces and notes of rows of x, y, depth and velocity, (n, 4); the self-test passes."""
    node = shutil.which("node")
    (scratch / "module.wasm").write_bytes(scene_module(folder))
    (scratch / "calls.bin").write_bytes(rows.tobytes())
    command = [node, str(SCRIPT), "module.wasm", rows.dtype.name, call, "calls.bin", "returns.bin"]
    told = subprocess.run(command, cwd=scratch, capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "0"
    found = (scratch / "returns.bin").read_bytes()
    forces, notes = found[: -4 * len(rows)], found[-4 * len(rows) :]
    return np.frombuffer(forces, rows.dtype), np.frombuffer(notes, np.int32)


def planned(like: Scene, number: str, seed: int) -> Plan:
    """A random map of one to three materials; for a host and for a page the C is one."""
    runtime = scene(number=number).runtime
    target = "wasm32" if seed % 2 else "host"
    its = replace(like, runtime=replace(runtime, target=target))  # type: ignore[arg-type]
    return make_plan(placed("plain", 1 + seed % 3, seed), its, accept_unsafe=True)


CASES = [(0, "float32"), (1, "float64"), (2, "float32")]


@pytest.mark.parametrize(("seed", "number"), CASES)
def test_held_places_have_the_same_bits(tmp_path: Path, number: str, seed: int) -> None:
    plan = planned(scene(mode=("off", "proxy", "tool")[seed]), number, seed)
    rows = motion(seed).astype(plan.dtype)
    steps = 40 * (np.arange(len(rows)) // 40)  # a place is chosen every 40 ticks
    places, depth_m = np.nan_to_num(rows[steps, :2]), rows[:, 2].copy()
    velocity = backward_velocity(depth_m, plan.dt_s)
    asked = [(int(k), tuple(places[k].tolist())) for k in np.unique(steps)]
    with written(plan) as folder:
        here_n, here = called(SceneLibrary(folder), depth_m, velocity, asked)
        calls = np.column_stack([places, depth_m, velocity]).astype(plan.dtype)
        node_n, notes = in_node(folder, "step", calls, tmp_path)
    twin = run_reference(plan, depth_m, velocity, places=asked)
    assert node_n.tobytes() == here_n.tobytes() == twin.force_n.tobytes()
    assert np.array_equal(notes, here) and np.array_equal(notes, twin.notes)
    assert np.ptp(node_n) > 0.1


@pytest.mark.parametrize(("seed", "number"), CASES)
def test_slides_have_the_same_bits(tmp_path: Path, number: str, seed: int) -> None:
    plan = planned(SLIDING, number, seed)
    rows = motion(seed).astype(plan.dtype)
    with written(plan) as folder:
        here_n, here = slid(SceneLibrary(folder), rows)
        calls = np.column_stack([rows, np.zeros(len(rows))]).astype(plan.dtype)
        node_n, notes = in_node(folder, "step3", calls, tmp_path)
    twin = run_lateral(plan, rows)
    assert node_n.tobytes() == here_n.tobytes() == twin.force_n.tobytes()
    assert np.array_equal(notes, here) and np.array_equal(notes, twin.notes)
    assert np.ptp(node_n.reshape(-1, 3), axis=0).min() > 0.01
