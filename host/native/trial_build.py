"""Scenes built for a look at them: in a folder of their own, not emitted to the user."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from springpot.codegen.emit.files import emit_files
from springpot.codegen.make_plan import make_plan
from springpot.codegen.plan import Plan
from springpot.host.native.scene_library import SceneLibrary


@contextmanager
def built(plan: Plan) -> Iterator[SceneLibrary]:
    """The plan's C, built and loaded."""
    with written(plan) as folder:
        yield SceneLibrary(folder)


@contextmanager
def written(plan: Plan) -> Iterator[Path]:
    """The folder of the plan's C."""
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        for name, text in emit_files(plan).items():
            (Path(scratch) / name).write_text(text)
        yield Path(scratch)


def uncoupled(plan: Plan) -> Plan:
    """The model by itself: coupling and smoothing off, all else as in the scene."""
    if plan.couple is None and plan.smooth_alpha is None:
        return plan
    scene = plan.scene
    return make_plan(
        plan.model,
        replace(
            scene,
            coupling=replace(scene.coupling, mode="off"),
            smoothing=replace(scene.smoothing, time_constant_s=0.0),
        ),
    )
