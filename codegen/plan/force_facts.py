"""Facts of a model's force that hold for every motion: extremes and steps of a forest.

The passive part is smooth: what one step of the position adds is its stiffness times that step. A
forest's leaf is left for another one at once. Leaves here are not yet rounded to the scene's number
type, and a step is of exactly one resolution.
"""

from functools import singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.model.forest_extremes import forest_extremes, forest_step
from springpot.codegen.model.regressors import Forest, Regressor
from springpot.codegen.plan.plan import Plan


def force_facts(plan: Plan) -> dict[str, Any]:
    """For the manifest; empty where no regressor has facts."""
    regressor = plan.model.regressor
    if regressor is None or plan.features is None:
        return {}
    resolution_m = 1e-6 * plan.scene.device.resolution_um
    return regressor_facts(regressor, plan, resolution_m)


@singledispatch
def regressor_facts(regressor: Regressor, plan: Plan, resolution_m: float) -> dict[str, Any]:
    """Facts of a regressor's force; a kind of one's own may register some."""
    return {}


@regressor_facts.register
def _(regressor: Forest, plan: Plan, resolution_m: float) -> dict[str, Any]:
    change = resolution_m * _newest_share(plan, regressor)
    smallest, largest = forest_extremes(regressor, len(change))
    step = forest_step(regressor, change)
    facts = {
        "min_n": smallest.force_n,
        "max_n": largest.force_n,
        "exact": smallest.exact and largest.exact,
        "resolution_m": resolution_m,
        "step_n": None if step is None else step.force_n,
        "step_exact": step is not None and step.exact,
    }
    return {"forest": facts}


def _newest_share(plan: Plan, forest: Forest) -> NDArray[np.float64]:
    """Change of every feature with the newest position, (features,), in the feature's unit/m."""
    assert plan.features is not None and plan.model.features is not None
    columns = forest.used_columns(plan.model.features.n_features)
    before_m = np.zeros(2, dtype=plan.dtype)
    after_m = before_m.copy()
    after_m[1] = 1.0
    start = np.zeros(1, dtype=np.intp)
    change = plan.features.reference(after_m, start) - plan.features.reference(before_m, start)
    found = np.zeros(plan.model.features.n_features)
    found[columns] = change[1]
    return found
