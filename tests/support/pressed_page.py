"""A page that a script presses in a headless browser, and what came of it."""

import html
import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from support.browser import browse, console_errors

_SCRIPTS = [Path(__file__).with_name(name) for name in ("press_map.js", "press_by_script.js")]


@dataclass(frozen=True, eq=False)
class Pressed:
    """csv: what the page offers as a download; found: its words; console: errors."""

    csv: str
    found: dict[str, Any]
    console: list[str]

    @property
    def rows(self) -> np.ndarray:
        """Time, position and force, shape (n, 3)."""
        return np.loadtxt(self.csv.splitlines(), delimiter=",", skiprows=1)


def press_page(page: Path, **how: Any) -> Pressed:
    """Press it by script. how: `path`, `map`, `sliders`, `pick` of it."""
    text = "\n".join(script.read_text() for script in _SCRIPTS)
    script = f"<script>window.how = {json.dumps(how)};\n{text}</script>"
    copy = page.with_name(f"pressed-{page.name}")
    copy.write_text(page.read_text().replace("<script ", script + "<script ", 1))
    done = browse(copy, 1600, "--virtual-time-budget=20000", "--dump-dom")
    match = re.search(r'data-found="([^"]*)"', done.stdout)
    assert match, done.stderr[-2000:]
    found = json.loads(html.unescape(match[1]))
    return Pressed(found.pop("csv"), found, console_errors(done))
