"""The module of a page in node: its self-test, and the forces of this machine's C, bit for bit."""

import hashlib
from pathlib import Path
from typing import Any

from springpot import MismatchError
from springpot.emission import backward_velocity, golden_positions, read_emission
from springpot.host.wings.page.scene_entry import module_of
from springpot.native import Replay, SceneLibrary, missing_node, run_in_node


def check_module(folder: Path, entry: dict[str, Any], accept_edited: bool) -> dict[str, Any]:
    """Return `selftest`, 0, and `force_hash` of the golden motion; None for both without node.

    Raises MismatchError where the page's C gives other forces than that of this machine.
    """
    if missing_node():
        return {"selftest": None, "force_hash": None}
    plan = read_emission(folder, accept_edited).plan
    position = golden_positions(plan)
    velocity = backward_velocity(position, plan.dt_s)
    ticks = run_in_node(module_of(entry["wasm"]), entry["prefix"], position, velocity)
    here, _ = Replay(SceneLibrary(folder)).run(position, velocity)
    if ticks.selftest or ticks.force_n.tobytes() != here.tobytes():
        raise MismatchError(
            f"{folder}: the page's C gives other forces in node than this machine's (self-test "
            f"{ticks.selftest}): report clang, or the compiler of springpot[cc], and node"
        )
    return {"selftest": 0, "force_hash": hashlib.sha256(here.tobytes()).hexdigest()}
