"""cppcheck and its addon over a program: which rule is broken in which file, and how often."""

import re
import shutil
import subprocess
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

from proof.functions import functions_by_line
from proof.misra.programs import RUNTIME, Program

_LINE = re.compile(r"(?P<file>[^\t]+)\t(?P<line>\d+)\t(?P<column>\d+)\t(?P<id>\S+)")
Place = tuple[str, str, str, int, int]  # rule, file, function, line, column


def missing_tool() -> str | None:
    """What to install, where cppcheck is not there."""
    return None if shutil.which("cppcheck") else "no cppcheck: `apt-get install cppcheck`"


def tool_version() -> str:
    return subprocess.run(
        ["cppcheck", "--version"], capture_output=True, text=True, check=True
    ).stdout.strip()


def places_of(programs: list[Program], workers: int) -> list[set[Place]]:
    """Find the places where a rule is broken, of each program."""
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(_places, programs))


def by_function(places: list[set[Place]]) -> Counter[tuple[str, str, str]]:
    """Count the places of each rule in each function of each file, in the program with most."""
    found: Counter[tuple[str, str, str]] = Counter()
    for of_program in places:
        found |= Counter(place[:3] for place in of_program)
    return found


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
        file, number = Path(match["file"]), int(match["line"])
        found.add((rule, _home(file), _functions(file)[number - 1], number, int(match["column"])))
    return found


@cache
def _functions(file: Path) -> list[str]:
    return functions_by_line(file.read_text(), is_python=False)


def _home(file: Path) -> str:
    """Where a file is kept: what a scene copies out of runtime_c is named there."""
    if RUNTIME in file.parents:
        return str(file.relative_to(RUNTIME.parent))
    kept = sorted(RUNTIME.rglob(file.name))
    return str(kept[0].relative_to(RUNTIME.parent)) if kept else f"emitted/{file.name}"
