"""The documents run: their commands exist, give what the page says, and work in its order."""

import json
import os
import re
import shlex
import shutil
import subprocess
from contextlib import ExitStack
from pathlib import Path

import can
import cantools
import click
import numpy as np
import pytest
from scipy.io import savemat
from support.documents import (
    MAIN,
    PAGES,
    Block,
    blocks,
    inline_commands,
    print_urls,
    run_commands,
    run_python,
    stood_still,
    unseen,
)
from support.job import SCENE, small_job
from support.paths import ROOT
from support.peer import peer
from support.small import DT_S, press, soft_force

from springpot.host.cli import springpot
from springpot.host.devices.url import parse_device
from springpot.host.emission.emission import emit
from springpot.host.emission.scene_file import read_scene
from springpot.host.recording.protocols import load_protocol
from springpot.host.study.study_file import read_study

TESTED = {
    "python": "test_python_examples.py",
    "cpp": "test_chai3d.py",
    "c": "",
    "text": "",
    "sh": "",
}  # sh: commands that need a device, people or root: their options are compared
EVERY = [block for page in PAGES for block in blocks(page)]
COMMANDS = [block for block in EVERY if not block.language]
TARGETS = set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.M))


def name_of(page: Path) -> str:
    """From docs/; README.md beside it."""
    return page.name if page.name == "README.md" else str(page.relative_to(ROOT / "docs"))


def page_blocks(name: str) -> list[Block]:
    """name: of the page, from docs/, or README.md."""
    page = ROOT / name if name == "README.md" else ROOT / "docs" / name
    assert page in PAGES, name
    return [block for block in EVERY if block.page == page]


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
        "how-to/microcontroller.md",
        "how-to/study.md",
        "how-to/force-dimension.md",
        "how-to/python.md",  # by test_python_examples.py
        *(f"tutorials/{name}.md" for name in
          ("haptics-researcher", "embedded-engineer", "material-scientist")),
    }  # fmt: skip
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
    if block.note == "file presses.toml":
        load_protocol(str(file), 0)
        return
    file.write_text(block.text if "schema" in block.text else SCENE + block.text)
    read_scene(file)


def run_page(name: str, folder: Path, *needs: str) -> str:
    """All blocks of a page in order, in one folder; those that need more only where it is named.

    Python without a note is run where commands follow, or at the end.
    """
    printed: list[str] = []
    last, code = "", ""
    for block in page_blocks(name):
        if block.need and block.need not in needs:
            continue
        if block.note.startswith("file "):
            (folder / block.note.removeprefix("file ")).write_text(block.text)
        elif block.note.startswith("seen"):
            assert not unseen(block, last), f"{block.where}: {unseen(block, last)} not in\n{last}"
        elif block.language == "python":
            code += block.text
        elif block.note == "prints URL":
            assert all("://" in url for url in print_urls(block, folder)), block.where
        elif not block.language:
            printed += [run_python(code, folder, name)] if code else []
            last, code = "\n".join(run_commands(block, folder)), ""
            printed.append(last)
    if code and name != "README.md":  # its Python is another test's
        printed.append(run_python(code, folder, name))
    return "\n".join(printed)


def rig_files(folder: Path) -> None:
    """What a material scientist has: a table, a Mach-1 text, a MAT file, a log of CAN frames."""
    position_m = np.concatenate([press(0.5, 0.010, 2), press(2.0, 0.008, 4), press(5.0, 0.006, 5)])
    force_n, time_s = soft_force(position_m), np.arange(len(position_m)) * DT_S
    columns = np.column_stack([time_s, 1e3 * position_m, force_n])
    np.savetxt(folder / "test-rig.csv", columns, fmt="%.6f", delimiter=",", comments="",
               header="Time,Extension,Load")  # fmt: skip
    savemat(folder / "rig.mat", {"rig": {"z": 1e3 * position_m, "Fz": force_n}})
    rows = "".join(f"{t:.2f}\t{x:.6f}\t{f:.6f}\n" for t, x, f in
                   zip(0.01 * np.arange(400), 1e3 * press(0.25, 0.004)[::10],
                       soft_force(press(0.25, 0.004))[::10] / 9.80665e-3, strict=True))  # fmt: skip
    head = ("<Mach-1 File>\n<INFO>\nTime:\t10:08:47.546\n<END INFO>\n<Sinusoid>\n"
            "Stage Axis:\tPosition (z)\nAmplitude, mm:\t2\nFrequency, Hz:\t0.25000\n"
            "Number of Cycles:\t1\n<DATA>\nTime, s\tPosition (z), mm\tFz, gf\n")  # fmt: skip
    (folder / "Dynamic_data.txt").write_text(head + rows + "<END DATA>\n")
    (folder / "rig.dbc").write_text(
        'VERSION ""\nNS_ :\nBS_:\nBU_: RIG\nBO_ 291 Tool: 8 RIG\n'
        ' SG_ Position : 0|32@1- (0.0001,0) [0|0] "mm" RIG\n'
        ' SG_ Force : 32|16@1- (0.001,0) [0|0] "N" RIG\n'
    )
    database = cantools.database.load_file(folder / "rig.dbc")
    with can.Logger(folder / "drive.blf") as logger:
        for t, x, f in columns[::2]:
            data = database.encode_message("Tool", {"Position": x, "Force": f})
            logger(can.Message(1e9 + t, 291, is_extended_id=False, data=data, channel="vcan0"))


@pytest.mark.slow
def test_the_readme_runs(tmp_path: Path) -> None:
    printed = " ".join(run_page("README.md", tmp_path).split())
    assert "what was felt is what the model says" in printed
    assert (tmp_path / "c" / "report.html").exists()


@pytest.mark.slow
def test_the_tutorial_of_a_material_scientist(tmp_path: Path) -> None:
    run_page("tutorials/material-scientist.md", tmp_path)


@pytest.mark.realtime
def test_the_tutorial_of_a_haptics_researcher(tmp_path: Path) -> None:
    run_page("tutorials/haptics-researcher.md", tmp_path)


@pytest.mark.realtime
def test_the_tutorial_of_an_embedded_engineer(tmp_path: Path) -> None:
    arm = shutil.which("arm-none-eabi-gcc") is not None
    board = arm and shutil.which("qemu-system-arm") is not None
    needs = [name for name, there in (("arm", arm), ("board", board)) if there]
    run_page("tutorials/embedded-engineer.md", tmp_path, *needs)


def nothing(folder: Path) -> None:
    """For pages that make what they need."""


def emitted_job(folder: Path) -> None:
    small_job(folder)
    emit(read_scene(folder / "scene.toml"), folder / "model.spm", folder / "c")


PREPARED = {
    "how-to/fem.md": nothing,
    "how-to/import.md": rig_files,
    "how-to/measure-a-device.md": small_job,
    "how-to/own-ensemble.md": nothing,
    "how-to/record.md": nothing,
    "how-to/run-a-device.md": emitted_job,
    "how-to/single-file.md": small_job,
    "how-to/small-and-fast.md": small_job,
    "how-to/stability.md": small_job,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", PREPARED)
def test_a_page_runs(tmp_path: Path, name: str) -> None:
    PREPARED[name](tmp_path)
    run_page(name, tmp_path)


@pytest.mark.slow
def test_the_ten_minutes_of_a_study(tmp_path: Path) -> None:
    printed = " ".join(run_page("how-to/study.md", tmp_path).split())
    assert "18, 3 sessions of 4 trials" in printed
    assert "R1: " in printed
    assert "trials 216" in printed
    page = (tmp_path / "rehearsal" / "report" / "report.html").read_text()
    assert "RF-FD" in page
    assert "Hammerstein" in page


# Of each command, what the stand-in is: held by a hand, on the object, or let go.
_LAB = {
    "doctor": ("--presses-hz", 0),
    "place": ("--presses-hz", 0, "--surface-mm", 12),
    "identify": ("--free", '{"mass_kg": 0.25, "viscous_nspm": 4.0}'),
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
    for block in page_blocks("how-to/force-dimension.md"):
        if block.note.startswith("file "):
            (tmp_path / block.note.removeprefix("file ")).write_text(block.text)
        elif block.note == "prints URL":
            assert all(url.startswith("dhd://") for url in print_urls(block, tmp_path))
        elif not block.language:
            for line in block.substituted:
                words = shlex.split(line)
                printed[words[1]] = lab_command(words, tmp_path)
    assert "out of the object, as it must" in " ".join(printed["doctor"].split())
    assert "ms late, +-" in printed["record"]
    assert json.loads(printed["validate"])["mismatches"] == 0
    device = read_scene(tmp_path / "scene.toml").device
    assert device.mass_kg == pytest.approx(0.25, rel=0.1)


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
    ended = done.returncode == 0 or stood_still(done)
    assert ended, f"{words}\n{done.stdout}\n{done.stderr}"
    return done.stdout + ("" if "--json" in words else done.stderr)


def table_row(name: str, begins: str) -> list[str]:
    """The numbers of a row of a page's table."""
    (row,) = [line for line in (ROOT / "docs" / name).read_text().splitlines()
              if line.startswith(f"| {begins}")]  # fmt: skip
    return [cell.strip() for cell in row.strip("|").split("|")[1:]]


@pytest.mark.realtime
@pytest.mark.skipif(
    shutil.which("arm-none-eabi-gcc") is None, reason="no arm-none-eabi-gcc: make setup-mcu"
)
@pytest.mark.skipif(shutil.which("qemu-system-arm") is None, reason="no qemu-system-arm")
def test_the_first_board_gives_what_its_page_states(tmp_path: Path) -> None:
    small_job(tmp_path)
    for name in ("training", "validation"):
        shutil.rmtree(tmp_path / name)
    run_commands(page_blocks("how-to/record.md")[0], tmp_path)
    printed = " ".join(run_page("how-to/microcontroller.md", tmp_path).split())
    flash, ram, stack, _, bound = table_row("explanation/boards.md", "rf-fd")
    found = re.search(r"flash (\d+) bytes RAM (\d+) bytes and (\d+) of stack", printed)
    assert found, printed
    # Other versions of the compiler and of scikit-learn may differ by a few bytes and nodes.
    for said, given_bytes in zip((flash, ram, stack), found.groups(), strict=True):
        assert int(given_bytes) == pytest.approx(int(said), rel=0.02)
    told = re.search(r"at most (\d+) a tick", printed)
    assert told
    assert int(told[1]) == pytest.approx(int(bound), rel=0.02)
    printed = " ".join(run_page("how-to/microcontroller.md", tmp_path, "board").split())
    assert "what was felt is what the model says" in printed
