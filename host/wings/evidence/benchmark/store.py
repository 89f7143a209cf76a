"""Results of the benchmark on disk: one file a point, written aside and renamed into place."""

import hashlib
import json
from collections.abc import Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from springpot import DataError, Recording, UsageError
from springpot.basics import Target, write_file
from springpot.host.wings.evidence.benchmark.measure import MeasuredPoint
from springpot.host.wings.evidence.benchmark.point import Point, Refused, read_point
from springpot.native import machine_metadata

if TYPE_CHECKING:
    from springpot.host.wings.evidence.sweep import Candidate

RESULT = "bench.json"
_MARK = ".springpot-bench"
_FLOORS = ("runtime_c", "codegen", "trainer", "host")
_BESIDE = ("host/api", "host/commands", "host/wings")  # offer names, call, or are other wings
_MEASURING = tuple(
    f"host/wings/evidence/{name}.py"
    for name in ("benchmark/measure", "benchmark/isolated", "splits")
)
_BOARDS = "host/wings/boards"  # instructions of a tick


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
        """Return where the model of a point is kept."""
        return self.folder / "models" / f"{key}.spm"

    def keep(self, measured: MeasuredPoint) -> None:
        """Write the model before the point, so that every stored point has a model file."""
        if measured.model is not None:
            write_file(self.model_file(measured.point.key), measured.model)
        self.write_point(measured.point)

    def write_point(self, point: Point | Refused) -> None:
        """Write what the sweep found."""
        self.write("points", point.key, point.swept())

    def read_point(self, key: str) -> Point | Refused | None:
        """Return the point of a key; None if it is not there, or not whole."""
        metadata = self.read("points", key)
        return None if metadata is None else read_point(metadata)

    def read(self, kind: str, key: str) -> dict[str, Any] | None:
        """Return metadata of a key; None if they are not there, or not whole."""
        try:
            metadata: dict[str, Any] = json.loads((self.folder / kind / f"{key}.json").read_text())
        except (OSError, ValueError):
            return None
        return metadata

    def write(self, kind: str, key: str, metadata: dict[str, Any]) -> None:
        text = json.dumps(metadata, indent=1, allow_nan=False)
        write_file(self.folder / kind / f"{key}.json", text.encode())

    def write_result(self, result: dict[str, Any]) -> None:
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


def measured_by(code: str, target: Target) -> dict[str, Any]:
    """Return what measures: the machine, the hash of springpot's sources, the target.

    Not the target's compiler: what is measured with it is kept apart, or beside its version.
    """
    return {"machine": machine_metadata(), "code": code, "target": target}


def data_key(training: Sequence[Recording], validation: Sequence[Recording]) -> str:
    """Hash of all recordings, by name and content."""
    return key_of([[[item.name, item.content_hash] for item in s] for s in (training, validation)])


def point_key(data: str, measures: dict[str, Any], candidate: "Candidate") -> str:
    """Hash of everything that decides a point's figures: recordings, what measures, options."""
    return key_of({"data": data, "measured by": measures, "candidate": candidate.as_dict()})


def key_of(metadata: object) -> str:
    """Hash of JSON values: the name of what is kept for them."""
    return hashlib.sha256(json.dumps(metadata, sort_keys=True).encode()).hexdigest()[:24]


@cache
def code_hash(root: Path | None = None) -> str:
    """Return SHA-256 of all floors without commands and wings, and of what measures here.

    root: of the package; default: the installed one.
    """
    root = root or Path(str(resources.files("springpot.host"))).parent
    files = {*(root / name for name in _MEASURING), *(root / _BOARDS).glob("*.py")}
    for floor in _FLOORS:
        files |= {file for file in (root / floor).rglob("*") if file.is_file()
                  and "__pycache__" not in file.parts
                  and not file.relative_to(root).as_posix().startswith(_BESIDE)}  # fmt: skip
    digest = hashlib.sha256()
    for file in sorted(files):
        content = file.read_bytes()
        digest.update(f"{file.relative_to(root)}\n{len(content)}\n".encode() + content)
    return digest.hexdigest()
