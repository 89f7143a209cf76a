"""The page of a lab with a Force Dimension device, on a stand-in for it."""

import json
import os
import shlex
import subprocess
from contextlib import ExitStack
from pathlib import Path

import pytest
from support.pages.documents import page_blocks
from support.pages.run_pages import MAIN, print_urls
from support.peer import peer

from springpot.host.devices.drivers import parse_device

# Of each command, what the stand-in is: held by a hand, or on the object.
_LAB = {
    "record": ("--pressing", "--cell-ms", 3, "--surface-mm", 12),
    "run": ("--surface-mm", 12),
}


@pytest.mark.realtime
def test_the_lab_s_first_session(tmp_path: Path) -> None:
    """Every command of the page on the stand-in: to a log that repeats, bit for bit."""
    printed = {}
    (tmp_path / "short.toml").write_text(
        "[[profile]]\namplitude_n = 4.0\nfrequency_hz = 1.0\ncycles = 4\n"
        "[[profile]]\namplitude_n = 2.5\nfrequency_hz = 2.0\ncycles = 6\n"
    )
    for block in page_blocks("how-to/drives.md"):
        if block.note.startswith("file "):
            (tmp_path / block.note.removeprefix("file ")).write_text(block.text)
        elif block.note == "prints URL":
            assert all(url.startswith("dhd://") for url in print_urls(block, tmp_path))
        elif not block.language:
            for line in block.substituted:
                words = shlex.split(line)
                printed[words[1]] = lab_command(words, tmp_path)
    assert "surface_mm = -12" in printed["record"]
    assert "ms late" in printed["record"]
    assert json.loads(printed["validate"])["mismatches"] == 0


def lab_command(words: list[str], folder: Path) -> str:
    """Run a command with a stand-in for the device that it names; what it printed."""
    environment = {**os.environ, "COLUMNS": "200"}  # cells of a table stay whole
    with ExitStack() as stack:
        if options := _LAB.get(words[1]):
            device = stack.enter_context(peer("dhd_device", *options))
            environment["SPRINGPOT_LIBDHD"] = parse_device(device.url).settings["library"]
            if "--force" in words:
                words[words.index("--force") + 1] = device.wait_for("cell")["url"]
        done = subprocess.run(
            [*MAIN, *words[1:]], cwd=folder, input="\n\n\n", text=True, capture_output=True,
            check=False, timeout=300, env=environment,
        )  # fmt: skip
    assert done.returncode == 0, f"{words}\n{done.stdout}\n{done.stderr}"
    return done.stdout + ("" if "--json" in words else done.stderr)
