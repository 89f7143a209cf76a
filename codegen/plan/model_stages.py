"""The model's part of a plan: which stages it needs, and the orders that no split uses."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.forest.compact import compact_forest
from springpot.codegen.forest.leaves import used_features
from springpot.codegen.forest.wide import forest_table
from springpot.codegen.model.ir import (
    FastFirBank,
    Features,
    FirBank,
    Forest,
    FractionalBank,
    Lags,
    Model,
    PositionVelocity,
    RecursiveBank,
    Rounding,
)
from springpot.codegen.scene import Scene
from springpot.codegen.stages.fast_fir import fast_fir_stage
from springpot.codegen.stages.fir import fir_stage
from springpot.codegen.stages.forest import (
    CompactForestStage,
    ForestStage,
    IfsStage,
    WideForestStage,
)
from springpot.codegen.stages.hammerstein import HammersteinStage, hammerstein_stage
from springpot.codegen.stages.lags import lags_stage
from springpot.codegen.stages.position_velocity import PositionVelocityStage, velocity_stage
from springpot.codegen.stages.rbf import rbf_stage
from springpot.codegen.stages.recursive import recursive_stage
from springpot.codegen.stages.stage import LANES, FeatureStage, RegressorStage, padded

Columns = NDArray[np.intp]


@dataclass(frozen=True)
class LeftOut:
    """One thing that the scene does not need; bytes: tables and state saved, code apart."""

    what: str
    why: str
    bytes: int


@dataclass(frozen=True, eq=False)
class ModelStages:
    """Stages of the model in the scene's number type.

    force = regressor(features) + passive, where there are such, + excess[0] - excess[1]: what the
    passive model adds for the depth beyond the trained one.
    """

    features: FeatureStage | None
    regressor: RegressorStage | None
    passive: HammersteinStage | None
    excess: tuple[HammersteinStage, HammersteinStage] | None
    left_out: tuple[LeftOut, ...]


def model_stages(model: Model, scene: Scene, dt_s: float, dtype: type[Any]) -> ModelStages:
    """Resolve the model's part; outside the trained depth as the scene says."""
    falls_back = scene.guard.outside == "fallback" and model.hammerstein is not None
    passive, excess = None, None
    if model.hammerstein is not None and model.hammerstein_adds:
        follows = "deep" if falls_back else "depth"
        passive = hammerstein_stage(model.hammerstein, dt_s, dtype, follows, lanes_of(scene))
    elif model.hammerstein is not None and falls_back:
        deep, trained = (
            hammerstein_stage(model.hammerstein, dt_s, dtype, follows, lanes_of(scene))
            for follows in ("deep", "depth")
        )
        excess = (deep, trained)
    if model.features is None or model.regressor is None:
        return ModelStages(None, None, passive, excess, ())
    kept = used_columns(model)
    features = _feature_stage(model.features, kept, dt_s, dtype)
    regressor = _regressor_stage(model, scene, kept, dtype)
    left_out = _dropped(model.features, kept, dtype)
    return ModelStages(features, regressor, passive, excess, tuple(left_out))


def used_columns(model: Model) -> Columns:
    """Columns of the model's features that its regressor reads."""
    if isinstance(model.regressor, Forest):
        used = used_features(model.regressor).astype(np.intp)
        return used if len(used) else np.zeros(1, dtype=np.intp)  # trees without a split
    return np.arange(feature_count(model.features))


def feature_count(features: Features | None) -> int:
    """Number of features."""
    if isinstance(features, FractionalBank):
        return len(features.orders)
    return len(features.samples) if isinstance(features, Lags) else 2


def lanes_of(scene: Scene) -> int:
    """Numbers that tables are padded to whole vectors of; 1 where the target has no vectors."""
    return LANES if scene.runtime.target == "host" else 1


def _feature_stage(
    features: Features, kept: Columns, dt_s: float, dtype: type[Any]
) -> FeatureStage:
    if isinstance(features, FirBank):
        return fir_stage(features, kept, dtype)
    if isinstance(features, FastFirBank):
        return fast_fir_stage(features, kept, dtype)
    if isinstance(features, RecursiveBank):
        return recursive_stage(features, kept, dt_s, dtype)
    if isinstance(features, Lags):
        return lags_stage(features, kept)
    assert isinstance(features, PositionVelocity)
    return PositionVelocityStage(velocity_stage(features, dt_s, dtype, "depth"))


def _regressor_stage(model: Model, scene: Scene, kept: Columns, dtype: type[Any]) -> RegressorStage:
    if isinstance(model.regressor, Forest):
        return _forest_stage(model.regressor, scene, kept, dtype)
    assert model.regressor is not None
    return rbf_stage(model.regressor, dtype)


def _forest_stage(forest: Forest, scene: Scene, kept: Columns, dtype: type[Any]) -> ForestStage:
    """Nodes of 4 bytes where they do, 8 where not; nested ifs where the scene asks for them."""
    rounding = None
    if forest.rounding is not None:
        rounding = Rounding(forest.rounding.least[kept], forest.rounding.per_step[kept])
    if scene.runtime.forest == "m2cgen":
        return IfsStage(forest_table(forest, dtype), len(kept), rounding, forest)
    compact = compact_forest(forest, dtype)
    if compact is None:
        return WideForestStage(forest_table(forest, dtype), len(kept), rounding)
    return CompactForestStage(compact, len(kept), rounding, vectors=lanes_of(scene) > 1)


def _dropped(features: Features, kept: Columns, dtype: type[Any]) -> list[LeftOut]:
    if not isinstance(features, FractionalBank):
        return []
    unused = [order for i, order in enumerate(features.orders) if i not in set(kept.tolist())]
    if not unused:
        return []
    rows = len(features.taps if isinstance(features, FirBank) else features.weights)
    lanes = padded(len(features.orders)) - padded(max(len(kept), 1))
    names = ", ".join(f"{order:g}" for order in unused)
    saved = lanes * rows * np.dtype(dtype).itemsize
    return [LeftOut(f"orders {names}", "no split uses them", saved)]
