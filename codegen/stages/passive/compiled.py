"""The passive model along a motion by its C in double: the bits of `PassiveMotion`."""

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.native.c_library import CLibrary, load_c
from springpot.codegen.stages.passive.motion import PassiveMotion
from springpot.codegen.types import CData, Scalar
from springpot.runtime_c.paths import PORT_FIT, SOURCE

if TYPE_CHECKING:
    from springpot.codegen.stages.passive.hammerstein import HammersteinStage


@cache
def fit_library() -> CLibrary:
    """Load the C of a fit. Raises NoCompilerError with what to install where nothing compiles."""
    file = PORT_FIT / "sp_fit.c"
    return load_c([file], [file], "double", folders=[SOURCE])


class CompiledMotion(PassiveMotion):
    """State of one passive model in float64, with the tool at u, from its stage's start on."""

    _tables: CData

    def along(self, u: Reals) -> tuple[Reals, Reals]:
        """Return force, (n,), N, and depth of the surface, (n,), with the tool at u, (n,)."""
        library, force_n, model_u = fit_library(), np.empty_like(u), np.empty_like(u)
        arrays = {
            "before": self._before.copy(),
            "held": np.concatenate(self._branch_state),
            "play": self._play.copy(),
            "flow_before": self._functions.copy(),
            "flow": self._flow.copy(),
            "deepest": self._deepest.copy(),
            "values": np.empty(len(self._before) + len(self._deepest)),
        }
        where = {"u": float(self._u), "force_n": float(self._force_n)}
        state = library.struct("sp_fit_state", {**arrays, **where})
        ticks = map(library.array, (np.ascontiguousarray(u), force_n, model_u))
        library.c.sp_fit_motion(self._tables, state, len(u), *ticks)
        self._before, self._play, self._functions = (
            arrays[name] for name in ("before", "play", "flow_before")
        )
        self._flow, self._deepest = arrays["flow"], arrays["deepest"]
        firsts = [step.first for step in self._stage.steps[1:]]
        self._branch_state = np.split(arrays["held"], firsts)
        self._u, self._force_n = state.u, state.force_n
        return force_n, model_u

    def _set_stage(self, stage: "HammersteinStage", u: Scalar) -> None:
        super()._set_stage(stage, u)
        self._tables = build_tables(stage)


def build_tables(stage: "HammersteinStage") -> CData:
    """Build the C struct of a passive model, in float64, for the C of a fit (sp_fit.c)."""
    library, config, none = fit_library(), stage.config, np.zeros(0)
    flow, damage, surface = stage.flow, stage.damage, stage.surface
    loss = {step.by_depth: step.loss for step in stage.steps}
    values = {
        "bias_n": float(config.bias_n),
        "n_intervals": config.n_intervals,
        "n_branches": config.n_branches,
        "n_stops": config.n_stops,
        "n_constant": len(loss.get(False, none)),
        "spring": stage.spring,
        "branches": stage.branches,
        "loss": loss.get(False, none),
        "depth_loss": loss.get(True, none),
        "stops": stage.stops,
        "radius": stage.radius,
        "n_cubic": flow.n_cubic if flow else 0,
        "n_flow": flow.count if flow else 0,
        "flow_loss": flow.loss if flow else none,
        "flow_n": flow.force_n if flow else none,
        "flow_function": flow.function if flow else np.zeros(0, np.uint8),
        "n_linear": damage.n_linear if damage else 0,
        "n_damage": damage.count if damage else 0,
        "damage": damage.curves if damage else none,
        "healed": damage.healed if damage else none,
        "max_slope_n": surface.max_slope_n if surface else library.ffi.NULL,
    }
    return library.struct("sp_fit_model", values)
