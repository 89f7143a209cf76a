"""A scene as wasm32 in node: the same ticks as on this machine, their time, and its self-test.

And the size of its module, which emission asks for.
"""

import json
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from importlib.resources import as_file, files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from springpot import SpringpotError
from springpot.codegen.arrays import Reals
from springpot.codegen.errors import MismatchError, UsageError
from springpot.codegen.plan.plan import Plan
from springpot.host.wasm.wasm_module import scene_functions, scene_module, wasm_module

_LONGEST_S = 600.0


@dataclass(frozen=True, eq=False)
class WasmTicks:
    """Of each tick force_n and notes, shapes (n,); what the self-test returned; ns a tick."""

    force_n: Reals
    notes: NDArray[np.int32]
    selftest: int
    tick_ns: float


def missing_node() -> str:
    """What to install where node is not found; nothing where it is."""
    return "" if shutil.which("node") else "no node on PATH: `apt-get install nodejs`"


def run_in_node(module: bytes, prefix: str, position: Reals, velocity: Reals) -> WasmTicks:
    """Self-test, then ticks from a fresh state, in the number type of `position`.

    tick_ns: of all ticks at once, the lowest in 0.1 s. Raises UsageError without node.
    """
    node = shutil.which("node")
    if node is None:
        raise UsageError(missing_node())
    script = files("springpot.host.wasm") / "templates" / "wasm_ticks.mjs"
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch, as_file(script) as program:
        place = Path(scratch)
        (place / "module.wasm").write_bytes(module)
        given = np.concatenate([position, velocity.astype(position.dtype)])
        (place / "calls.bin").write_bytes(given.tobytes())
        command = [node, str(program), "module.wasm", prefix, position.dtype.name, "calls.bin",
                   "returns.bin"]  # fmt: skip
        try:
            result = subprocess.run(
                command, cwd=place, capture_output=True, text=True, check=False, timeout=_LONGEST_S
            )
        except subprocess.TimeoutExpired:
            raise SpringpotError(f"node: no end after {_LONGEST_S:g} s") from None
        if result.returncode != 0:
            said = result.stderr.strip()
            first = next((line for line in said.splitlines() if "Error" in line), said[-300:])
            raise SpringpotError(f"node could not run the module: {first}")
        returned = (place / "returns.bin").read_bytes()
    told = json.loads(result.stdout)
    force_bytes = len(position) * position.itemsize
    return WasmTicks(
        force_n=np.frombuffer(returned[:force_bytes], dtype=position.dtype),
        notes=np.frombuffer(returned[force_bytes:], dtype=np.int32),
        selftest=int(told["selftest"]),
        tick_ns=float(told["tick_ns"]),
    )


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
