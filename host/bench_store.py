"""Results of the benchmark on disk: one file a point, written aside and renamed into place."""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from springpot.host.bench_point import Point
from springpot.host.machine import machine_facts
from springpot.runtime_c.errors import DataError, UsageError
from springpot.trainer.recording import Recording

if TYPE_CHECKING:
    from springpot.trainer.sweep import Candidate

RESULT = "bench.json"
_MARK = ".springpot-bench"


class Store:
    """A bench folder: `points` and `alone` hold JSON, `models` the fitted models, by key."""

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
        for name in ("points", "alone", "models"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        (self.folder / _MARK).touch()

    def model_file(self, key: str) -> Path:
        """Where the model of a point is kept."""
        return self.folder / "models" / f"{key}.spm"

    def keep(self, point: Point) -> None:
        """Write a point; its facts last, so that a point with facts has its model."""
        if point.model is not None:
            _write(self.model_file(point.key), point.model)
        self.write("points", point.key, point.facts)

    def read(self, kind: str, key: str) -> dict[str, Any] | None:
        """Facts of a key; None where they are not there, or not whole."""
        try:
            facts: dict[str, Any] = json.loads((self.folder / kind / f"{key}.json").read_text())
        except (OSError, ValueError):
            return None
        return facts

    def write(self, kind: str, key: str, facts: dict[str, Any]) -> None:
        """Write facts of a key."""
        text = json.dumps(facts, indent=1, allow_nan=False)
        _write(self.folder / kind / f"{key}.json", text.encode())

    def write_result(self, result: dict[str, Any]) -> None:
        """Write the whole result."""
        _write(self.folder / RESULT, json.dumps(result, indent=1, allow_nan=False).encode())


def read_result(folder: Path) -> dict[str, Any]:
    """Read the result of a bench folder. Raises DataError where there is none."""
    try:
        result: dict[str, Any] = json.loads((folder / RESULT).read_text())
    except (OSError, ValueError):
        raise DataError(
            f"{folder}: no benchmark: `springpot bench --recording ... --out {folder}` makes one"
        ) from None
    return result


def sweep_base(
    training: Sequence[Recording], validation: Sequence[Recording], target: str
) -> dict[str, Any]:
    """What all points of a sweep share and what decides their figures: data, machine, versions."""
    return {
        "training": [recording.content_hash for recording in training],
        "validation": [recording.content_hash for recording in validation],
        "target": target,
        "machine": machine_facts(),
    }


def point_key(base: dict[str, Any], candidate: "Candidate") -> str:
    """Hash of everything that decides a point's figures."""
    text = json.dumps({"base": base, "candidate": candidate.as_dict()}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def _write(path: Path, content: bytes) -> None:
    aside = path.with_name(path.name + ".part")
    aside.write_bytes(content)
    aside.replace(path)
