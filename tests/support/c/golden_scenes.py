"""Scenes that are checked in as they are emitted, so that a change of the C shows in the diff.

smallest_scene: a model written by hand, with nothing around it. proxy_scene: a stored passive model
with all that a hand on a device needs. `cd tests && python -m support.c.golden_scenes` writes them.
"""

import argparse
from pathlib import Path

import numpy as np

from springpot.codegen.emit.files import emit_files
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.features import FirBank
from springpot.codegen.model.model import Model, TrainedRange
from springpot.codegen.model.model_file import read_model
from springpot.codegen.model.regressors import Forest
from springpot.codegen.plan import Plan
from springpot.codegen.scene import Coupling, Guard, Runtime, Scene
from support.c import golden_forces
from support.paths import ROOT, TESTS

FOLDER = TESTS / "golden"


def smallest_model() -> Model:
    """One tree of three leaves on one order, over a window of four samples."""
    return Model(
        kind="rf-fd",
        name="smallest",
        dt_s=1e-3,
        contact="surface",
        trained=TrainedRange(min_m=0.0, max_m=0.01, max_mps=0.1, min_n=0.0, max_n=10.0),
        features=FirBank(orders=(0.5,), taps=np.array([[32.0], [-16.0], [-4.0], [-2.0]])),
        regressor=Forest(
            feature=np.array([0, -1, 0, -1, -1], dtype=np.int32),
            threshold=np.array([0.02, 0.0, 0.07, 0.0, 0.0]),
            left=np.array([1, 0, 3, 0, 0], dtype=np.int32),
            right=np.array([2, 0, 4, 0, 0], dtype=np.int32),
            value_n=np.array([0.0, 1.0, 0.0, 4.0, 10.0]),
            roots=np.array([0], dtype=np.int32),
            weight=1.0,
            bias_n=0.0,
        ),
        hammerstein=None,
        hammerstein_adds=False,
    )


def smallest_scene() -> Plan:
    """Hold beyond the trained depth, no coupling."""
    off, hold = Coupling(mode="off"), Guard(outside="hold")
    scene = Scene(schema=1, name="smallest", model="smallest.spm", coupling=off, guard=hold)
    return make_plan(smallest_model(), scene)


def proxy_scene() -> Plan:
    """The passive model behind a proxy."""
    scene = Scene(schema=1, name="proxy", model="proxy.spm", coupling=Coupling(mode="proxy"))
    return make_plan(golden_forces.model("hammerstein"), scene)


def soft_pad() -> Plan:
    """The pad of examples/soft_pad: a stored silicone, for those who have no Python."""
    model = read_model(FOLDER / "press" / "ecoflex-00-30.spm")
    runtime = Runtime(prefix="soft_pad")
    return make_plan(model, Scene(schema=1, name="pad", model="soft_pad.spm", runtime=runtime))


SCENES = {"smallest_scene": smallest_scene, "proxy_scene": proxy_scene, "soft_pad": soft_pad}


def folder_of(name: str) -> Path:
    """Where a scene is checked in."""
    return ROOT / "examples" / name if name == "soft_pad" else FOLDER / name


def emission(name: str) -> dict[str, str]:
    """Source and header, by file name: of the pad whole, of others what no unit has."""
    files = emit_files(SCENES[name]())
    if name == "soft_pad":
        return {file: text for file, text in files.items() if file.startswith(name)}
    own = files["sp.c"].rindex("constants of this scene")
    selftest = files["sp.c"].index("#ifndef SP_NO_SELFTEST")
    return {"sp.c": files["sp.c"][own:selftest], "sp.h": files["sp.h"]}


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    for scene in SCENES:
        for name, text in emission(scene).items():
            (folder_of(scene) / name).write_text(text)
