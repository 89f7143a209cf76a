"""Frama-C's Eva: intervals of all variables that hold for every input, after any number of calls.

What it cannot bound becomes an alarm; a state that may be infinite or no number is one too.
"""

import hashlib
import os
import re
import shutil
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path


@dataclass(frozen=True)
class Analysis:
    """What Eva said: alarms in its own words, each once; seconds: of wall time.

    question: hash of the C, the options and the analyser; the same question has the same answer.
    """

    alarms: tuple[str, ...]
    seconds: float
    question: str


Known = Mapping[str, Analysis]  # by question


class EvaFailedError(Exception):
    """Eva did not end, or refused the C."""


@dataclass(frozen=True)
class Precision:
    """What costs time, by function, where there is such a function.

    apart: how many ways through it are kept apart. by_result: kept apart by what it returns.
    parts: into how many pieces the interval of a number is cut that stands twice in an expression.
    """

    apart: dict[str, int]
    by_result: tuple[str, ...]
    parts: dict[str, int]

    def options(self, text: str) -> list[str]:
        """For the C of `text`: Eva refuses names of functions that it does not find."""
        parts = {name: str(n) for name, n in self.parts.items()}
        settings = (
            ("-eva-slevel-function", {name: str(ways) for name, ways in self.apart.items()}),
            ("-eva-split-return-function", dict.fromkeys(self.by_result, "full")),
            ("-eva-subdivide-non-linear-function", parts),
        )
        options = []
        for option, by_name in settings:
            found = [f"{k}:{v}" for k, v in by_name.items() if re.search(rf"\b{k}\(", text)]
            options += [option, ",".join(found)] if found else []
        return options


def frama_c() -> str | None:
    """Path of the analyser, None where it is not installed."""
    return shutil.which("frama-c")


@dataclass(frozen=True)
class Question:
    """What Eva is asked: of `source` in `folder`, from its function `prove`.

    files: the C that it includes. flags: of the compiler. told: what of Eva's log is an alarm.
    """

    folder: Path
    source: Path
    files: Sequence[Path]
    flags: Sequence[str]
    options: Sequence[str]
    told: Callable[[str], tuple[str, ...]]

    def hash(self) -> str:
        """Of all that decides about the answer: of a flag's folder, the files."""
        parts = [_said_by("frama-c", "-version"), *self.options]
        parts += [flag for flag in self.flags if not flag.startswith("-I")]
        parts += [f"{path.name}\n{path.read_text()}" for path in sorted(self.files)]
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def answer(question: Question, known: Known, timeout_s: float) -> Analysis:
    """What is known of the question, or else Eva's answer. Raises EvaFailedError."""
    name = question.hash()
    if name in known:
        return known[name]
    said, seconds = _run_eva(question, timeout_s)
    return Analysis(question.told(said), seconds, name)


def _run_eva(question: Question, timeout_s: float) -> tuple[str, float]:
    """Eva's log, which stays in the folder, and seconds of wall time."""
    folder, source = question.folder, question.source
    share = _said_by("frama-c", "-print-share-path")
    command = [
        "frama-c", "-c11", "-machdep", "gcc_x86_64",
        f"-cpp-extra-args={' '.join(question.flags)} -I{share}/libc", str(source),
        "-eva", "-main", "prove", "-warn-special-float", "none", "-eva-msg-key=-initial-state",
        *question.options,
    ]  # fmt: skip
    began = time.monotonic()
    log = folder / "eva.log"
    with log.open("w") as out:
        try:
            ended = subprocess.run(
                command,
                cwd=folder,
                env={**os.environ, "PWD": str(folder.resolve())},  # Frama-C believes it
                stdout=out,
                stderr=out,
                timeout=timeout_s,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise EvaFailedError(f"{source}: no end within {timeout_s:.0f} s") from None
    said = log.read_text()
    if ended.returncode:
        why = next((line for line in said.splitlines() if "rror" in line), said[-200:])
        raise EvaFailedError(f"{source}: {why}, see {log}")
    return said, time.monotonic() - began


@cache
def _said_by(*command: str) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def alarms_in(said: str) -> tuple[str, ...]:
    """Alarms of Eva's log, each once."""
    found = re.findall(r"^\[eva:alarm\] (.*?)(?=^\[|\Z)", said, re.MULTILINE | re.DOTALL)
    return tuple(dict.fromkeys(" ".join(one.split()) for one in found))


def unbounded_in(said: str) -> tuple[str, ...]:
    """Of Eva's log: states that may not be finite after some number of calls."""
    end = re.search(r"Values at end of function prove:\n(.*?)(?=^\[eva|\Z)", said, re.M | re.S)
    if end is None:
        return ("the driver's loop does not end: nothing is known of its states",)
    ranges = re.findall(r"^ +(\S[^∈]*)∈\s*(.*?)(?=^ +\S[^∈\n]*∈|\Z)", end[1], re.M | re.S)
    return tuple(
        f"state may not be finite: {' '.join(name.split())} in {' '.join(where.split())}"
        for name, where in ranges
        if "inf" in where or "NaN" in where
    )
