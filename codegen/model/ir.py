"""Model IR: all that the trainer hands on, and all that the C can need. Plain arrays, SI units."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Contact = Literal["surface", "always"]
Basis = Literal["powers", "ramps"]


@dataclass(frozen=True, eq=False)
class FirBank:
    """Features: fractional derivatives by a finite window.

    orders: fractional order of each feature, in [0, 1].
    taps: shape (length, orders), newest sample first, float64; feature = taps.T @ window, m/s^r.
    """

    orders: tuple[float, ...]
    taps: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FastFirBank:
    """Features: a FirBank's, by a few direct taps and exponentials that all orders share.

    orders: as in FirBank. tau_ticks: shape (poles,), decay of each pole in samples.
    length: of the window, samples. weights: (direct + poles + 1, orders) of the newest rises of the
    position, of each pole's state (older rises, decaying, forgotten at the window's end), and of
    the window's oldest sample.
    """

    orders: tuple[float, ...]
    tau_ticks: NDArray[np.float64]
    length: int
    weights: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RecursiveBank:
    """Features: fractional derivatives by exponentials that all orders share.

    A pole's state h follows h' = x' - h/tau, with x linear within a step. feature = h @ weights.
    orders: as in FirBank. tau_s: shape (poles,). weights: (poles, orders), s^-r.
    """

    orders: tuple[float, ...]
    tau_s: NDArray[np.float64]
    weights: NDArray[np.float64]


@dataclass(frozen=True)
class Lags:
    """Features: the position and past positions.

    samples: lags, ascending, the first one 0. difference: past ones enter as x(t) - x(t - lag).
    """

    samples: tuple[int, ...]
    difference: bool


@dataclass(frozen=True)
class PositionVelocity:
    """Features: position (m) and velocity (m/s) by first-order adaptive windowing.

    length: greatest number of steps of the window. band_m: noise band.
    """

    length: int
    band_m: float


FractionalBank = FirBank | FastFirBank | RecursiveBank
Features = FractionalBank | Lags | PositionVelocity


@dataclass(frozen=True, eq=False)
class Rounding:
    """Features in whole steps: floor((x - least) per_step + 1/2), within 0 .. 65535.

    least, per_step: shape (features,), of all features that the bank has.
    """

    least: NDArray[np.float64]
    per_step: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Forest:
    """Weighted sum of binary trees in one node table; left where float32(x) <= threshold.

    feature: shape (nodes,), int32, column of the split; -1 marks a leaf.
    threshold: (nodes,), float64, in the feature's unit.
    left, right: (nodes,), int32, children's rows; of leaves, without meaning.
    value_n: (nodes,), float64, force of a leaf.
    roots: (trees,), int32, each tree's first row.
    weight, bias_n: force = bias_n + weight x sum of the leaves (weight 1/trees for a mean).
    rounding: where the trees were fitted on features in whole steps; thresholds are in steps then.
    """

    feature: NDArray[np.int32]
    threshold: NDArray[np.float64]
    left: NDArray[np.int32]
    right: NDArray[np.int32]
    value_n: NDArray[np.float64]
    roots: NDArray[np.int32]
    weight: float
    bias_n: float
    rounding: Rounding | None = None


@dataclass(frozen=True, eq=False)
class Rbf:
    """Cubic radial basis functions with a linear tail, on standardised features.

    z = (clip(feature, least, greatest) - mean) / scale, each of shape (features,).
    force = weights_n @ |z - centers|^3 + tail_n[0] + tail_n[1:] @ z; centers (n, features).
    """

    mean: NDArray[np.float64]
    scale: NDArray[np.float64]
    least: NDArray[np.float64]
    greatest: NDArray[np.float64]
    centers: NDArray[np.float64]
    weights_n: NDArray[np.float64]
    tail_n: NDArray[np.float64]


Regressor = Forest | Rbf


@dataclass(frozen=True, eq=False)
class Hammerstein:
    """Non-negative sum of Maxwell branches and stop operators on a monotone basis of the depth.

    u = (x - origin_m)/span_m, basis b(u) of J functions: powers u, u^2, u^3, or eight ramps that
    saturate at the next one's start (the last one does not). With g = weights @ b(u):
    force = bias_n + g_elastic + sum of highpass_tau(g_branch) + sum of g_stop(u) - g_stop(play u).
    elastic_n: (J,). tau_s: (P,), branch_n: (P, J). radius_m: (K,), stop_n: (K, J). Weights >= 0.
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


@dataclass(frozen=True)
class TrainedRange:
    """Extremes of the training recordings: what the guard needs to know."""

    least_m: float
    greatest_m: float
    greatest_mps: float
    least_n: float
    greatest_n: float


@dataclass(frozen=True, eq=False)
class Model:
    """One fitted model: force = regressor(features), hammerstein, or their sum.

    kind: its name in the list of models ("rf-fd", ...).
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
