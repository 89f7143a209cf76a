"""What the page holds of one emitted scene: its C as WebAssembly, and what to compare it with."""

import base64
import hashlib
import json
import re
import tempfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from google_crc32c import value as crc32c
from numpy.typing import NDArray

from springpot import DataError
from springpot.devices import BAUD, constant
from springpot.emission import (
    CLAMPED,
    Emitted,
    Plan,
    backward_velocity,
    golden_positions,
    prefixed,
    read_emission,
)
from springpot.figures import plain
from springpot.host.wings.page.hands import hands_entry
from springpot.loop import NOTE_WORDS
from springpot.native import (
    PORT_BROWSER,
    PORT_WIRE,
    SIM,
    Replay,
    SceneLibrary,
    port_headers,
    scene_module,
)
from springpot.simulation import Workspace
from springpot.validation import Series, read_validation

MAX_RECORDED = 8000  # samples of a recording on the page: a few presses, some 40 kB
_FULL_SCALE = 32767


def scene_entry(folder: Path, accept_edited: bool = False) -> dict[str, Any]:
    """Return everything that the page needs of an emitted folder, for JSON.

    Raises DataError for no emission, UsageError without the compiler for WebAssembly.
    """
    emitted = read_emission(folder, accept_edited)
    plan, space = emitted.plan, Workspace.of(emitted.plan)
    module = page_module(folder, plan)
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
        "port": port_hash(),
        "hands": packed(json.dumps(hands_entry(plan)).encode()),
        "wasm": packed(module),
        "wasm_bytes": len(module),
        "tick": packed(_tick_of(folder, plan).encode()),
        "recording": _recording(folder, plan),
    }


def page_module(folder: Path, plan: Plan) -> bytes:
    """Return the emitted C, the simulated hand and the protocol as one WebAssembly module."""
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        prefix = plan.scene.runtime.prefix
        text = (PORT_BROWSER / "sp_page.c").read_text()
        page_c = Path(scratch) / "sp_page.c"
        page_c.write_text(prefixed(text.replace('"sp_scene.h"', f'"{prefix}_scene.h"'), prefix))
        for name, header in port_headers(folder, plan.real).items():
            (page_c.parent / name).write_text(header)
        declared = (PORT_BROWSER / "sp_page.h").read_text()
        return scene_module(
            folder,
            sources=[page_c, PORT_WIRE / "sp_wire.c"],
            include=[page_c.parent, PORT_BROWSER, PORT_WIRE, SIM],
            exports=re.findall(r"\b(sp_page_\w+)\(", declared),
        )


def port_hash() -> str:
    """Hash the C that joins a scene's in the page's module: a page that was kept may be older."""
    sources = [*sorted(PORT_BROWSER.glob("*.[ch]")), SIM / "sim_hand.h",
               *sorted(PORT_WIRE.glob("*.[ch]"))]  # fmt: skip
    return hashlib.sha256(b"".join(file.read_bytes() for file in sources)).hexdigest()


def packed(content: bytes) -> str:
    """Return deflated, and in letters: the page unpacks it with the browser's own functions."""
    return base64.b64encode(zlib.compress(content, 9)).decode()


def module_of(text: str) -> bytes:
    """Return the module that `packed` made a text of."""
    return zlib.decompress(base64.b64decode(text))


def _tick_of(folder: Path, plan: Plan) -> str:
    """Return the C function of one tick, as it was emitted."""
    prefix = plan.scene.runtime.prefix
    sources = [folder / f"{prefix}_scene.c", folder / f"{prefix}.c"]
    text = next(file for file in sources if file.exists()).read_text()
    (found,) = re.findall(r"^/\* One tick with .*?^}$", text, re.MULTILINE | re.DOTALL)
    return str(found)


def _what(emitted: Emitted) -> str:
    plan = emitted.plan
    max_mm, max_n = 1e3 * float(plan.range.max_m), float(plan.model.trained.max_n)
    trained = (
        f"{plan.scene.name}: recorded down to {plain(max_mm)} mm and {plain(max_n)} N; model "
        f"{plan.model.kind}, {plain(1 / plan.dt_s)} steps a second"
    )
    return trained + (f"; edited: {', '.join(emitted.edited)}." if emitted.edited else ".")


def _recording(folder: Path, plan: Plan) -> dict[str, Any] | None:
    """Return the begin of the first recording that validated the folder; None without one."""
    try:
        stored = read_validation(folder)
    except DataError:
        return None
    series, rows = stored.series[0], slice(0, MAX_RECORDED)
    position = series.position_m[rows].astype(plan.dtype)
    force, _ = Replay(SceneLibrary(folder)).run(position, backward_velocity(position, plan.dt_s))
    measured, scale_n = _in_steps(series.measured_n[rows])
    return {
        "name": series.name,
        "position_m": packed(position.tobytes()),
        "measured": packed(measured.tobytes()),
        "scale_n": scale_n,
        "force_crc": f"{crc32c(force.tobytes()):08x}",
        "seen": _seen_words(stored.metadata["result"].get("seen"), series),
    }


def _in_steps(measured_n: NDArray[np.float64]) -> tuple[NDArray[np.int16], float]:
    """Quantise forces for a picture: 16 bits a sample, and the force of one step."""
    scale_n = float(np.abs(measured_n).max()) / _FULL_SCALE or 1.0
    return np.rint(measured_n / scale_n).astype(np.int16), scale_n


def _seen_words(seen: int | None, series: Series) -> str:
    if seen is None:
        return ""
    return "Training data is among the recordings." if seen else "The model was not trained on it."
