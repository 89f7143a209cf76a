"""What emission asks of a scene for wasm32: the size of its module, and its self-test in node."""

from pathlib import Path

import numpy as np

from springpot import MismatchError
from springpot.emission import Plan
from springpot.host.wings.wasm.wasm_module import scene_functions, scene_module, wasm_module
from springpot.host.wings.wasm.wasm_node import missing_node, run_in_node


def module_bytes(folder: Path, source: str) -> int:
    """Size of the module of folder/source without its self-test."""
    functions = [name for name in scene_functions(folder) if not name.endswith("_selftest")]
    return len(wasm_module([folder / source], [folder], functions))


def selftest_in_node(plan: Plan, folder: Path) -> list[str]:
    """Run the self-test as wasm; without node, return the notice that it was not run."""
    if why := missing_node():
        return [f"the self-test has not run as wasm32: {why}"]
    none = np.zeros(1, dtype=plan.dtype)
    if differs := run_in_node(scene_module(folder), plan.scene.runtime.prefix, none, none).selftest:
        raise MismatchError(
            f"{plan.scene.name}: the wasm module differs from its numpy reference at golden tick "
            f"{differs - 1}: nothing was emitted; report clang and node"
        )
    return []
