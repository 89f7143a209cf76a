"""The C of a page: an emitted scene, a hand that presses it and the protocol, as WebAssembly."""

import hashlib
import re
import tempfile
from pathlib import Path

from springpot.codegen.emit.header import prefixed
from springpot.codegen.plan.plan import Plan
from springpot.host.native.scene_library import port_headers
from springpot.host.wasm.wasm_module import scene_module
from springpot.runtime_c.paths import PORT_BROWSER, PORT_WIRE, SIM

_OF_ALL = ("sp_page",)
_OF_MAPS = ("sp_page_map", "sp_page_survey")


def page_module(folder: Path, plan: Plan, with_map: bool) -> bytes:
    """Return the module; with_map: the hand presses at places, and the places are surveyed."""
    prefix = plan.scene.runtime.prefix
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        place = Path(scratch)
        for file in PORT_BROWSER.glob("*.[ch]"):
            text = file.read_text().replace('"sp_scene.h"', f'"{prefix}_scene.h"')
            (place / file.name).write_text(prefixed(text, prefix))
        for name, header in port_headers(folder, plan.real).items():
            (place / name).write_text(header)
        declared = "".join((place / f"{name}.h").read_text() for name in _declared(with_map))
        return scene_module(
            folder,
            sources=[*(place / name for name in _sources(plan, with_map)), PORT_WIRE / "sp_wire.c"],
            include=[place, PORT_WIRE, SIM],
            exports=re.findall(r"\b(sp_page_\w+)\(", declared),
        )


def port_hash(plan: Plan | None = None) -> str:
    """Hash the C that joins a scene's in the page's module: a page that was kept may be older.

    plan: of a scene that is shown with its map.
    """
    names = [f"{name}.{kind}" for name in _OF_ALL for kind in "ch"]
    if plan is not None:
        names = sorted({*names, *_sources(plan, True), *(f"{each}.h" for each in _declared(True)),
                        "sp_page_touch.h"})  # fmt: skip
    sources = [*(PORT_BROWSER / name for name in names), SIM / "sim_hand.h",
               *sorted(PORT_WIRE.glob("*.[ch]"))]  # fmt: skip
    return hashlib.sha256(b"".join(file.read_bytes() for file in sources)).hexdigest()


def _declared(with_map: bool) -> tuple[str, ...]:
    return (*_OF_ALL, *_OF_MAPS) if with_map else _OF_ALL


def _sources(plan: Plan, with_map: bool) -> list[str]:
    return [f"{name}.c" for name in (*_declared(with_map), *(["sp_page_held"] if with_map else []))]
