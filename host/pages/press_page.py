"""One self-contained HTML file in which people press emitted scenes."""

import base64
import json
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from markupsafe import Markup

from springpot.codegen.coupling.linear_loop import DESIGN_HAND, Hand
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.files import write_file
from springpot.codegen.messages import with_progress
from springpot.codegen.plan import Plan
from springpot.codegen.types import JsonObject
from springpot.host.emission.emission import Emitted, read_emission
from springpot.host.pages.page import page_text, plain
from springpot.host.pages.wasm_module import node_force_hash, page_module
from springpot.host.session.outcome import NOTE_WORDS
from springpot.host.simulation.scenarios import Workspace
from springpot.host.stability.linear import margin_sentence, plan_margin
from springpot.host.validation.store import read_validation

STIFFNESS_NPM = (100.0, 200.0, 300.0, 400.0, 600.0, 1000.0, 1500.0)  # of the hand
ADDED_DELAYS = range(4)  # samples beyond those of the scene's device
_MAX_RECORDED = 8000  # samples of a recording


def write_press_page(folders: Sequence[Path], out: Path) -> JsonObject:
    """Write the page of emitted folders; return the keys of `page --json`.

    Raises DataError for no emission, UsageError for a scene with places and without a compiler for
    WebAssembly, MismatchError where node computes other forces than this machine.
    """
    entries, scenes = [], []
    for folder in with_progress(folders, "building"):
        emitted = read_emission(folder)
        if emitted.plan.has_places:
            raise UsageError(
                f"{folder}: has places; the page presses one point: emit another model"
            )
        module = page_module(folder, emitted.plan)
        force_hash = node_force_hash(folder, emitted.plan, module)
        entries.append(_entry(folder, emitted, module))
        known = {key: entries[-1][key] for key in ("name", "hash")} | {"wasm_bytes": len(module)}
        selftest = None if force_hash is None else 0
        scenes.append(known | {"selftest": selftest, "force_hash": force_hash})
    context = {
        "entries": entries,
        "stiffness_at": STIFFNESS_NPM.index(DESIGN_HAND.stiffness_npm),
        "scenes": Markup(json.dumps(entries).replace("<", "\\u003c")),
    }
    write_file(out, page_text("press.html", context).encode())
    unmeasured = [entry["name"] for entry in entries if entry["recording"] is None]
    size = out.stat().st_size
    return {"out": str(out), "bytes": size, "scenes": scenes, "without_recording": unmeasured}


def _entry(folder: Path, emitted: Emitted, module: bytes) -> JsonObject:
    """Return what the page holds of a scene, for JSON."""
    plan = emitted.plan
    device, depth_m = plan.loop_device, float(plan.range.max_m)
    edited = f"; edited: {', '.join(emitted.edited)}" if emitted.edited else ""
    return {
        "name": plan.scene.name,
        "what": f"Model {plan.model.kind}, recorded down to {plain(1e3 * depth_m)} mm, "
        f"{plain(1 / plan.dt_s)} steps a second{edited}.",
        "hash": emitted.hash,
        "prefix": plan.scene.runtime.prefix,
        "number": plan.scene.runtime.number,
        "dt_s": plan.dt_s,
        "free_m": Workspace.of(plan).free_m,
        "depth_m": depth_m,
        "min_n": float(plan.output.min_n),
        "max_n": float(plan.output.max_n),
        "notes": list(NOTE_WORDS.items()),
        "device": [device.mass_kg, device.viscous_nspm, device.coulomb_n],
        "own_delay": device.delay_samples,
        "hand": [DESIGN_HAND.mass_kg, DESIGN_HAND.damping_nspm],
        "stiffness_npm": STIFFNESS_NPM,
        "verdicts": [[_verdict(plan, k, more) for more in ADDED_DELAYS] for k in STIFFNESS_NPM],
        "wasm": _packed(module),
        "recording": _recording(folder),
    }


def _verdict(plan: Plan, stiffness_npm: float, more_delay: int) -> str:
    """Return what the stability check says of a hand, in words."""
    hand = Hand(DESIGN_HAND.name, DESIGN_HAND.mass_kg, stiffness_npm, DESIGN_HAND.damping_nspm)
    return margin_sentence(plan_margin(plan, ((hand, more_delay),)), "this hand")


def _recording(folder: Path) -> list[str] | None:
    """Return depth and force of the first validated recording, float32; None without one."""
    try:
        recording, _ = read_validation(folder)[1][0]
    except DataError:
        return None
    step = -(-len(recording.force_n) // _MAX_RECORDED)
    both = (recording.position_m, recording.force_n)
    thinned = [values[::step].astype(np.float32) for values in both]
    return [_packed(values.tobytes()) for values in thinned]


def _packed(content: bytes) -> str:
    """Deflate, and write in letters."""
    return base64.b64encode(zlib.compress(content, 9)).decode()
