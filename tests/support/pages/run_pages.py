"""Running the commands of README.md and docs/, as a reader does."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

import numpy as np

from support.pages.documents import Block, page_blocks
from support.paths import ROOT, TESTS


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
            last, code = "\n".join(_run_commands(block, folder)), ""
            printed.append(last)
    if code and name != "README.md":  # its Python is another test's
        printed.append(run_python(code, folder, name))
    return "\n".join(printed)


NUMBER = r"\d+(?:\.\d+)?"
LASTS = r" ?[mun]?s\b"  # behind a number: a time, of this machine and this run
ALIKE = 0.02  # of a number: another compiler's size, another processor's last digits


def unseen(block: Block, printed: str) -> list[str]:
    """Lines of a block that what was printed does not have: spaces apart, numbers nearly.

    A number is any where the note says so: the commands ran with other words than the page's.
    """
    text, any_number = " ".join(printed.split()), "any numbers" in block.note
    lines = [" ".join(line.split()) for line in block.text.splitlines()]
    return [line for line in lines if not _shown(line, text, 1e9 if any_number else ALIKE)]


def _shown(line: str, text: str, alike: float) -> bool:
    """Tell whether a text has a line, but for its times, with numbers that differ by a share."""
    pieces = re.split(rf"({NUMBER})(?![\d.]|{LASTS})", line)  # text, number, text, ...
    known = [float(number) for number in pieces[1::2]]
    texts = [re.sub(rf"{NUMBER}(?={LASTS})", "\0", piece) for piece in pieces[::2]]
    pattern = f"({NUMBER})".join(re.escape(each).replace("\0", NUMBER) for each in texts)
    return any(
        np.allclose([float(number) for number in found.groups()], known, rtol=alike)
        for found in re.finditer(pattern.replace("\\" + NUMBER, NUMBER), text)
    )


def run_python(code: str, folder: Path, where: str) -> str:
    """Run a page's Python in `folder`, in a process of its own; what it printed."""
    return run_words(["python", "-c", code], folder, where)


def print_urls(block: Block, folder: Path) -> Iterator[str]:
    """Start each line's process from where the paths of the page begin; its URL while it runs."""
    for command in block.commands:
        _, script, *options = shlex.split(command)
        process = subprocess.Popen(
            [sys.executable, str(ROOT / script), *options], cwd=folder, stdout=subprocess.PIPE,
            text=True, env=_environment(),
        )  # fmt: skip
        with process:
            try:
                yield process.stdout.readline().strip()
            finally:
                process.terminate()


def _run_commands(block: Block, folder: Path) -> list[str]:
    """Run the commands of a block; springpot's own in a row share one process: it loads once."""
    commands = map(shlex.split, block.substituted)
    printed: list[str] = []
    for ours, group in groupby(commands, lambda words: words[0] == "springpot"):
        each = list(group)
        if ours:
            lines = [shlex.join(words[1:]) for words in each]
            each = [["python", "-m", "support.in_process", *lines]]
        printed += [run_words(words, folder, block.where) for words in each]
    return printed


def installed(words: list[str], folder: Path) -> list[str]:
    """Return a `pip install` into `folder`, which Python imports from."""
    if words[2] == "-e":  # a copy: setuptools builds beside what it installs
        source = shutil.copytree(ROOT / words[3], folder / "source" / Path(words[3]).name)
        words = [*words[:2], "--no-build-isolation", "--target", str(folder), str(source)]
    return ["python", "-m", *words, "--quiet", "--no-deps", "--disable-pip-version-check"]


def run_words(words: list[str], folder: Path, where: str) -> str:
    if words[0] == "pip":
        words = installed(words, folder)
    if words[0] == "python":
        words[0] = sys.executable
    elif words[0] == "make" and words[1] != "-C":  # the checkout's own: that it is there must do
        words = ["make", "--dry-run", "--directory", str(ROOT), *words[1:]]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False,
                          env=_environment(), timeout=900)  # fmt: skip
    assert done.returncode == 0, f"{where}: {shlex.join(words)}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr


def _environment() -> dict[str, str]:
    """Wide, so that no line of a table is broken."""
    path = os.pathsep.join([*filter(None, sys.path), str(TESTS)])
    return os.environ | {"COLUMNS": "400", "PYTHONPATH": path}
