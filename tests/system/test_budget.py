"""The size of springpot: what is added must be taken away elsewhere."""

import re
import subprocess

import pytest
from support.paths import ROOT

import springpot
from springpot.host.commands import COMMANDS
from springpot.trainer.kinds import kind_names


def tracked(*patterns: str) -> list[str]:
    """Text of the files that git knows."""
    listed = subprocess.run(
        ["git", "ls-files", *patterns], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.split()
    return [(ROOT / name).read_text(encoding="utf-8") for name in listed if (ROOT / name).exists()]


PYTHON = [f"{floor}/*.py" for floor in ("codegen", "trainer", "host")]


@pytest.mark.parametrize(
    ("what", "most"),
    [
        ("codegen/*.py", 6680),
        ("trainer/*.py", 8766),
        ("host/*.py", 12952),
        ("runtime_c/*.[ch] codegen/*.j2", 7721),
        ("tests/*.py", 20566),
    ],
)
def test_lines(what: str, most: int) -> None:
    assert sum(text.count("\n") for text in tracked(*what.split())) <= most


def test_files_of_the_product() -> None:
    assert len(tracked(*PYTHON)) <= 200


def test_documents() -> None:
    pages = tracked("docs/*.md")
    assert len(pages) <= 25
    assert sum(len(text.split()) for text in [*pages, *tracked("README.md")]) <= 20000


def test_names_commands_and_kinds() -> None:
    assert len(dir(springpot)) <= 24
    assert len(COMMANDS) <= 16
    assert len(kind_names()) <= 6  # five, and auto


def test_types_are_written() -> None:
    lines = [line for text in tracked(*PYTHON) for line in text.splitlines()]
    assert sum(bool(re.search(r"\bAny\b", line)) for line in lines) <= 150
