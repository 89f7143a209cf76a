"""List what a scene leaves out of its C because it does not need it."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.model.model import Model
from springpot.codegen.scene import Scene
from springpot.codegen.stages.stage import SceneTicks, padded
from springpot.codegen.types import RealType


@dataclass(frozen=True)
class LeftOut:
    """One thing that the scene does not need; bytes: tables and state saved, code apart."""

    what: str
    why: str
    bytes: int


def unused_orders(model: Model, dtype: RealType) -> list[LeftOut]:
    """List the fractional orders that no split uses."""
    if model.features is None or model.regressor is None:
        return []
    features = model.features
    kept = model.regressor.used_columns(features.n_features)
    orders = features.fractional_orders
    unused = [order for i, order in enumerate(orders) if i not in set(kept.tolist())]
    if not unused:
        return []
    vector_width = padded(len(orders)) - padded(max(len(kept), 1))
    names = ", ".join(f"{order:g}" for order in unused)
    saved = vector_width * features.table_rows * np.dtype(dtype).itemsize
    return [LeftOut(f"orders {names}", "no split uses them", saved)]


def units_left_out(
    scene: Scene, ticks: SceneTicks, coupled: bool, estimates: bool, alpha: float | None
) -> list[LeftOut]:
    """List the units of the runtime that the scene does without."""
    size = np.dtype(ticks.dtype).itemsize
    needless = "the device gives it" if coupled else "nothing in this scene needs a velocity"
    found = (
        (ticks.surface, "contact and onset", "the recordings never leave the object", size),
        # stiffness, damping, compliance, dt, phi; proxy's position, velocity, flag
        (coupled, "coupling", "coupling.mode is off", 8 * size + 2 * size + 4),
        (estimates, "velocity estimate", needless, 4 * size),
        (alpha is not None, "smoothing", "smoothing.time_constant_s is 0", 2 * size),
    )
    return [LeftOut(what, why, saved) for kept, what, why, saved in found if not kept]
