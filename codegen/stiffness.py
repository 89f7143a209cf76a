"""Greatest tangent stiffness of a model, from its reference."""

from typing import Any

import numpy as np

from springpot.codegen.configs import RangeConfig
from springpot.codegen.ir import Model
from springpot.codegen.plan_model import ModelStages
from springpot.codegen.reference_model import clip, model_force

STEP = 0.05  # of the trained depth: longer than a leaf of a forest, shorter than a press
REACH = 1.3  # of the trained depth: the fallback counts too
_SPEEDS = (1.0, 0.25, 0.0625)  # of the greatest trained one
_MOST_TICKS = 200


def greatest_stiffness_npm(
    stages: ModelStages, model: Model, trained: RangeConfig, dtype: type[Any]
) -> float:
    """Steepest secant over 5 % of the depth, pressed from rest at any depth, N/m."""
    base_m = float(trained.least_m)
    span_m = float(trained.greatest_m) - base_m
    starts_m = base_m + span_m * np.arange(0.0, REACH, STEP)
    found = 0.0
    for share in _SPEEDS:
        ticks = 1 + max(1, round(STEP * span_m / (share * model.trained.greatest_mps * model.dt_s)))
        ticks = min(ticks, _MOST_TICKS)
        rise_m = STEP * span_m * np.linspace(0.0, 1.0, ticks)
        motion = (starts_m[:, None] + rise_m).astype(dtype)
        deep = motion.ravel()
        motions = {"deep": deep, "depth": clip(trained, deep)[0]}
        starts = np.arange(0, len(deep), ticks)
        force_n = model_force(stages, motions, starts, np.ones(len(deep), dtype=bool))
        force_n = force_n.reshape(motion.shape).astype(np.float64)
        found = max(found, float((force_n[:, -1] - force_n[:, 0]).max()) / (STEP * span_m))
    return found
