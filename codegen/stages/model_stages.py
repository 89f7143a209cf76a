"""The model's part of a plan: its stages, and in the reference their force on a known motion."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Flags, Real, Reals
from springpot.codegen.entry_points import blame_package
from springpot.codegen.errors import UsageError
from springpot.codegen.model.model import Model
from springpot.codegen.scene import Scene
from springpot.codegen.stages import exponentials, expressions, forests, regressors, windows
from springpot.codegen.stages.passive.hammerstein import HammersteinStage, hammerstein_stage
from springpot.codegen.stages.passive.placed import PlaceTicks
from springpot.codegen.stages.stage import (
    FeatureStage,
    RegressorStage,
    SceneTicks,
    Starts,
    feature_stage,
    regressor_stage,
)

# Importing them registers their stages.
REGISTERED = (exponentials, expressions, forests, regressors, windows)


@dataclass(frozen=True)
class RangeConfig:
    """sp_range_config of sp_range.h: the trained depth, m."""

    min_m: Real
    max_m: Real


@dataclass(frozen=True, eq=False)
class Stages:
    """Stages of a model in the scene's number type.

    force = regressor(features) + passive, where there are such, + excess[0] - excess[1]: what the
    passive model adds for the depth beyond the trained one.
    """

    features: FeatureStage | None
    regressor: RegressorStage | None
    passive: HammersteinStage | None
    excess: tuple[HammersteinStage, HammersteinStage] | None


def compute_model_force(
    stages: Stages,
    motion: dict[str, Reals],
    starts: Starts,
    contact: Flags,
    places: PlaceTicks = (),
) -> Reals:
    """Sum the forces of the model's parts along a motion, (n,), N; 0 where there is no contact.

    motion: "penetration" and "clipped", each (n,), m. contact: (n,). places: as in
    `HammersteinStage.reference`.
    """
    zero = motion["clipped"].dtype.type(0)
    terms: list[Reals] = []
    if stages.passive is not None:
        terms.append(stages.passive.reference(motion[stages.passive.follows], starts, places))
    if stages.features is not None and stages.regressor is not None:
        model_n = np.zeros(len(contact), dtype=zero.dtype)
        features = stages.features.reference(motion["clipped"], starts)
        model_n[contact] = stages.regressor.reference(features[contact])
        terms.append(model_n)
    if stages.excess is not None:
        penetration, trained = (
            stage.reference(motion[stage.follows], starts) for stage in stages.excess
        )
        terms.append(penetration - trained)
    force_n = terms[0]
    for term in terms[1:]:
        force_n = force_n + term
    return np.where(contact, force_n, zero)


def clip_depth(config: RangeConfig, depth: Reals) -> tuple[Reals, Flags]:
    """sp_range.h: clipped depth, (n,), m, and where it was outside."""
    above, below = depth > config.max_m, depth < config.min_m
    clipped = np.where(above, config.max_m, np.where(below, config.min_m, depth))
    return clipped.astype(depth.dtype), above | below


def build_stages(model: Model, scene: Scene, ticks: SceneTicks) -> Stages:
    """Turn the model's parts into stages, each with its tables, its C and its reference.

    Beyond the trained depth as `guard.outside` of the scene says.
    """
    uses_fallback = scene.guard.outside == "fallback" and model.hammerstein is not None
    passive, excess = None, None

    def passive_stage(follows: str) -> HammersteinStage:
        assert model.hammerstein is not None
        return hammerstein_stage(model.hammerstein, ticks, follows)

    if model.hammerstein is not None and model.hammerstein_adds:
        passive = passive_stage("penetration" if uses_fallback else "clipped")
    elif model.hammerstein is not None and uses_fallback:
        excess = (passive_stage("penetration"), passive_stage("clipped"))
    if model.features is None or model.regressor is None:
        return Stages(None, None, passive, excess)
    used = model.regressor.used_columns(model.features.n_features)
    with blame_package("the stage of the features", type(model.features), UsageError):
        features = feature_stage(model.features, used, ticks.dt_s, ticks.dtype)
    with blame_package("the stage of the regressor", type(model.regressor), UsageError):
        regressor = regressor_stage(model.regressor, used, scene.runtime, ticks.dtype)
    return Stages(features, regressor, passive, excess)
