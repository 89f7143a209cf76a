"""The paper's study, ready to be planned: its file beside the scenes of the models made here."""

import shutil
from collections.abc import Iterable
from importlib.resources import as_file, files
from pathlib import Path

from springpot import Scene, write_scene
from springpot.host.wings.evidence.paper.reproduce import PAPER_KINDS
from springpot.simulation import OBJECTS

STUDY = "study.toml"


def write_study_files(out: Path, models: Path, names: Iterable[str]) -> list[Path]:
    """Write a scene for each of the paper's models, and the study where all five objects are there.

    models: where `<object>/<kind>.spm` lie. Returns what was written.
    """
    out.mkdir(exist_ok=True)
    written = []
    for name in names:
        for kind in PAPER_KINDS:
            if not (models / name / f"{kind}.spm").exists():
                continue
            model = f"{name}-{kind}.spm"
            shutil.copyfile(models / name / f"{kind}.spm", out / model)
            file = out / f"{name}-{kind}.toml"
            write_scene(file, Scene(schema=1, name=f"{name} {kind}", model=model))
            written.append(file)
    if set(OBJECTS) <= {*names}:
        with as_file(files("springpot.host") / "scenes" / "paper-study.toml") as shipped:
            shutil.copyfile(shipped, out / STUDY)
        written.append(out / STUDY)
    return written
