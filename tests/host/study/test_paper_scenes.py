"""The fifteen scenes of the paper's study, made by the lines of the page from other recordings."""

import csv
import shlex
from pathlib import Path

import pytest
from support.pages.documents import page_blocks
from support.pages.run_pages import run_words
from support.paths import ROOT
from support.small import press, recording, training

from springpot import write_recordings


@pytest.mark.slow
def test_the_page_s_lines_make_check_and_plan_fifteen_scenes(tmp_path: Path) -> None:
    (block,) = (one for one in page_blocks("how-to/study.md") if one.language == "sh")
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
