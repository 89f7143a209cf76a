"""The folder of a study: everything frozen that people will be shown, and what they answered."""

import hashlib
import json
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from springpot import DataError, UsageError
from springpot.basics import folder_written_aside, write_file
from springpot.host.wings.study.codes import Key, read_key, write_key
from springpot.host.wings.study.definition import Stimulus, Study
from springpot.host.wings.study.frozen_scenes import FrozenScene, emit_scenes
from springpot.host.wings.study.study_file import read_study

DEFINITION, FROZEN, KEY, PARTICIPANTS = "study.toml", "study.json", "key.json", "participants.tsv"
OBSERVERS = "observers.json"  # of a simulated study: who they are, and so what it should find


@dataclass(frozen=True, eq=False)
class StudyFolder:
    """A planned study, read back. scenes: stimulus name -> scene; participants: "01", "02", ..."""

    path: Path
    study: Study
    hash: str
    participants: tuple[str, ...]
    scenes: Mapping[str, FrozenScene]

    @property
    def key(self) -> Key:
        """The key, read from its file: it opens the blinding."""
        return read_key(self.path / KEY)

    def number(self, participant: str) -> int:
        """Return a participant's number, from 1. Raises UsageError if the study has no such one."""
        if participant not in self.participants:
            raise UsageError(
                f"{self.path}: no participant {participant!r}: the plan has "
                f"{self.participants[0]} to {self.participants[-1]}"
            )
        return self.participants.index(participant) + 1

    def session_folder(self, participant: str, session: int) -> Path:
        """Return where a session lies; 0 is practice."""
        return self.path / f"sub-{participant}" / f"ses-{session}"

    @property
    def dt_s(self) -> float:
        """Period of the loop that all scenes share, s; 1 ms without a scene."""
        return next((1 / scene.rate_hz for scene in self.scenes.values()), 1e-3)

    @property
    def real(self) -> str:
        """Type of the scenes' numbers in C."""
        numbers = {scene.number for scene in self.scenes.values()}
        return "double" if "float64" in numbers else "float"

    @property
    def simulated(self) -> bool:
        """Whether its people were made up by `springpot study simulate`."""
        return (self.path / OBSERVERS).exists()

    @property
    def deepest_m(self) -> float | None:
        """The deepest that any stimulus may be pressed; None: unknown of all."""
        depths_m = [self.max_depth_m(stimulus) for stimulus in self.study.stimulus]
        warned_m = 1e-3 * (self.study.limits.warn_depth_mm or 0.0)
        return max(warned_m, *(depth_m or 0.0 for depth_m in depths_m)) or None

    def max_depth_m(self, stimulus: Stimulus) -> float | None:
        """Return how deep it may be pressed, where that is known."""
        if stimulus.max_depth_mm is not None:
            return 1e-3 * stimulus.max_depth_mm
        scene = self.scenes.get(stimulus.name)
        return None if scene is None else scene.max_depth_m


def write_study(
    file: Path, participants: int, out: Path, progress: Callable[[int, int], None]
) -> StudyFolder:
    """Freeze a study file: emit its scenes, draw the key, write it all as a new folder.

    progress: takes how many scenes of how many are emitted. Raises UsageError where the folder is
    there already or the study cannot be run, and whatever an emission raises.
    """
    study = read_study(file)
    with _new_folder(out) as aside:
        shutil.copyfile(file, aside / DEFINITION)
        scenes = emit_scenes(study, file.parent, aside, progress)
        _freeze(aside, study, participants, scenes)
    return read_folder(out)


def copy_study(of: StudyFolder, participants: int, out: Path) -> StudyFolder:
    """Copy a study for others: the same scenes, a key of its own. Raises UsageError."""
    with _new_folder(out) as aside:
        shutil.copyfile(of.path / DEFINITION, aside / DEFINITION)
        if of.scenes:
            shutil.copytree(of.path / "scenes", aside / "scenes")
        names = [stimulus.name for stimulus in of.study.stimulus]
        scenes = {names.index(name): scene for name, scene in of.scenes.items()}
        _freeze(aside, of.study, participants, scenes)
    return read_folder(out)


@contextmanager
def _new_folder(out: Path) -> Iterator[Path]:
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise UsageError(f"{out}: exists: a planned study is never overwritten; give a new --out")
    out.parent.mkdir(parents=True, exist_ok=True)
    with folder_written_aside(out) as aside:
        aside.mkdir()
        yield aside


def _freeze(
    folder: Path, study: Study, participants: int, scenes: Mapping[int, FrozenScene]
) -> None:
    numbers = [f"{k:0{max(2, len(str(participants)))}d}" for k in range(1, participants + 1)]
    frozen = {
        "schema": 1,
        "springpot": version("springpot"),
        "participants": numbers,
        "scenes": {str(k): vars(scene) for k, scene in scenes.items()},
    }
    frozen["hash"] = _hash(frozen, folder)
    write_file(folder / FROZEN, (json.dumps(frozen, indent=1) + "\n").encode())
    write_key(folder / KEY, study, numbers)
    header = "participant_id\tage\tsex\thandedness\n"
    rows = "".join(f"sub-{number}\tn/a\tn/a\tn/a\n" for number in numbers)
    write_file(folder / PARTICIPANTS, (header + rows).encode())


def read_folder(path: Path) -> StudyFolder:
    """Read a planned study. Raises DataError where it is none, or was changed since."""
    try:
        frozen = json.loads((path / FROZEN).read_text())
        participants = tuple(frozen["participants"])
        scenes = {int(k): FrozenScene(**scene) for k, scene in frozen["scenes"].items()}
    except (OSError, ValueError, KeyError, TypeError):
        raise DataError(f"{path}: no planned study: `springpot study plan` makes one") from None
    if _hash(frozen, path) != frozen["hash"]:
        raise DataError(
            f"{path / DEFINITION}: changed since the study was planned: take the first one back, "
            "or plan anew into another folder"
        )
    study = read_study(path / DEFINITION)
    by_name = {study.stimulus[k].name: scene for k, scene in scenes.items()}
    return StudyFolder(path, study, frozen["hash"], participants, by_name)


def _hash(frozen: Mapping[str, Any], folder: Path) -> str:
    """Hash the definition, the scenes and the participants."""
    kept = json.dumps({name: value for name, value in frozen.items() if name != "hash"})
    return hashlib.sha256((folder / DEFINITION).read_bytes() + kept.encode()).hexdigest()
