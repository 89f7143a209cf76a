"""The scenes of a study, emitted once when it is planned: all of them for one loop."""

import json
import shutil
import tempfile
import warnings
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from springpot import UsageError, emit, read_model, read_scene, write_model
from springpot.emission import MODEL_COPY, SCENE_COPY, model_path, read_emission, scene_from_json
from springpot.host.wings.study.definition import Stimulus, Study


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


def emit_scenes(
    study: Study, beside: Path, folder: Path, progress: Callable[[int, int], None]
) -> dict[int, FrozenScene]:
    """Emit every scene; folders have numbers for names."""
    found: dict[int, FrozenScene] = {}
    of = [k for k, stimulus in enumerate(study.stimulus) if stimulus.scene is not None]
    for done, k in enumerate(of):
        progress(done, len(of))
        name = f"scenes/{k + 1:02d}"
        with warnings.catch_warnings(record=True) as doubts:
            warnings.simplefilter("always")
            _emit_stimulus(study.stimulus[k], beside, folder / name)
        for doubt in doubts:
            warnings.warn(f"stimulus {study.stimulus[k].name!r}: {doubt.message}", stacklevel=2)
        found[k] = _frozen(folder, name, study.stimulus[k].name)
    _require_alike(study, found)
    _warn_of_twins(study, {k: folder / scene.folder for k, scene in found.items()})
    return found


def _warn_of_twins(study: Study, folders: Mapping[int, Path]) -> None:
    """Warn of two stimuli with the same forces along the motion of their self-tests."""
    seen: dict[str, str] = {}
    for k, folder in folders.items():
        name = study.stimulus[k].name
        for golden in folder.glob("*_golden.h"):
            twin = seen.setdefault(golden.read_text(), name)
            if twin != name:
                warnings.warn(
                    f"stimuli {twin!r} and {name!r} have the same forces: people would compare an "
                    "object with itself",
                    stacklevel=3,
                )


def _emit_stimulus(stimulus: Stimulus, beside: Path, out: Path) -> None:
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
        emit(out, model=model_file, scene=scene)
        return
    with tempfile.TemporaryDirectory(prefix="springpot-study-") as scratch:
        stiffened = Path(scratch) / "model.spm"
        write_model(stiffened, read_model(model_file).stiffened(stimulus.stiffer))
        emit(out, model=stiffened, scene=scene)


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
        max_force_n=plan.max_force_n,
        watchdog_s=plan.watchdog_s,
        device=asdict(plan.scene.device),
    )


def _require_alike(study: Study, scenes: Mapping[int, FrozenScene]) -> None:
    """Raise UsageError unless all scenes fit one loop: one rate, one number type."""
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
