"""The smallest scene: a model written by hand. Run this file to write its emission again."""

import numpy as np

from springpot.codegen.emit.files import emit_files
from springpot.codegen.model.features import FirBank
from springpot.codegen.model.model import Model, TrainedRange
from springpot.codegen.model.regressors import Forest
from springpot.codegen.plan.plan import make_plan
from springpot.codegen.scene import Coupling, Guard, Scene
from support.paths import TESTS

FOLDER = TESTS / "golden" / "smallest_scene"


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


def smallest_emission() -> dict[str, str]:
    """Texts of what is generated for it (not the units, which are copies), by name."""
    scene = Scene(
        schema=1,
        name="smallest",
        model="smallest.spm",
        coupling=Coupling(mode="off"),
        guard=Guard(outside="hold"),
    )
    files = emit_files(make_plan(smallest_model(), scene))
    return {
        name: text
        for name, text in files.items()
        if text.startswith(("/* springpot 0", "# springpot 0")) and name != "sp_golden.h"
    }


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for old in FOLDER.iterdir():
        old.unlink()
    for name, text in smallest_emission().items():
        (FOLDER / name).write_text(text)
