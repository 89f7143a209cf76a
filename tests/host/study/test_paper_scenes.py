"""The paper's study by the lines of its page: recordings, fifteen scenes, a plan, a session."""

import csv
import os
import shlex
import subprocess
from pathlib import Path

import pytest
from support.pages.documents import Block, page_blocks
from support.pages.run_pages import run_words
from support.paths import ROOT
from support.peer import CLI
from support.small import press, recording, training

from springpot import read_recordings, write_recordings


def shell_block() -> Block:
    """The lines of the page."""
    (block,) = (one for one in page_blocks("how-to/study.md") if one.language == "sh")
    return block


@pytest.mark.slow
def test_the_page_s_loop_records(tmp_path: Path) -> None:
    """Of two objects; the others take as long."""
    loop, done, _ = shell_block().text.partition("done\n")
    (tmp_path / "springpot").write_text(f'#!/bin/sh\nexec {shlex.join(CLI)} "$@"\n')
    (tmp_path / "springpot").chmod(0o755)
    loop = loop.replace("ecoflex-00-10 ecoflex-00-30 ecoflex-00-50 ", "")
    path = f"{tmp_path}{os.pathsep}{os.environ['PATH']}"
    subprocess.run(["sh", "-e", "-c", loop + done], cwd=tmp_path, check=True, capture_output=True,
                   env=os.environ | {"PATH": path})  # fmt: skip
    for name in ("dragon-skin-fx", "dragon-skin-10"):
        assert len(read_recordings(tmp_path / "recordings" / name / "training")) > 3
        assert read_recordings(tmp_path / "recordings" / name / "validation")


@pytest.mark.slow
def test_the_page_s_lines_make_check_and_plan_fifteen_scenes(tmp_path: Path) -> None:
    block = shell_block()
    names = block.text.partition(" in ")[2].partition(";")[0].split()
    for name in names:
        write_recordings(tmp_path / "recordings" / name / "training", training()[::3])
        tests = [recording("v", press(0.9))]
        write_recordings(tmp_path / "recordings" / name / "validation", tests)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    lines = [shlex.split(line) for line in block.commands]
    (make,) = (words for words in lines if words[0] == "python")
    printed = run_words(make, tmp_path, block.where)
    assert printed.count(", 0 ticks differ, stable in every hand") == 15, printed
    (plan,) = (words for words in lines if words[:3] == ["springpot", "study", "plan"])
    line = shlex.join(plan[1:])
    run_words(["python", "-m", "support.in_process", line], tmp_path, block.where)
    rows = list(csv.DictReader((tmp_path / "study" / "orders.csv").read_text().splitlines()))
    rendered = {(row["material"], row["method"]) for row in rows
                if "rendered" in (row["left"], row["right"])}  # fmt: skip
    assert len(rendered) == 15 and len({row["participant"] for row in rows}) == 18
    run, report = (
        shlex.split(line.replace("serial:///dev/ttyACM0", "'sim://ecoflex-00-30?hand=mid'"))
        for line in block.commands[-2:]
    )
    assert run[:3] == ["springpot", "study", "run"] and report[:3] == [
        "springpot",
        "study",
        "report",
    ]
    felt = subprocess.run([*CLI, *run[1:]], cwd=tmp_path, input="l\nr\n50\n", text=True,
                          capture_output=True, check=False)  # fmt: skip
    assert felt.returncode == 0 and (tmp_path / "study/participant-07/responses.csv").exists()
    done = subprocess.run(
        [*CLI, *report[1:]], cwd=tmp_path, text=True, capture_output=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "07" in done.stdout  # who has not finished is named, and left out
