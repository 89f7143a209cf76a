"""The model's part of the reference: its force on a motion that is known."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Real, Reals
from springpot.codegen.stages.hammerstein import HammersteinStage
from springpot.codegen.stages.stage import FeatureStage, RegressorStage, Starts


@dataclass(frozen=True)
class RangeConfig:
    """sp_range.h."""

    least_m: Real
    greatest_m: Real


class Stages(Protocol):
    """A plan, or its model's stages."""

    @property
    def features(self) -> FeatureStage | None:
        """Of the regressor."""

    @property
    def regressor(self) -> RegressorStage | None:
        """Features to force."""

    @property
    def passive(self) -> HammersteinStage | None:
        """The passive part that the model adds."""

    @property
    def excess(self) -> tuple[HammersteinStage, HammersteinStage] | None:
        """The passive fallback, at the depth as it is and at the trained one."""


def model_force(
    stages: Stages,
    motion: dict[str, Reals],
    starts: Starts,
    contact: NDArray[np.bool_],
) -> Reals:
    """Force of the model's stages, N; 0 where there is no contact. motion: "deep" and "depth"."""
    zero = motion["depth"].dtype.type(0)
    terms: list[Reals] = []
    if stages.passive is not None:
        terms.append(stages.passive.reference(motion[stages.passive.follows], starts))
    if stages.features is not None and stages.regressor is not None:
        model_n = np.zeros(len(contact), dtype=zero.dtype)
        features = stages.features.reference(motion["depth"], starts)
        model_n[contact] = stages.regressor.reference(features[contact])
        terms.append(model_n)
    if stages.excess is not None:
        deep, trained = (stage.reference(motion[stage.follows], starts) for stage in stages.excess)
        terms.append(deep - trained)
    force_n = terms[0]
    for term in terms[1:]:
        force_n = force_n + term
    return np.where(contact, force_n, zero)


def clip(config: RangeConfig, depth: Reals) -> tuple[Reals, NDArray[np.bool_]]:
    """sp_range.h: clipped depth, and where it was outside."""
    deep, shallow = depth > config.greatest_m, depth < config.least_m
    clipped = np.where(deep, config.greatest_m, np.where(shallow, config.least_m, depth))
    return clipped.astype(depth.dtype), deep | shallow
