"""The model: all that the trainer hands on, and all that the C can need. Plain arrays, SI units."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.model.features import Features
from springpot.codegen.model.regressors import Regressor

Contact = Literal["surface", "always"]
Basis = Literal["powers", "ramps"]
BASIS_SIZE: dict[Basis, int] = {"powers": 3, "ramps": 8}  # functions of each


@dataclass(frozen=True, eq=False)
class Hammerstein:
    """Non-negative sum of Maxwell branches and stop operators on a monotone basis of the depth.

    u = (x - origin_m)/span_m, basis b(u) of J functions: powers u, u^2, u^3, or eight ramps that
    saturate at the next one's start (the last one does not). With g = weights @ b(u):
    force = bias_n + g_elastic + sum of highpass_tau(g_branch) + sum of g_stop(u) - g_stop(play u).
    elastic_n: (J,). tau_s: (P,), branch_n: (P, J). radius_m: (K,), stop_n: (K, J). Weights >= 0.
    n_by_depth: of the last branches, which relax at the rate rate_ratio^(1/2 - u)/tau: rate_ratio
    is that at the surface over that at the trained depth. stretch: where it is c > 0, b is a
    function of v = (u + expm1(c u)/expm1(c))/2 (formulas.py), for an object that stiffens
    steeply; radii are shares of v then.
    """

    basis: Basis
    origin_m: float
    span_m: float
    elastic_n: NDArray[np.float64]
    tau_s: NDArray[np.float64]
    branch_n: NDArray[np.float64]
    radius_m: NDArray[np.float64]
    stop_n: NDArray[np.float64]
    bias_n: float
    n_by_depth: int = 0
    rate_ratio: float = 1.0
    stretch: float = 0.0

    @property
    def by_depth(self) -> NDArray[np.bool_]:
        """Whether each branch's rate depends on the depth, (P,)."""
        return np.arange(len(self.tau_s)) >= len(self.tau_s) - self.n_by_depth

    @property
    def slowest_s(self) -> NDArray[np.float64]:
        """Longest time constant of each branch at any depth, (P,), s."""
        slower = np.sqrt(max(self.rate_ratio, 1.0 / self.rate_ratio))
        slowest_s: NDArray[np.float64] = self.tau_s * np.where(self.by_depth, slower, 1.0)
        return slowest_s

    @property
    def memory_s(self) -> float:
        """Longest time constant, s."""
        return float(self.slowest_s.max(initial=0.0))

    def stiffened(self, factor: float) -> "Hammerstein":
        """The passive model whose force at x is this one's at factor x."""
        return replace(
            self,
            origin_m=self.origin_m / factor,
            span_m=self.span_m / factor,
            radius_m=self.radius_m / factor,
        )


@dataclass(frozen=True)
class TrainedRange:
    """Extremes of the training recordings: what the guard needs to know."""

    min_m: float
    max_m: float
    max_mps: float
    min_n: float
    max_n: float


@dataclass(frozen=True, eq=False)
class Model:
    """One fitted model: force = regressor(features), hammerstein, or their sum.

    kind: its name in the table of kinds ("rf-fd", ...).
    contact: "surface" where the recordings contain the contact, "always" where they never leave
    the object.
    hammerstein_adds: whether its force is part of the model's; else it is the fallback outside the
    trained depth.
    provenance: seed, rows, hashes of the training recordings, versions; JSON values.
    """

    kind: str
    name: str
    dt_s: float
    contact: Contact
    trained: TrainedRange
    features: Features | None
    regressor: Regressor | None
    hammerstein: Hammerstein | None
    hammerstein_adds: bool
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @property
    def exact_at_any_rate(self) -> bool:
        """Whether its features are the true ones at any sampling rate."""
        return self.features is None or self.features.exact_at_any_rate

    @property
    def engine(self) -> str:
        """How its history is filtered: "fir", "fir-fast" or "recursive"."""
        return "recursive" if self.features is None else self.features.engine

    @property
    def orders(self) -> tuple[float, ...]:
        """Fractional orders of its features."""
        return () if self.features is None else self.features.fractional_orders

    @property
    def memory_s(self) -> float:
        """How far back it remembers, s."""
        own = 0.0 if self.features is None else self.features.memory_s(self.dt_s)
        adds = self.hammerstein is not None and self.hammerstein_adds
        return max(own, self.hammerstein.memory_s if adds and self.hammerstein else 0.0)

    def stiffened(self, factor: float) -> "Model":
        """The model of an object so many times stiffer: its force at x is this one's at factor x.

        A power of two keeps every decision of a forest exactly; other factors move ties by
        rounding.
        """
        trained = self.trained
        features, scale = (None, 1.0) if self.features is None else self.features.stiffened(factor)
        return replace(
            self,
            trained=replace(
                trained,
                min_m=trained.min_m / factor,
                max_m=trained.max_m / factor,
                max_mps=trained.max_mps / factor,
            ),
            features=features,
            regressor=self.regressor and self.regressor.on_scaled(scale),
            hammerstein=self.hammerstein and self.hammerstein.stiffened(factor),
            provenance={**self.provenance, "stiffened": factor},
        )
