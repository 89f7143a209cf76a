"""Model IR: all that the trainer hands on, and all that the C can need. Plain arrays, SI units."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Contact = Literal["surface", "always"]


@dataclass(frozen=True, eq=False)
class FirBank:
    """Features: fractional derivatives by a finite window.

    orders: fractional order of each feature, in [0, 1].
    taps: shape (length, orders), newest sample first, float64; feature = taps.T @ window, m/s^r.
    """

    orders: tuple[float, ...]
    taps: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Forest:
    """Mean of binary trees in one node table; sample i goes left where float32(x) <= threshold.

    feature: shape (nodes,), int32, column of the split; -1 marks a leaf.
    threshold: (nodes,), float64, in the feature's unit.
    left, right: (nodes,), int32, children's rows; of leaves, without meaning.
    value_n: (nodes,), float64, force of a leaf.
    roots: (trees,), int32, each tree's first row.
    """

    feature: NDArray[np.int32]
    threshold: NDArray[np.float64]
    left: NDArray[np.int32]
    right: NDArray[np.int32]
    value_n: NDArray[np.float64]
    roots: NDArray[np.int32]


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
    """One fitted model.

    kind: its name in the list of models ("rf-fd", ...).
    contact: "surface" where the recordings contain the contact, "always" where they never leave
    the object.
    provenance: seed, rows, hashes of the training recordings, versions; JSON values.
    """

    kind: str
    name: str
    dt_s: float
    contact: Contact
    trained: TrainedRange
    features: FirBank
    regressor: Forest
    provenance: Mapping[str, Any] = field(default_factory=dict)
