"""The code blocks of README.md and docs/, and what runs the commands in them.

A comment in front of a block, which a reader does not see, says what a test has to know:

    <!-- test: file scene.toml -->     the block is written to that file
    <!-- test: URL = sim://pad, 60 = 1 -->     words that stand for others when it runs
    <!-- test: arm -->                 needs a cross compiler
    <!-- test: board -->               needs a cross compiler and an emulator
    <!-- test: seen -->                lines of what the commands before it print, with any numbers
    <!-- test: prints URL -->          each line is a process that prints a URL, and goes on
"""

import os
import re
import shlex
import subprocess
import sys
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from support.paths import ROOT, TESTS

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
MAIN = [sys.executable, "-c", "from springpot.host.cli import main; main()"]
_BLOCK = re.compile(
    r"^(?:<!-- test: (?P<note>[^\n]*) -->\n)?```(?P<language>[\w{}-]*)\n(?P<text>.*?)^```",
    re.M | re.S,
)
_INLINE = re.compile(r"`((?:springpot|make) [^`]+)`")
_TTY = "/dev/pts/N"
NEEDS = ("arm", "board")


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
        """What the block needs beside Python and a compiler: "arm", "board" or ""."""
        return next((word for word in self.note.split() if word in NEEDS), "")

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


def run_commands(block: Block, folder: Path) -> list[str]:
    """Run a block's commands in `folder`, one after the other; return what each printed."""
    printed = []
    with ExitStack() as running:
        port = ""
        for command in block.substituted:
            words = shlex.split(command.replace(_TTY, port) if port else command)
            if words[0].startswith("qemu"):
                port = _emulator(words, folder, running)
            else:
                printed.append(_run(words, folder, block.where))
    return printed


def unseen(block: Block, printed: str) -> list[str]:
    """Lines of a block that what was printed does not have, numbers and spaces apart."""
    text = _masked(printed)
    return [line for line in block.text.splitlines() if _masked(line) not in text]


def _masked(text: str) -> str:
    return re.sub(r"\d[\d.]*", "#", " ".join(text.split()))


def run_python(code: str, folder: Path, where: str) -> str:
    """Run a page's Python in `folder`, in a process of its own; what it printed."""
    return _run(["python", "-c", code], folder, where)


def print_urls(block: Block, folder: Path) -> list[str]:
    """Start each line's process from where the paths of the page begin; return their URLs."""
    found = []
    for command in block.commands:
        _, script, *options = shlex.split(command)
        process = subprocess.Popen(
            [sys.executable, str(ROOT / script), *options], cwd=folder, stdout=subprocess.PIPE,
            text=True, env=_environment(),
        )  # fmt: skip
        with process:
            assert process.stdout is not None
            found.append(process.stdout.readline().strip())
            process.terminate()
    return found


def _run(words: list[str], folder: Path, where: str) -> str:
    if words[0] == "springpot":
        words = [*MAIN, *words[1:]]
    elif words[0] == "python":
        words[0] = sys.executable
    elif words[:2] == ["make", "firmware"]:  # into this checkout's build folder, by its .venv
        board, scene = (word.partition("=")[2] for word in words[2:])
        words = [*MAIN, "firmware", "--scene", scene, "--board", board, "--out",
                 f"build/firmware/{board}"]  # fmt: skip
    elif words[0] == "make" and words[1] != "-C":  # the checkout's own: that it is there must do
        words = ["make", "--dry-run", "--directory", str(ROOT), *words[1:]]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False,
                          env=_environment(), timeout=900)  # fmt: skip
    ended = done.returncode == 0 or stood_still(done)
    assert ended, f"{where}: {shlex.join(words)}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr


def stood_still(done: subprocess.CompletedProcess[str]) -> bool:
    """Whether a session ended with the force latched: the machine stood still for too long."""
    return done.returncode == 5 and "the watchdog had tripped and the force was zero" in done.stderr


def _emulator(words: list[str], folder: Path, running: ExitStack) -> str:
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               text=True)  # fmt: skip
    running.enter_context(process)  # closes its output, and waits
    running.callback(process.terminate)
    assert process.stdout is not None
    line = process.stdout.readline()
    found = re.search(r"/dev/\S+", line)
    assert found, f"the emulator told no port: {line}"
    return found[0]


def _environment() -> dict[str, str]:
    """Wide, so that no line of a table is broken."""
    path = os.pathsep.join([*filter(None, sys.path), str(TESTS)])
    return os.environ | {"COLUMNS": "400", "PYTHONPATH": path}
