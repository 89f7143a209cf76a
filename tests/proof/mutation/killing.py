"""Mutants given to tests: what is caught, what survives, and the record of it.

The record grows by one line of JSON a mutant: a run that was ended goes on where it was. What was
caught stays caught while the file is the same; what survived is tried again.
"""

import argparse
import hashlib
import json
import os
import queue
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from mutant import Mutant

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests"))
from proof.functions import functions_by_line  # noqa: E402

SURVIVED = "survived"
UNCHANGED = "no other program"  # the same machine code or bytecode, or none: not counted


@dataclass(frozen=True)
class Tried:
    """One mutant, and what became of it. by: the test that caught it, SURVIVED or UNCHANGED."""

    file: str
    text: str  # hash of the unchanged file
    number: int  # line
    line: str
    change: str  # the line as it was changed
    by: str
    place: str = ""  # function.kind of the change: what reasons go by

    @property
    def key(self) -> tuple[str, str, int, str]:
        return self.file, self.text, self.number, self.change


@dataclass(frozen=True)
class _Task:
    tried: Tried  # as if it survived
    mutant: Mutant


# The tests that are given one: (a copy of the checkout, file, its changed text) -> Tried.by
Attempt = Callable[[Path, str, str], str]


def parse_options(files: Iterable[str]) -> argparse.Namespace:
    """out, workers and files: those of `files` that the command line asks for."""
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", default="", help="files with this in their name")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    options.files = [file for file in files if options.only in file]
    return options


def read_record(path: Path) -> dict[tuple[str, str, int, str], Tried]:
    """What was tried before."""
    if not path.exists():
        return {}
    rows = [Tried(**json.loads(line)) for line in path.read_text().splitlines()]
    return {row.key: row for row in rows}


def try_all(
    record: Path,
    files: list[str],
    mutants_of: Callable[[str], Iterator[Mutant]],
    attempt: Attempt,
    workers: int,
) -> list[Tried]:
    """Give each mutant of the files to `attempt` in a copy of the checkout; what became of all."""
    record.parent.mkdir(parents=True, exist_ok=True)
    before = read_record(record)
    tasks = [task for file in files for task in _tasks(file, mutants_of)]
    known = {key for key, row in before.items() if row.by != SURVIVED}
    left = [task for task in tasks if task.tried.key not in known]
    print(f"{len(tasks)} mutants, {len(left)} to try", flush=True)
    with _copies(workers) as copies, record.open("a") as out, ThreadPoolExecutor(workers) as pool:

        def give(task: _Task) -> Tried:
            copy = copies.get()
            place = copy / task.tried.file
            text = place.read_text()
            try:
                by = attempt(copy, task.tried.file, task.mutant.apply(text))
            finally:
                place.write_text(text)
                copies.put(copy)
            return replace(task.tried, by=by)

        left_files = {task.tried.file for task in left}
        for file in filter(left_files.__contains__, files):
            _require_sound(copies, file, attempt)
        for done, row in enumerate(pool.map(give, left), 1):
            before[row.key] = row
            out.write(json.dumps(asdict(row)) + "\n")
            out.flush()
            if row.by == SURVIVED:
                print(f"{row.file}:{row.number}: {row.line}\n    -> {row.change}", flush=True)
            if done % 100 == 0:
                print(f"{done} of {len(left)}", flush=True)
    return [replace(task.tried, by=before[task.tried.key].by) for task in tasks]


def _require_sound(copies: "queue.Queue[Path]", file: str, attempt: Attempt) -> None:
    """The tests pass on the file as it is: or they would seem to catch everything."""
    copy = copies.get()
    by = attempt(copy, file, (copy / file).read_text())
    copies.put(copy)
    if by not in (SURVIVED, UNCHANGED):
        raise SystemExit(f"{by} fails with {file} as it is: mend that first")


def _tasks(file: str, mutants_of: Callable[[str], Iterator[Mutant]]) -> list[_Task]:
    text = (ROOT / file).read_text()
    digest = hashlib.sha256(text.encode()).hexdigest()[:16]
    tasks = []
    functions = functions_by_line(text, is_python=Path(file).suffix == ".py")
    for mutant in mutants_of(text):
        line, change = mutant.lines(text)
        number = mutant.line_number(text)
        place = f"{functions[number - 1]}.{mutant.kind(text)}"
        tried = Tried(file, digest, number, line, change, SURVIVED, place)
        tasks.append(_Task(tried, mutant))
    return list({task.tried.key: task for task in tasks}.values())


@contextmanager
def _copies(count: int) -> Iterator["queue.Queue[Path]"]:
    """So many copies of the checkout, gone afterwards: mutants never lie in the checkout itself."""
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard"],
        cwd=ROOT, check=True, capture_output=True, text=True,
    )  # fmt: skip
    with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
        copies: queue.Queue[Path] = queue.Queue()
        for k in range(count):
            copy = Path(folder) / str(k)
            for name in listed.stdout.splitlines():
                source = ROOT / name
                if source.is_file() and not source.is_symlink():
                    (copy / name).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy2(source, copy / name)
            subprocess.run(["make", "-s", "ns"], cwd=copy, check=True)
            copies.put(copy)
        yield copies
