"""cppcheck and its addon over a program: which rule is broken in which file, and how often."""

import re
import shutil
import subprocess
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from proof.misra.programs import RUNTIME, Program

_LINE = re.compile(r"(?P<file>[^\t]+)\t(?P<line>\d+)\t(?P<column>\d+)\t(?P<id>\S+)")
Place = tuple[str, str, int, int]  # rule, file, line, column


def missing_tool() -> str | None:
    """What to install, where cppcheck is not there."""
    return None if shutil.which("cppcheck") else "no cppcheck: `apt-get install cppcheck`"


def tool_version() -> str:
    return subprocess.run(
        ["cppcheck", "--version"], capture_output=True, text=True, check=True
    ).stdout.strip()


def places_of(programs: list[Program], workers: int) -> set[Place]:
    """Every place where a rule is broken, each once though many programs include it."""
    with ThreadPoolExecutor(workers) as pool:
        return set().union(*pool.map(_places, programs))


def by_rule_and_file(places: set[Place]) -> Counter[tuple[str, str]]:
    """How many places each rule has in each file."""
    return Counter((rule, file) for rule, file, _, _ in places)


def _places(program: Program) -> set[Place]:
    command = [
        "cppcheck", "--addon=misra", "--std=c11", "--platform=unix64", "--library=posix",
        "--quiet", "--template={file}\t{line}\t{column}\t{id}",
        *(f"-I{folder}" for folder in program.include), *map(str, program.sources),
    ]  # fmt: skip
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    found = set()
    for line in result.stderr.splitlines():
        match = _LINE.fullmatch(line)
        if match is None or result.returncode:
            raise SystemExit(f"cppcheck on {program.name}: {line}")
        rule = match["id"].removeprefix("misra-c2012-")
        found.add((rule, _home(Path(match["file"])), int(match["line"]), int(match["column"])))
    return found


def _home(file: Path) -> str:
    """Where a file is kept: what a scene copies out of runtime_c is named there."""
    if RUNTIME in file.parents:
        return str(file.relative_to(RUNTIME.parent))
    kept = sorted(RUNTIME.rglob(file.name))
    return str(kept[0].relative_to(RUNTIME.parent)) if kept else f"emitted/{file.name}"
