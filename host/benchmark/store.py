"""Results of the benchmark on disk: one file a point, written aside and renamed into place."""

import hashlib
import json
from collections.abc import Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from springpot.codegen.atomic_write import write_file
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.scene import Target
from springpot.host.benchmark.point import Point
from springpot.host.native.machine import machine_metadata
from springpot.trainer.recordings.recording import Recording

if TYPE_CHECKING:
    from springpot.trainer.selection.sweep import Candidate

RESULT = "bench.json"
_MARK = ".springpot-bench"
# Floors and rooms whose code decides a figure; what only shows them is left out.
_MEASURING = ("runtime_c", "codegen", "trainer", "host/native", "host/simulation", "host/stability",
              "host/emission", "host/boards", "host/benchmark")  # fmt: skip
_SHOWING = ("figures.py", "labels.py", "report.py")


class Store:
    """A bench folder: JSON of points and of what was measured later, fitted models, by key."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def prepare(self) -> None:
        """Make the folders. Raises UsageError where the folder holds anything else."""
        if self.folder.is_file() or (
            self.folder.exists()
            and any(self.folder.iterdir())
            and not (self.folder / _MARK).exists()
        ):
            raise UsageError(
                f"{self.folder}: not empty and no earlier benchmark: give --out a new folder"
            )
        for name in ("points", "isolated", "instructions", "models"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        (self.folder / _MARK).touch()

    def model_file(self, key: str) -> Path:
        """Where the model of a point is kept."""
        return self.folder / "models" / f"{key}.spm"

    def keep(self, point: Point) -> None:
        """Write a point; its metadata last, so that a point with metadata has its model."""
        if point.model is not None:
            write_file(self.model_file(point.key), point.model)
        self.write("points", point.key, point.metadata)

    def read(self, kind: str, key: str) -> dict[str, Any] | None:
        """Metadata of a key; None where they are not there, or not whole."""
        try:
            metadata: dict[str, Any] = json.loads((self.folder / kind / f"{key}.json").read_text())
        except (OSError, ValueError):
            return None
        return metadata

    def write(self, kind: str, key: str, metadata: dict[str, Any]) -> None:
        """Write metadata of a key."""
        text = json.dumps(metadata, indent=1, allow_nan=False)
        write_file(self.folder / kind / f"{key}.json", text.encode())

    def write_result(self, result: dict[str, Any]) -> None:
        """Write the whole result."""
        write_file(self.folder / RESULT, json.dumps(result, indent=1, allow_nan=False).encode())


def read_result(folder: Path) -> dict[str, Any]:
    """Read the result of a bench folder. Raises DataError where there is none."""
    try:
        result: dict[str, Any] = json.loads((folder / RESULT).read_text())
    except (OSError, ValueError):
        raise DataError(
            f"{folder}: no benchmark: `springpot bench --recording ... --out {folder}` makes one"
        ) from None
    return result


def measured_by(target: Target) -> dict[str, Any]:
    """What measures: the machine, springpot's version and sources, the target.

    Not the target's compiler: what is measured with it is kept apart, or beside its version.
    """
    return {"machine": machine_metadata(), "code": code_hash(), "target": target}


@cache
def code_hash() -> str:
    """SHA-256 of every source that decides a figure: the floors below, and what measures here."""
    root = Path(str(resources.files("springpot.host"))).parent
    files = [
        file
        for room in _MEASURING
        for file in sorted((root / room).rglob("*"))
        if file.is_file() and "__pycache__" not in file.parts and file.name not in _SHOWING
    ]
    digest = hashlib.sha256()
    for file in files:
        content = file.read_bytes()
        name = file.relative_to(root)
        digest.update(f"{name}\n{len(content)}\n".encode() + content)
    return digest.hexdigest()


def data_key(training: Sequence[Recording], validation: Sequence[Recording]) -> str:
    """Hash of all recordings, by name and content."""
    return key_of([[[item.name, item.content_hash] for item in s] for s in (training, validation)])


def point_key(data: str, measures: dict[str, Any], candidate: "Candidate") -> str:
    """Hash of everything that decides a point's figures: recordings, what measures, options."""
    return key_of({"data": data, "measured by": measures, "candidate": candidate.as_dict()})


def key_of(metadata: object) -> str:
    """Hash of JSON values: the name of what is kept for them."""
    return hashlib.sha256(json.dumps(metadata, sort_keys=True).encode()).hexdigest()[:24]
