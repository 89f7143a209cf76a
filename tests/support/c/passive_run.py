"""A passive model through the units of its C, without an emission: in double, any model."""

from functools import cache
from typing import Any

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.stages.passive.hammerstein import HammersteinStage, hammerstein_stage
from springpot.codegen.stages.stage import SceneTicks
from springpot.host.native.c_library import CLibrary, declarations
from springpot.host.native.compiler import shared_library
from springpot.runtime_c.paths import INCLUDE, SOURCE
from support.paths import TESTS

_HERE = TESTS / "support" / "c"


@cache
def _library() -> CLibrary:
    folders = [_HERE, SOURCE, INCLUDE, INCLUDE / "double"]
    built = shared_library([_HERE / "passive_run.c"], folders)
    return CLibrary(built, declarations([_HERE / "passive_run.h"]))


class PassiveC:
    """One model at one time step. surface: the object has one."""

    def __init__(self, model: Hammerstein, dt_s: float, surface: bool) -> None:
        stage = hammerstein_stage(model, SceneTicks(dt_s, surface=surface), "penetration")
        self._kept: list[Any] = []
        self._model = _library().ffi.new("passive_model *", self._tables(stage))

    def force_n(self, depth_m: Samples) -> Samples:
        """Force of each tick, (n,), N, from rest at the first depth."""
        depth_m, force_n = np.ascontiguousarray(depth_m), np.empty(len(depth_m))
        given, found = map(_library().array, (depth_m, force_n))
        assert _library().c.passive_run(self._model, len(depth_m), given, found) == 0
        return force_n

    def _tables(self, stage: HammersteinStage) -> dict[str, Any]:
        assert not any(step.double for step in stage.steps)
        config = vars(stage.config)
        loss = {False: np.zeros(0), True: np.zeros(0)}
        loss |= {step.by_depth: step.loss for step in stage.steps}
        flow, damage, surface = stage.flow, stage.damage, stage.surface
        arrays = {
            "spring": stage.spring, "branches": stage.branches, "stops": stage.stops,
            "radius": stage.radius, "loss": loss[False], "depth_loss": loss[True],
            "flow_loss": flow.loss if flow else np.zeros(0),
            "flow_n": flow.force_n if flow else np.zeros(0),
            "damage": damage.curves if damage else np.zeros(0),
            "healed": damage.healed if damage else np.zeros(0),
            "stiffest": surface.max_slope_n if surface else np.zeros(0),
        }  # fmt: skip
        function = flow.function if flow else np.zeros(0, dtype=np.uint8)
        return {
            **{name: int(value) if name.startswith("n_") else float(value)
               for name, value in config.items()},
            "n_constant": len(loss[False]),
            "n_cubic": flow.n_cubic if flow else 0, "n_flow": flow.count if flow else 0,
            "n_linear": damage.n_linear if damage else 0,
            "n_damage": damage.count if damage else 0,
            "recovers": surface is not None, "pulls": stage.pulls,
            **{name: self._array(values) for name, values in arrays.items()},
            "flow_function": self._array(function),
        }  # fmt: skip

    def _array(self, values: Any) -> Any:
        flat = np.ascontiguousarray(values).ravel()
        flat = flat if len(flat) else np.zeros(1, dtype=flat.dtype)
        c_type = "uint8_t[]" if flat.dtype == np.uint8 else "double[]"
        self._kept.append(_library().ffi.from_buffer(c_type, flat))  # which keeps the array
        return self._kept[-1]
