"""The documents are of the program: what they name exists, and their commands give what is said."""

import importlib
import json
import os
import re
import shlex
import shutil
import subprocess
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import click
import pytest
from support.pages.documents import PAGES, Block, blocks, inline_commands, name_of, page_blocks
from support.pages.job import SCENE, small_job
from support.pages.notebooks import QUICK_START, code_cells, run_cells
from support.pages.prepared_pages import PREPARED, emitted_job
from support.pages.run_pages import print_urls, run_page
from support.paths import ROOT, ZIG
from support.peer import CLI, cli, peer

from springpot import read_recordings
from springpot.host.cli import springpot
from springpot.host.devices.drivers import parse_device
from springpot.host.emission.scene_file import read_scene
from springpot.host.recording.protocols import load_protocol
from springpot.host.study.definition import read_study

TESTED = {
    "python": "test_python_examples.py",
    "cpp": "test_documented_c.py",
    "csharp": "test_documented_c.py",
    "c": "",
    "text": "",
    "sh": "test_scripts.py",
}
EVERY = [block for page in PAGES for block in blocks(page)]
COMMANDS = [block for block in EVERY if not block.language]
TARGETS = set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.M))


def known_options(words: list[str]) -> None:
    """Assert that a command and its options exist."""
    context = click.Context(springpot)
    found = springpot.get_command(context, words[1])
    if isinstance(found, click.Group) and words[2:]:
        found = found.get_command(context, words[2])
    assert found, f"springpot {' '.join(words[1:3])}: no such command"
    known = {option for parameter in found.params for option in parameter.opts}
    for word in words[2:]:
        if word.startswith("--"):
            assert word.partition("=")[0] in known, f"springpot {words[1]} {word}"


def test_every_block_is_of_a_kind_that_a_test_looks_at() -> None:
    assert len(COMMANDS) > 8
    for block in EVERY:
        assert block.language in {"", "toml", *TESTED}, block.where
        for name in filter(None, [TESTED.get(block.language)]):
            assert list((ROOT / "tests").rglob(name)), name
    run = {
        *PREPARED,
        "README.md",
        "how-to/drives.md",  # by a test below, as how-to/own-device.md
        "how-to/own-device.md",
        "reference/python.md",  # by test_python_examples.py
    }
    executable = [block for block in EVERY if block.language in {"", "python"}]
    assert {name_of(block.page) for block in executable} == run


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_every_command_and_option_exists(page: Path) -> None:
    kinds = {"", "sh"}
    written = [line for block in blocks(page) if block.language in kinds for line in block.commands]
    for line in [*written, *inline_commands(page)]:
        words = shlex.split(line, comments=True)
        if words[0] == "springpot" and words[1:]:
            known_options(words)
        elif words[0] == "make" and words[1] != "-C":
            assert words[1] in TARGETS, line


@pytest.mark.parametrize(
    "block", [block for block in EVERY if block.language == "toml"], ids=lambda block: block.where
)
def test_every_scene_is_one(block: Block, tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text(block.text)
    if block.note == "file study.toml":
        read_study(file)
        return
    if "[[profile]]" in block.text or "places_m" in block.text:
        load_protocol(str(file), 0)
        return
    file.write_text(block.text if "schema" in block.text else SCENE + block.text)
    read_scene(file)


MACH_1 = ROOT / "examples" / "mach1.ipynb"


@pytest.mark.slow
def test_the_readme_runs(tmp_path: Path) -> None:
    printed = " ".join(run_page("README.md", tmp_path).split())
    assert "0 ticks differ" in printed and (tmp_path / "c" / "report.html").exists()


@pytest.mark.slow
@pytest.mark.parametrize("name", PREPARED)
def test_a_page_runs(tmp_path: Path, name: str) -> None:
    PREPARED[name](tmp_path)
    run_page(name, tmp_path, *(["arm"] if shutil.which("arm-none-eabi-gcc") else []))


@pytest.mark.long
@pytest.mark.skipif(not ZIG.exists(), reason="no zig: make build/zig/ziglang/zig")
def test_a_library_for_windows_is_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ZIG.parents[1])
    PREPARED["how-to/game-engine.md"](tmp_path)
    run_page("how-to/game-engine.md", tmp_path, "zig")
    assert (tmp_path / "eco.dll").read_bytes().startswith(b"MZ")


@pytest.mark.slow
def test_the_public_recording_runs(
    tmp_path: Path, mach1_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copyfile(mach1_file, "Dynamic_data.txt")
    names, outputs = run_cells(MACH_1)
    assert names["percent"] < 1.0
    difference, measured = (axes.lines[-1].get_ydata() for axes in (names["below"], names["above"]))
    assert abs(difference).max() < 0.05 * measured.max() and "image/png" in outputs[-1][-1]["data"]


def shown(outputs: list[dict[str, Any]]) -> list[tuple[str, list[str]]]:
    """Return the text of each output without its digits, and the forms that it has."""
    found = []
    for one in outputs:
        data = one.get("data", {})
        text = "".join(one.get("text", data.get("text/plain", "")))
        found.append((re.sub(r"\d[\d.e+-]*", "#", text), sorted(data)))
    return found


@pytest.mark.slow
def test_the_quick_start_shows_what_is_stored(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`make notebook` renews it."""
    monkeypatch.chdir(tmp_path)
    Path("felt.h5").touch()  # of a run before
    names, outputs = run_cells(QUICK_START)
    stored = [cell["outputs"] for cell in code_cells(json.loads(QUICK_START.read_text()))]
    assert list(map(shown, outputs)) == list(map(shown, stored)) and names["found"].mismatches == 0
    assert names["found"].accuracy.rmse_percent_of_peak < 1.0
    assert QUICK_START.stat().st_size < 300_000


# Of each command, what the stand-in is: held by a hand, or on the object.
_LAB = {"record": ("--pressing", "--cell-ms", 3, "--surface-mm", 12), "run": ("--surface-mm", 12)}


@pytest.mark.realtime
def test_a_session_runs_on_each_device_to_try(tmp_path: Path) -> None:
    emitted_job(tmp_path)
    (block,) = (one for one in page_blocks("how-to/run-a-device.md") if one.note == "prints URL")
    for url in print_urls(block, tmp_path):
        words = ["run", "--scene", "c", "--device", url, "--seconds", "1"]
        done = cli(*words, cwd=tmp_path)
        assert done.returncode == 0, f"{url}\n{done.stderr}"


@pytest.mark.realtime
def test_the_lab_s_first_session(tmp_path: Path) -> None:
    """Every command of the page on the stand-in: to a log that repeats, bit for bit.

    The surface is where the tool touches it, three times: at a height of 12 mm, pressed downwards.
    """
    printed = {}
    (tmp_path / "short.toml").write_text(
        "[[profile]]\namplitude_n = 4.0\nfrequency_hz = 1.0\ncycles = 2\n"
        "[[profile]]\namplitude_n = 2.5\nfrequency_hz = 2.0\ncycles = 4\n"
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
    recorded = printed["record"]
    assert recorded.count("press Enter") == 3 and "ms late" in recorded
    surface_mm = float(recorded.partition("surface_mm = ")[2].partition(":")[0])
    assert surface_mm == pytest.approx(-12.0, abs=0.1)
    peaks_n = sorted(one.force_n.max() for one in read_recordings(tmp_path / "training"))
    assert peaks_n == pytest.approx([2.5, 4.0], abs=0.5)
    assert json.loads(printed["validate"])["mismatches"] == 0


def device_line(name: str) -> list[str]:
    """Return the words of the one command of a page that needs a device, as its note has them."""
    (block,) = (one for one in page_blocks(name) if one.need == "device")
    (line,) = block.substituted
    return shlex.split(line)


@pytest.mark.realtime
def test_a_device_without_a_force_is_recorded_with_a_load_cell(tmp_path: Path) -> None:
    (tmp_path / "short.toml").write_text(
        "[[profile]]\namplitude_n = 4.0\nfrequency_hz = 1.0\ncycles = 2\n"
    )
    assert "ms late" in lab_command(device_line("how-to/record.md"), tmp_path)
    (press,) = read_recordings(tmp_path / "training")
    assert press.force_n.max() == pytest.approx(4.0, abs=0.5)


@pytest.mark.realtime
def test_the_first_connection_of_a_device_of_one_s_own(tmp_path: Path) -> None:
    small_job(tmp_path)
    words = device_line("how-to/own-device.md")
    with peer("serial_device") as device:
        words[words.index("--device") + 1] = device.url
        done = cli(*words[1:], cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "felt.h5").exists()


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
            [*CLI, *words[1:]], cwd=folder, input="\n\n\n", text=True, capture_output=True,
            check=False, timeout=300, env=environment,
        )  # fmt: skip
    assert done.returncode == 0, f"{words}\n{done.stdout}\n{done.stderr}"
    return done.stdout + ("" if "--json" in words else done.stderr)


def test_lists_in_the_pages_are_those_of_the_code(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "docs/_ext")
    in_clone = importlib.import_module("reference_pages.in_clone")
    for path in ROOT.glob("docs/**/*.md"):
        page = path.read_text(encoding="utf-8")
        assert in_clone.written(page) == page, f"{path}: make docs"
        assert page.count("<!-- generated: ") == len(in_clone.MARK.findall(page))
