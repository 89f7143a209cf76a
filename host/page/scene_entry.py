"""What the page holds of one emitted scene: its C as WebAssembly, and what to compare it with."""

import base64
import json
import math
import re
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from google_crc32c import value as crc32c
from numpy.typing import NDArray

from springpot.codegen.emit.golden import backward_velocity, golden_positions
from springpot.codegen.errors import DataError
from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.notes import CLAMPED
from springpot.host.devices.serial_device import BAUD
from springpot.host.devices.wire import constant
from springpot.host.emission.emission import Emitted, read_emission
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.page.hands import hands_entry
from springpot.host.page.page_module import page_module, port_hash
from springpot.host.pages.page import plain
from springpot.host.session.outcome import NOTE_WORDS
from springpot.host.simulation.scenarios import Workspace
from springpot.host.validation.store import Series, read_validation

_ACROSS = 40  # steps of a survey along the longer side, at least: some 1600 presses
_CELLS = 16384  # as sp_page_survey_cells
_PRESS_S = 0.2
MAX_RECORDED = 8000  # samples of a recording on the page: a few presses, some 40 kB
_FULL_SCALE = 32767


def map_entry(plan: Plan) -> dict[str, Any]:
    """Return the grid, m, and the survey of a scene with places: its places have every node.

    The object is pressed to depth_m within press_ticks at each of `survey` places, along x and y.
    """
    hammerstein = plan.model.hammerstein
    assert hammerstein is not None and hammerstein.places is not None
    places = hammerstein.places
    steps = [nodes - 1 for nodes in places.nodes]
    finer = max(1, math.ceil(_ACROSS / max(steps)))
    while finer > 1 and math.prod(finer * its + 1 for its in steps) > _CELLS:
        finer -= 1
    return {
        "first_m": places.first_m.tolist(),
        "last_m": places.last_m.tolist(),
        "nodes": list(places.nodes),
        "survey": [finer * its + 1 for its in steps],
        "depth_m": float(plan.range.max_m),
        "press_ticks": max(50, round(_PRESS_S / plan.dt_s)),
    }


def scene_entry(folder: Path, accept_edited: bool = False, with_map: bool = True) -> dict[str, Any]:
    """Return everything that the page needs of an emitted folder, for JSON.

    with_map: whether the page shows the map of a scene with places. Raises DataError for no
    emission, UsageError without the compiler for WebAssembly.
    """
    emitted = read_emission(folder, accept_edited)
    plan, space = emitted.plan, Workspace.of(emitted.plan)
    with_map = with_map and plan.has_places and plan.contact  # else no place is ever left
    module = page_module(folder, plan, with_map)
    return {
        "name": plan.scene.name,
        "what": _what(emitted),
        "hash": emitted.hash,
        "prefix": plan.scene.runtime.prefix,
        "number": plan.scene.runtime.number,
        "dt_s": plan.dt_s,
        "free_m": space.free_m,
        "depth_m": float(plan.range.max_m),
        "min_n": float(plan.output.min_n),
        "max_n": float(plan.output.max_n),
        "watchdog_s": plan.watchdog_s,
        "baud": BAUD,
        "golden_ticks": len(golden_positions(plan)),
        "notes": list(NOTE_WORDS.items()),
        "clamped": CLAMPED,
        "actions": {"stop": constant("STOP"), "reset": constant("RESET")},
        "port": port_hash(plan if with_map else None),
        "hands": packed(json.dumps(hands_entry(plan)).encode()),
        "wasm": packed(module),
        "wasm_bytes": len(module),
        "tick": packed(_tick_of(folder, plan, with_map).encode()),
        "recording": _recording(folder, plan, with_map),
        **({"map": map_entry(plan)} if with_map else {}),
    }


def packed(content: bytes) -> str:
    """Return deflated, and in letters: the page unpacks it with the browser's own functions."""
    return base64.b64encode(zlib.compress(content, 9)).decode()


def module_of(text: str) -> bytes:
    """Return the module that `packed` made a text of."""
    return zlib.decompress(base64.b64decode(text))


def _tick_of(folder: Path, plan: Plan, with_map: bool) -> str:
    """Return the C function of one tick, as it was emitted: of three axes where the tool slides."""
    prefix = plan.scene.runtime.prefix
    text = (folder / f"{prefix}.c").read_text()
    (one,) = re.findall(r"^/\* One tick with .*?^}$", text, re.MULTILINE | re.DOTALL)
    return str(one)


def _what(emitted: Emitted) -> str:
    plan = emitted.plan
    max_mm, max_n = 1e3 * float(plan.range.max_m), float(plan.model.trained.max_n)
    trained = (
        f"{plan.scene.name}: recorded down to {plain(max_mm)} mm and {plain(max_n)} N; model "
        f"{plan.model.kind}, {plain(1 / plan.dt_s)} steps a second"
    )
    return trained + (f"; edited: {', '.join(emitted.edited)}." if emitted.edited else ".")


def _recording(folder: Path, plan: Plan, with_map: bool) -> dict[str, Any] | None:
    """Return the begin of the first recording that validated the folder; None without one.

    That of a scene with places is of one place, which a page without the map cannot choose.
    """
    try:
        stored = read_validation(folder)
    except DataError:
        return None
    series, rows = stored.series[0], slice(0, MAX_RECORDED)
    if plan.has_places and (not with_map or series.place_m is None):
        return None
    position = series.position_m[rows].astype(plan.dtype)
    velocity, place_m = backward_velocity(position, plan.dt_s), series.place_m
    placed = {"place_m": place_m} if plan.has_places else {}
    force, _ = Replay(SceneLibrary(folder)).run(position, velocity, **placed)
    measured, scale_n = _in_steps(series.measured_n[rows])
    return {
        "name": series.name,
        "position_m": packed(position.tobytes()),
        "measured": packed(measured.tobytes()),
        "scale_n": scale_n,
        "force_crc": f"{crc32c(force.tobytes()):08x}",
        "seen": _seen_words(stored.metadata["result"].get("seen"), series),
        **placed,
    }


def _in_steps(measured_n: NDArray[np.float64]) -> tuple[NDArray[np.int16], float]:
    """Quantise forces for a picture: 16 bits a sample, and the force of one step."""
    scale_n = float(np.abs(measured_n).max()) / _FULL_SCALE or 1.0
    return np.rint(measured_n / scale_n).astype(np.int16), scale_n


def _seen_words(seen: int | None, series: Series) -> str:
    if seen is None:
        return ""
    return "Training data is among the recordings." if seen else "The model was not trained on it."
