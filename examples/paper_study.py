"""Make and check the scenes of the paper's study (section VI) from recordings of its objects.

    python examples/paper_study.py recordings --out scenes
    springpot study plan scenes/study.toml --participants 18 --out study

Below the folder of recordings each object has a folder, named as the scenes of paper_study.toml
begin, with `training` (protocol paper) and `validation` (protocol validation): see
docs/how-to/study.md. A scene's sections, such as [device], are those of the file --scene; without
it springpot chooses the coupling: with the paper's own a light hand finds all fifteen unstable.
"""

import argparse
import re
import shutil
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from paper_results import LETTER

import springpot

HERE = Path(__file__).parent
PLAIN = 'schema = 1\nname = ""\nmodel = ""\n'
STUDY = tomllib.loads((HERE / "paper_study.toml").read_text("utf-8"))


def scenes() -> Iterator[tuple[str, str, str]]:
    """Name of an object, kind of model, and file of the scene, of every scene of the study."""
    for material in STUDY["material"]:
        for method, file in material["scenes"].items():
            kind = method.lower()
            yield file.removesuffix(f"-{kind}.toml"), kind, file


def made(recordings: Path, out: Path, scene: str, **work: int) -> Iterator[str]:
    """Write models, scenes and study.toml; yield what a check found of each scene.

    scene: text of a scene file, of which name and model are replaced. work: of the training.
    """
    for name, kind, file in scenes():
        folder, place = recordings / name, out / file
        given = springpot.read_recordings(folder / "training")
        tests = springpot.read_recordings(folder / "validation")
        validation = tests if kind == "rbf-fd" else ()
        options = {**LETTER[kind], **work}
        fit = springpot.train(given, kind, place.stem, validation, smooth_s=0.025, **options)
        springpot.write_model(place.with_suffix(".spm"), fit)
        named = re.sub(r"(?m)^name *=.*$", f'name = "{place.stem}"', scene, count=1)
        text = re.sub(r"(?m)^model *=.*$", f'model = "{place.stem}.spm"', named, count=1)
        place.write_text(text, encoding="utf-8")
        yield f"{file}: {checked(place, tests)}"
    shutil.copyfile(HERE / "paper_study.toml", out / "study.toml")


def checked(scene: Path, tests: list[springpot.Recording]) -> str:
    """Emit a scene as `springpot study plan` will; its error, its bits, what the loop does."""
    folder = scene.with_suffix("")
    try:
        springpot.emit(folder, scene=scene)
    except springpot.SpringpotError as error:
        return f"REFUSED: {error}"
    found = [springpot.validate(folder, one, paced_s=0.1) for one in tests]
    rmse_n = np.mean([one.accuracy.rmse_n for one in found])
    differs = sum(one.mismatches for one in found)
    return f"{rmse_n:.3f} N of error, {differs} ticks differ, stable in every hand"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recordings", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--scene", type=Path)
    asked = parser.parse_args()
    try:
        asked.out.mkdir(parents=True)
        refused = 0
        scene = asked.scene.read_text("utf-8") if asked.scene else PLAIN
        for line in made(asked.recordings, asked.out, scene):
            print(line, flush=True)
            refused += "REFUSED" in line
    except (springpot.SpringpotError, OSError) as error:
        sys.exit(f"paper_study: {error}")
    sys.exit(bool(refused))
