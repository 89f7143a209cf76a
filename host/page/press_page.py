"""`springpot page`: one self-contained file in which people press what was emitted, and its check
in node: self-test, and the forces of this machine's C, bit for bit."""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from markupsafe import Markup

from springpot.codegen.atomic_write import write_file
from springpot.codegen.coupling.linear_loop import DESIGN_HAND
from springpot.codegen.emit.golden import backward_velocity, golden_positions
from springpot.codegen.errors import MismatchError
from springpot.codegen.progress import counted
from springpot.host.emission.emission import read_emission
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.page.hands import MASS_KG, STIFFNESS_NPM, added_delays
from springpot.host.page.scene_entry import module_of, scene_entry
from springpot.host.pages.page import page_text, plain
from springpot.host.wasm.wasm_node import missing_node, run_in_node

# In the order in which they use each other.
_SCRIPTS = ("scene.js", "intent.js", "trace.js", "canvas.js", "object_view.js", "plots.js",
            "sources.js", "readout.js", "controls.js", "main.js")  # fmt: skip
_MAP_SCRIPTS = ("map/place.js", "map/object_map.js", "map/stiffness.js", "map/view.js",
                "map/search.js", "map/trials.js", "map/controls.js")  # fmt: skip


def write_press_page(
    folders: Sequence[Path], out: Path, accept_edited: bool = False, about: str = ""
) -> list[dict[str, Any]]:
    """Write the page of one emitted folder or several; returns their entries.

    about: a sentence on the objects, for who opens the page.

    Raises DataError for no emission, UsageError without the compiler for WebAssembly.
    """
    entries = [scene_entry(folder, accept_edited) for folder in counted(folders, "building")]
    names = [entry["name"] for entry in entries]
    for entry, folder in zip(entries, folders, strict=True):
        if names.count(entry["name"]) > 1:
            entry["name"] = f"{entry['name']} ({folder.name})"
    write_file(out, press_page(entries, "hand", about).encode())
    return entries


def session_page(folder: Path, accept_edited: bool = False) -> str:
    """Return the page that shows a session of an emitted folder; raises as write_press_page."""
    return press_page([scene_entry(folder, accept_edited, with_map=False)], "session")


def press_page(
    entries: Sequence[dict[str, Any]], source: Literal["hand", "session"], about: str = ""
) -> str:
    """Return the page's text. source: a hand on the page, or a session of `springpot run`."""
    first, maps = entries[0], any("map" in entry for entry in entries)
    context = {
        "title": first["name"],
        "source": source,
        "about": about,
        "entries": entries,
        "min_mm": plain(1e3 * first["free_m"]),
        "max_mm": plain(1.3e3 * max(entry["depth_m"] for entry in entries)),
        "stiffnesses": len(STIFFNESS_NPM),
        "stiffness_at": STIFFNESS_NPM.index(DESIGN_HAND.stiffness_npm),
        "masses": len(MASS_KG),
        "mass_at": MASS_KG.index(DESIGN_HAND.mass_kg),
        "delays": len(added_delays()),
        "damping_nspm": plain(DESIGN_HAND.damping_nspm),
        "scenes": Markup(json.dumps(entries).replace("<", "\\u003c")),
        "maps": maps,
        "scripts": (*_SCRIPTS[:-1], *(_MAP_SCRIPTS if maps else ()), _SCRIPTS[-1]),
    }
    return page_text("press.html", context, "springpot.host.page")


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
