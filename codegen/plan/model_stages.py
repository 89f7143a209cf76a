"""The model's part of a plan: which stages it needs."""

from springpot.codegen.entry_points import blaming
from springpot.codegen.errors import UsageError
from springpot.codegen.model.model import Model
from springpot.codegen.scene import Scene
from springpot.codegen.stages import (
    fast_fir,
    fir,
    forest,
    lags,
    position_velocity,
    rbf,
    recursive,
)
from springpot.codegen.stages.model_force import Stages
from springpot.codegen.stages.passive.from_model import hammerstein_stage
from springpot.codegen.stages.passive.hammerstein import HammersteinStage
from springpot.codegen.stages.stage import SceneTicks, feature_stage, regressor_stage

# Importing them registers their stages.
REGISTERED = (fast_fir, fir, forest, lags, position_velocity, rbf, recursive)


def model_stages(model: Model, scene: Scene, ticks: SceneTicks) -> Stages:
    """Resolve the model's part; beyond the trained depth as `guard.outside` of the scene says."""
    falls_back = scene.guard.outside == "fallback" and model.hammerstein is not None
    passive, excess = None, None

    def along(follows: str) -> HammersteinStage:
        assert model.hammerstein is not None
        return hammerstein_stage(model.hammerstein, ticks, follows)

    if model.hammerstein is not None and model.hammerstein_adds:
        passive = along("penetration" if falls_back else "clipped")
    elif model.hammerstein is not None and falls_back:
        excess = (along("penetration"), along("clipped"))
    if model.features is None or model.regressor is None:
        return Stages(None, None, passive, excess)
    kept = model.regressor.used_columns(model.features.n_features)
    with blaming("the stage of the features", type(model.features), UsageError):
        features = feature_stage(model.features, kept, ticks.dt_s, ticks.dtype)
    with blaming("the stage of the regressor", type(model.regressor), UsageError):
        regressor = regressor_stage(model.regressor, kept, scene.runtime, ticks.dtype)
    return Stages(features, regressor, passive, excess)
