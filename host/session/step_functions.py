"""What a loop calls each tick: a scene, or force control while recording."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from springpot.host.native.c_library import CLibrary
from springpot.host.native.loop_library import loop_library
from springpot.host.native.scene_library import SceneLibrary


@dataclass(frozen=True)
class StepFunctions:
    """Addresses of the three functions and of the state that a loop calls; library: its C."""

    library: CLibrary
    step: int
    idle: int
    reset: int
    state: int
    measured_n: int = 0  # where the state wants the measured force, or 0
    kept: Any = field(default=None, repr=False)  # owners of the memory behind the addresses


def scene_step_functions(scene: SceneLibrary) -> StepFunctions:
    """A fresh state of a scene."""
    state = scene.new_state()
    step, idle, reset = (scene.address(name) for name in ("step", "idle", "reset"))
    library = loop_library("float" if scene.dtype is np.float32 else "double")
    return StepFunctions(library, step, idle, reset, state.address, kept=(scene, state))
