"""The code blocks of README.md and docs/.

A comment in front of a block, which a reader does not see, says what a test has to know:

    <!-- test: file scene.toml -->     the block is written to that file
    <!-- test: URL = sim://pad, 60 = 1 -->     words that stand for others when it runs
    <!-- test: arm -->                 needs a cross compiler
    <!-- test: zig -->                 needs the compiler of springpot[cc]
    <!-- test: device -->              needs a device: a test of its own has a stand-in
    <!-- test: package -->             needs a package that no test has
    <!-- test: seen -->                lines of what the commands before it print
    <!-- test: seen, any numbers -->   likewise, from a shorter run than the page's
    <!-- test: prints URL -->          each line is a process that prints a URL, and goes on
"""

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from support.paths import ROOT

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
_BLOCK = re.compile(
    r"^(?:<!-- test: (?P<note>[^\n]*) -->\n)?"
    r"```(?P<language>[\w{}-]*)(?: [^\n]*)?\n(?P<text>.*?)^```",
    re.M | re.S,
)
_INLINE = re.compile(r"`((?:springpot|make) [^`]+)`")
NEEDS = ("arm", "zig", "device", "package")


@dataclass(frozen=True)
class Block:
    """One block. note: what the comment before it says; language: "" for commands."""

    page: Path
    line: int
    note: str
    language: str
    text: str

    @property
    def where(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line}"

    @property
    def need(self) -> str:
        """What the block needs beside Python and a compiler: one of NEEDS, or ""."""
        return next((word for word in re.findall(r"\w+", self.note) if word in NEEDS), "")

    @property
    def commands(self) -> list[str]:
        """Lines with those that a backslash goes on with, without comments."""
        lines = self.text.replace("\\\n", " ").splitlines()
        return [shlex.join(words) for line in lines if (words := shlex.split(line, comments=True))]

    @property
    def substituted(self) -> list[str]:
        """The commands with the words that the note gives others for."""
        found = self.commands
        for pair in self.note.split(","):
            word, equals, other = pair.partition(" = ")
            if equals:
                found = [re.sub(rf"(?<!\S){word.strip()}(?!\S)", other.strip(), c) for c in found]
        return found


def blocks(page: Path) -> list[Block]:
    text = page.read_text()
    return [
        Block(page, text.count("\n", 0, found.start()) + 1, found["note"] or "", found["language"],
              found["text"])
        for found in _BLOCK.finditer(text)
        if not found["language"].startswith("{")  # the site's own: lists of pages
    ]  # fmt: skip


def inline_commands(page: Path) -> list[str]:
    """Commands in the midst of a sentence."""
    text = re.sub(_BLOCK, "", page.read_text())
    return [" ".join(found.split()) for found in _INLINE.findall(text)]


def name_of(page: Path) -> str:
    """From docs/; README.md beside it."""
    return page.name if page.name == "README.md" else str(page.relative_to(ROOT / "docs"))


def page_blocks(name: str) -> list[Block]:
    """name: of the page, from docs/, or README.md."""
    page = ROOT / name if name == "README.md" else ROOT / "docs" / name
    assert page in PAGES, name
    return blocks(page)
