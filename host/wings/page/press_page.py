"""`springpot page`: one self-contained file in which people press what was emitted."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from markupsafe import Markup

from springpot.basics import write_file
from springpot.checks import DESIGN_HAND
from springpot.console import counted
from springpot.figures import page_text, plain
from springpot.host.wings.page.hands import MASS_KG, STIFFNESS_NPM, added_delays
from springpot.host.wings.page.scene_entry import scene_entry

# In the order in which they use each other.
_SCRIPTS = ("scene.js", "intent.js", "trace.js", "canvas.js", "object_view.js", "plots.js",
            "sources.js", "readout.js", "controls.js", "main.js")  # fmt: skip


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
    """Text of the page that shows a session with an emitted folder; raises as write_press_page."""
    return press_page([scene_entry(folder, accept_edited)], "session")


def press_page(
    entries: Sequence[dict[str, Any]], source: Literal["hand", "session"], about: str = ""
) -> str:
    """The page's text. source: a hand on the page, or a session of `springpot run`."""
    first = entries[0]
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
        "scripts": _SCRIPTS,
    }
    return page_text("press.html", context, "springpot.host.wings.page")
