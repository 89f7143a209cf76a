"""A model of the same object, so many times stiffer: its position scale divided by a factor."""

from dataclasses import replace

from springpot.codegen.model.ir import (
    Features,
    FirBank,
    Hammerstein,
    Lags,
    Model,
    PositionVelocity,
    Rbf,
    RecursiveBank,
    Regressor,
)


def stiffer(model: Model, factor: float) -> Model:
    """Model whose force at x is that of `model` at factor x, at any motion.

    A power of two keeps every decision of a forest exactly; other factors move ties by rounding.
    """
    trained = model.trained
    scaled = replace(
        trained,
        least_m=trained.least_m / factor,
        greatest_m=trained.greatest_m / factor,
        greatest_mps=trained.greatest_mps / factor,
    )
    passive = model.hammerstein
    return replace(
        model,
        trained=scaled,
        features=_features(model.features, factor),
        regressor=_regressor(model.features, model.regressor, factor),
        hammerstein=_hammerstein(passive, factor) if passive is not None else None,
        provenance={**model.provenance, "stiffer": factor},
    )


def _features(features: Features | None, factor: float) -> Features | None:
    """Linear filters take the factor in; the others leave it to the regressor."""
    if isinstance(features, FirBank):
        return replace(features, taps=features.taps * factor)
    if isinstance(features, RecursiveBank):
        return replace(features, weights=features.weights * factor)
    if isinstance(features, PositionVelocity):
        return replace(features, band_m=features.band_m / factor)
    return features


def _regressor(
    features: Features | None, regressor: Regressor | None, factor: float
) -> Regressor | None:
    if not isinstance(features, Lags | PositionVelocity) or regressor is None:
        return regressor
    if isinstance(regressor, Rbf):
        return replace(
            regressor,
            mean=regressor.mean / factor,
            scale=regressor.scale / factor,
            least=regressor.least / factor,
            greatest=regressor.greatest / factor,
        )
    return replace(regressor, threshold=regressor.threshold / factor)


def _hammerstein(passive: Hammerstein, factor: float) -> Hammerstein:
    return replace(
        passive,
        origin_m=passive.origin_m / factor,
        span_m=passive.span_m / factor,
        radius_m=passive.radius_m / factor,
    )
