"""Small studies for tests: of scenes whose models are kept, and of real objects alone."""

import json
import shutil
from pathlib import Path
from typing import Any

from springpot.codegen.scene import Scene
from springpot.host.emission.scene_file import write_scene
from springpot.host.wings.study.folder import StudyFolder, read_folder, write_study
from support.paths import ROOT

MODELS = ROOT / "tests" / "golden" / "press"
SOFT, HARD = "ecoflex-00-30", "dragon-skin-10"


def study_text(method: str, stimuli: list[dict[str, Any]], pairs: list[dict[str, Any]],
               **keys: Any) -> str:  # fmt: skip
    """A study file; `sections` among the keys: name -> keys of a section, or a list of them."""
    sections = {"stimulus": stimuli, "pair": pairs, **keys.pop("sections", {})}
    top = {"schema": 1, "name": "a small study", "method": method, **keys}
    lines = [f"{name} = {_toml(value)}" for name, value in top.items()]
    for name, section in sections.items():
        for one in section if isinstance(section, list) else [section]:
            lines.append(f"[[{name}]]" if isinstance(section, list) else f"[{name}]")
            lines += [f"{key} = {_toml(value)}" for key, value in one.items()]
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(one)}" for key, one in value.items()) + " }"
    return json.dumps(value)


def write_scenes(folder: Path, *names: str) -> None:
    """Scene files NAME.toml with their models, in a folder."""
    for name in names:
        shutil.copyfile(MODELS / f"{name}.spm", folder / f"{name}.spm")
        write_scene(folder / f"{name}.toml", Scene(schema=1, name=name, model=f"{name}.spm"))


def planned(folder: Path, text: str, participants: int = 2, *scenes: str) -> StudyFolder:
    """Plan a study in a folder."""
    write_scenes(folder, *scenes)
    (folder / "study.toml").write_text(text)
    write_study(folder / "study.toml", participants, folder / "plan", lambda _done, _of: None)
    return read_folder(folder / "plan")


def scene_stimulus(name: str, scene: str = SOFT, **keys: Any) -> dict[str, Any]:
    """A stimulus that is a scene."""
    return {"name": name, "scene": f"{scene}.toml", **keys}


def real_stimulus(name: str, simulated: str = SOFT) -> dict[str, Any]:
    """A real object, with what stands for it."""
    return {"name": name, "real": f"{name} on the tray", "simulated": f"sim://{simulated}"}


def real_study(pairs: int = 3, **keys: Any) -> str:
    """A similarity study of real objects alone: it needs no device, and no compiler."""
    stimuli = [real_stimulus(f"object {k}") for k in range(pairs + 1)]
    compared = [{"left": "object 0", "right": f"object {k + 1}"} for k in range(pairs)]
    return study_text("similarity", stimuli, compared, **keys)


def steps_study(method: str, *factors: float, **keys: Any) -> str:
    """Steps of stiffness above one standard scene, for psychometric methods."""
    stimuli = [scene_stimulus("standard")]
    stimuli += [scene_stimulus(f"times {factor:g}", stiffer=factor) for factor in factors]
    pairs = [{"left": "standard", "right": f"times {factor:g}"} for factor in factors]
    return study_text(method, stimuli, pairs, **keys)
