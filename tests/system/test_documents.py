"""The documents are of the program: commands, options, scenes and kinds of blocks exist."""

import re
import shlex
from pathlib import Path

import click
import pytest
from support.pages.documents import PAGES, Block, blocks, inline_commands, name_of
from support.pages.job import SCENE
from support.pages.prepared_pages import PREPARED
from support.paths import ROOT

from springpot.host.cli import springpot
from springpot.host.emission.scene_file import read_scene
from springpot.host.recording.protocols import load_protocol
from springpot.host.study.definition import read_study

TESTED = {
    "python": "test_python_examples.py",
    "cpp": "test_documented_c.py",
    "csharp": "test_documented_c.py",
    "c": "",
    "text": "",
    "sh": "",
}  # sh: commands that need a device, people or root: their options are compared
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
        "how-to/microcontroller.md",
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
    if "[[profile]]" in block.text or "places_m" in block.text:
        load_protocol(str(file), 0)
        return
    file.write_text(block.text if "schema" in block.text else SCENE + block.text)
    read_scene(file)
