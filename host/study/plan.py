"""A planned study: its emitted scenes, and order and sides of every trial, in a folder."""

import csv
import hashlib
import io
import json
import os
import shutil
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, TextIO

import numpy as np

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.files import sync_path, write_folder_atomically
from springpot.codegen.messages import with_progress
from springpot.host.emission.emission import read_emission
from springpot.host.steps import emit
from springpot.host.study.definition import RENDERED, Study, read_study

Row = dict[str, str]
_DEFINITION, _ORDERS, _PLAN = "study.toml", "orders.csv", "plan.json"


def _lock(stream: TextIO) -> None:
    """Keep the file to this process until it is closed. Raises OSError where another has it."""
    if sys.platform == "win32":
        import msvcrt

        stream.seek(1 << 30)  # a byte that nobody reads: a lock there keeps no reader out
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
        stream.seek(0, os.SEEK_END)
    else:
        import fcntl

        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)


@contextmanager
def append_only_table(
    file: Path, columns: Sequence[str]
) -> Iterator[tuple[list[Row], Callable[[Sequence[object]], None]]]:
    """Yield the rows of a table, and what appends one: it is on the disk when that returns.

    A last row that a crash cut is dropped. Raises UsageError while another process has the table,
    DataError where it is damaged.
    """
    with file.open("a", newline="", encoding="utf-8", errors="backslashreplace") as stream:
        try:
            _lock(stream)
        except (BlockingIOError, PermissionError):
            raise UsageError(f"{file}: in use: close the other window that runs this") from None
        rows = read_table(file, columns)
        stream.truncate(file.read_bytes().rfind(b"\n") + 1)

        def append(row: Sequence[object]) -> None:
            csv.writer(stream, lineterminator="\n").writerow(row)
            stream.flush()
            os.fsync(stream.fileno())

        if not file.stat().st_size:
            append(columns)
            sync_path(file.parent)
        yield rows, append


def read_table(file: Path, columns: Sequence[str]) -> list[Row]:
    """Read a table, no rows where there is no file; a last row that was cut is left out.

    Raises DataError where it has other columns.
    """
    text = file.read_bytes().decode(errors="replace") if file.exists() else ""
    rows = list(csv.reader(io.StringIO(text[: text.rfind("\n") + 1], newline="")))
    for number, row in enumerate(rows, 1):
        if len(row) != len(columns) or (number == 1 and row != list(columns)):
            raise DataError(f"{file}: row {number} is damaged: take the file from your backup")
    return [dict(zip(columns, row, strict=True)) for row in rows[1:]]


class Trial(NamedTuple):
    """A row of orders.csv. session: "0" is practice; trial: from "1" in it.

    left, right: "real NAME", which the experimenter places there, or RENDERED.
    """

    participant: str
    session: str
    trial: str
    method: str
    material: str
    left: str
    right: str


@dataclass(frozen=True, eq=False)
class StudyPlan:
    """A planned study, read back. participants: "01", "02", ..."""

    path: Path
    study: Study
    participants: tuple[str, ...]
    trials: tuple[Trial, ...]

    def folder(self, participant: str) -> Path:
        """Return where tables and logs of a participant lie."""
        return self.path / f"participant-{participant}"

    def scenes_of(self, trial: Trial) -> list[Path]:
        """Return the emission that a trial renders; of real objects alone, one of each material."""
        sides, first = (trial.left, trial.right), self.study.methods[0]
        return [
            self.path / place
            for (material, method), (_, place) in _scenes(self.study).items()
            if (material, method) == (trial.material, trial.method)
            or (RENDERED not in sides and f"real {material}" in sides and method == first)
        ]


def make_orders(study: Study, participants: Sequence[str]) -> list[Trial]:
    """Draw each participant's orders and sides from the study's seed and the numbers."""
    conditions, trials = study.session_trials(), list[Trial]()
    for number, participant in enumerate(participants, 1):
        for session in range(study.sessions + 1):
            random = np.random.default_rng([study.seed, number, session])
            order = random.permutation(len(conditions))
            swapped = random.integers(2, size=len(order))
            for place in range(len(order) if session else study.practice):
                method, material, *sides = conditions[order[place]]
                left, right = sides[::-1] if swapped[place] else sides
                trials.append(Trial(participant, str(session), str(place + 1), method, material,
                                    left, right))  # fmt: skip
    return trials


def write_plan(file: Path, participants: int, out: Path) -> StudyPlan:
    """Emit the scenes of a study file and write its plan as a new folder.

    Raises UsageError where the folder is there already or the study cannot be run, and what an
    emission raises.
    """
    study = read_study(file)
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise UsageError(f"{out}: exists and is not overwritten: give a new folder")
    numbers = [f"{k:0{max(2, len(str(participants)))}d}" for k in range(1, participants + 1)]
    out.parent.mkdir(parents=True, exist_ok=True)
    with write_folder_atomically(out) as aside:
        aside.mkdir()
        shutil.copyfile(file, aside / _DEFINITION)
        with (aside / _ORDERS).open("w", newline="", encoding="utf-8") as orders:
            rows = [Trial._fields, *make_orders(study, numbers)]
            csv.writer(orders, lineterminator="\n").writerows(rows)
        for scene, place in with_progress(list(_scenes(study).values()), "emitting"):
            with warnings.catch_warnings(record=True) as doubts:
                warnings.simplefilter("always")
                emit(aside / place, scene=file.parent / scene)
            for doubt in doubts:
                warnings.warn(f"{scene}: {doubt.message}", stacklevel=2)
        plan = {"schema": 1, "participants": numbers, "hashes": _hashes(aside, study)}
        (aside / _PLAN).write_text(
            json.dumps(plan, indent=1) + "\n", encoding="utf-8", newline="\n"
        )
    return read_plan(out)


def read_plan(path: Path) -> StudyPlan:
    """Read a planned study. Raises DataError where it is none, or anything of it was changed."""
    try:
        plan = json.loads((path / _PLAN).read_text(encoding="utf-8"))
        participants, hashes = tuple(plan["participants"]), dict(plan["hashes"])
    except (OSError, ValueError, KeyError, TypeError):
        raise DataError(f"{path}: no planned study: `springpot study plan` makes one") from None
    study = read_study(path / _DEFINITION)
    for name, digest in _hashes(path, study).items():
        if hashes.get(name) != digest:
            raise DataError(f"{path / name}: changed since the plan: restore it, or plan anew")
    trials = (Trial(**row) for row in read_table(path / _ORDERS, Trial._fields))
    return StudyPlan(path, study, participants, tuple(trials))


def _scenes(study: Study) -> dict[tuple[str, str], tuple[str, str]]:
    """Return the scene file of each material and method, and the folder of its emission."""
    return {(material.name, method): (file, f"scenes/{number}-{method}")
            for number, material in enumerate(study.material, 1)
            for method, file in material.scenes.items()}  # fmt: skip


def _hashes(folder: Path, study: Study) -> dict[str, str]:
    """Hash all that people will be shown: definition, orders, emitted scenes."""
    hashes = {name: hashlib.sha256((folder / name).read_bytes()).hexdigest()
             for name in (_DEFINITION, _ORDERS)}  # fmt: skip
    return hashes | {place: read_emission(folder / place).hash
                    for _, place in _scenes(study).values()}  # fmt: skip
