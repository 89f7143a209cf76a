"""The folder of a study: everything frozen that people will be shown, and what they answered."""

import hashlib
import json
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from springpot.codegen.atomic_write import folder_written_aside, write_file
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.model.model_file import read_model, write_model
from springpot.host.emission.emission import MODEL_COPY, SCENE_COPY, emit, read_emission
from springpot.host.emission.scene_file import model_path, read_scene, scene_from_json
from springpot.host.study.codes import Key, read_key, write_key
from springpot.host.study.definition import Stimulus, Study, read_study

DEFINITION, FROZEN, KEY, PARTICIPANTS = "study.toml", "study.json", "key.json", "participants.tsv"
MAX_PARTICIPANTS = 999


@dataclass(frozen=True)
class FrozenScene:
    """An emitted scene of the study. folder: in the study's. max_mps: trained speed.

    device: what its [device] says.
    """

    folder: str
    hash: str
    rate_hz: float
    number: str
    max_depth_m: float
    max_mps: float
    max_force_n: float
    watchdog_s: float
    device: dict[str, Any]


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
        """Opens the blinding."""
        return read_key(self.path / KEY)

    def scene_folder(self, stimulus: Stimulus) -> Path | None:
        """Its emission; None of a real object."""
        scene = self.scenes.get(stimulus.name)
        return None if scene is None else self.path / scene.folder

    def number(self, participant: str) -> int:
        """From 1. Raises UsageError for none of the study's."""
        if participant not in self.participants:
            raise UsageError(
                f"{self.path}: no participant {participant!r}: the plan has "
                f"{self.participants[0]} to {self.participants[-1]}"
            )
        return self.participants.index(participant) + 1

    def session_folder(self, participant: str, session: int) -> Path:
        """Where a session lies; 0 is practice."""
        return self.path / f"sub-{participant}" / f"ses-{session}"

    @property
    def deepest_m(self) -> float | None:
        """The deepest that any stimulus may be pressed; None: unknown of all."""
        depths_m = [self.max_depth_m(stimulus) for stimulus in self.study.stimulus]
        warned_m = 1e-3 * (self.study.limits.warn_depth_mm or 0.0)
        return max(warned_m, *(depth_m or 0.0 for depth_m in depths_m)) or None

    def max_depth_m(self, stimulus: Stimulus) -> float | None:
        """How deep it may be pressed, where that is known."""
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
        scenes = _emitted(study, file.parent, aside, progress)
        _freeze(aside, study, participants, scenes)
    return read_folder(out)


def copy_study(of: StudyFolder, participants: int, out: Path) -> StudyFolder:
    """The same study for others: its scenes as they are, a key of its own. Raises UsageError."""
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
    """Of the definition, the scenes and the participants."""
    kept = json.dumps({name: value for name, value in frozen.items() if name != "hash"})
    return hashlib.sha256((folder / DEFINITION).read_bytes() + kept.encode()).hexdigest()


def _emitted(
    study: Study, beside: Path, folder: Path, progress: Callable[[int, int], None]
) -> dict[int, FrozenScene]:
    """Emit every scene; folders have numbers for names."""
    found: dict[int, FrozenScene] = {}
    of = [k for k, stimulus in enumerate(study.stimulus) if stimulus.scene is not None]
    for done, k in enumerate(of):
        progress(done, len(of))
        name = f"scenes/{k + 1:02d}"
        emit_stimulus(study.stimulus[k], beside, folder / name)
        found[k] = _frozen(folder, name, study.stimulus[k].name)
    _require_alike(study, found)
    return found


def emit_stimulus(stimulus: Stimulus, beside: Path, out: Path) -> None:
    """Emit a stimulus that is a scene; its path starts at the study file's folder."""
    assert stimulus.scene is not None
    source = beside / stimulus.scene
    out.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        read_emission(source)
        if stimulus.stiffer == 1:
            shutil.copytree(source, out)
            return
        scene = scene_from_json((source / SCENE_COPY).read_text(), str(source))
        model_file = source / MODEL_COPY
    else:
        scene = read_scene(source)
        model_file = model_path(scene, source)
    if stimulus.stiffer == 1:
        emit(scene, model_file, out)
        return
    with tempfile.TemporaryDirectory(prefix="springpot-study-") as scratch:
        stiffened = Path(scratch) / "model.spm"
        write_model(stiffened, read_model(model_file).stiffened(stimulus.stiffer))
        emit(scene, stiffened, out)


def _frozen(folder: Path, name: str, title: str) -> FrozenScene:
    emitted = read_emission(folder / name)
    plan = emitted.plan
    if not plan.contact:
        raise UsageError(
            f"stimulus {title!r}: its model never leaves the object, and scenes are changed above "
            "the surface: train it on recordings that begin there, or set guard.contact"
        )
    return FrozenScene(
        folder=name,
        hash=emitted.hash,
        rate_hz=1 / plan.dt_s,
        number=plan.scene.runtime.number,
        max_depth_m=float(plan.model.trained.max_m),
        max_mps=float(plan.model.trained.max_mps),
        max_force_n=max(float(plan.output.max_n), -float(plan.output.min_n)),
        watchdog_s=plan.watchdog_s,
        device=asdict(plan.scene.device),
    )


def _require_alike(study: Study, scenes: Mapping[int, FrozenScene]) -> None:
    """All scenes run in one loop: at one rate, in one number type."""
    for what, of in (
        ("rates", lambda scene: f"{scene.rate_hz:g} Hz"),
        ("number types", lambda scene: scene.number),
        ("devices", lambda scene: json.dumps(scene.device)),
    ):
        kinds = {of(scene): study.stimulus[k].name for k, scene in scenes.items()}
        if len(kinds) > 1:
            named = ", ".join(f"{kind} ({name})" for kind, name in kinds.items())
            raise UsageError(
                f"scenes of different {what}: {named}: they share one loop, and people could feel "
                "it; give all scenes the same [runtime] and [device]"
            )
