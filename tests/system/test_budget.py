"""The size of springpot: what is added must be taken away elsewhere; what a release needs."""

import re
import subprocess
import tomllib

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
        ("codegen/*.py", 6417),
        ("trainer/*.py", 8778),
        ("host/*.py", 12442),
        ("runtime_c/*.[ch] codegen/*.j2", 7713),
        ("tests/*.py", 19910),
    ],
)
def test_lines(what: str, most: int) -> None:
    assert sum(text.count("\n") for text in tracked(*what.split())) <= most


def test_files_of_the_product() -> None:
    assert len(tracked(*PYTHON)) <= 201


def test_documents() -> None:
    pages = tracked("docs/*.md")
    assert len(pages) <= 25
    assert sum(len(text.split()) for text in [*pages, *tracked("README.md")]) <= 20000


def test_names_commands_and_kinds() -> None:
    assert len(dir(springpot)) <= 24 and len(COMMANDS) <= 16
    assert len(kind_names()) <= 6  # five, and auto


def test_types_are_written() -> None:
    lines = [line for text in tracked(*PYTHON) for line in text.splitlines()]
    assert sum(bool(re.search(r"\bAny\b", line)) for line in lines) <= 150


PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
VERSION = PROJECT["version"]


def test_the_version_is_said_where_a_release_says_it_and_nowhere_else() -> None:
    assert f"\nversion: {VERSION}\n" in (ROOT / "CITATION.cff").read_text()
    assert re.search(rf"^## {re.escape(VERSION)}\b", (ROOT / "CHANGELOG.md").read_text(), re.M)
    assert not [text for text in tracked("*.py") if f'"{VERSION}"' in text]


def test_everything_locked_has_a_hash_and_everything_needed_is_locked() -> None:
    lock = (ROOT / "requirements.lock").read_text()
    pins = re.findall(r"^([\w.-]+)==\S+.*?\n((?:    --hash=sha256:[0-9a-f]{64}.*\n)+)", lock, re.M)
    locked = {name.lower() for name, _ in pins}
    assert len(pins) == len(re.findall(r"^\S+==", lock, re.M))
    extras = PROJECT["optional-dependencies"]
    needed = [*PROJECT["dependencies"], *(item for name in extras for item in extras[name])]
    names = {re.split(r"[\[>=]", item)[0].lower() for item in needed}
    assert names - locked == {"springpot", "ziglang"}  # ziglang: where there is no compiler at all
