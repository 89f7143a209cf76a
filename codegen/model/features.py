"""Kinds of features along a depth: what each stores, and what others ask of it.

A kind of one's own is a frozen dataclass of this base, with a stage that is registered with
`feature_stage` (codegen/stages/stage.py) and float64 values registered with `feature_values`
(trainer/features.py).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from math import log, log1p
from typing import Any, ClassVar, Self

from springpot.codegen.arrays import Indices, Samples, require, require_positive, require_shape
from springpot.codegen.messages import short_repr


class Features(ABC):
    """Features of the depth x(t), m, that a regressor maps to a force.

    >>> Features.exact_at_any_rate  # by default they hold at the recordings' rate alone
    False
    """

    engine: ClassVar[str] = "fir"  # how history is stored: samples ("fir") or poles ("recursive")
    exact_at_any_rate: ClassVar[bool] = False

    @property
    @abstractmethod
    def n_features(self) -> int:
        """Count the features."""

    @property
    def fractional_orders(self) -> tuple[float, ...]:
        """Order of each feature that is a fractional derivative."""
        return ()

    @property
    def table_rows(self) -> int:
        """Numbers that are stored for each feature."""
        return 0

    @abstractmethod
    def memory_s(self, dt_s: float) -> float:
        """Return how far back the features remember, s."""

    def settling_s(self, dt_s: float) -> float:
        """Time after which what came before is forgotten to 2 %, s."""
        return self.memory_s(dt_s)

    @abstractmethod
    def stiffened(self, factor: float) -> tuple[Self, float]:
        """Features f' and a scale s with s f'(x) = f(factor x) for every motion x."""

    def take(self, columns: Indices) -> Self:
        """Only these features. Raises NotImplementedError where they cannot stand alone."""
        raise NotImplementedError

    def require_valid(self) -> None:  # noqa: B027 (no rules)
        """Raise DataError, with field and reason, for what their types cannot tell."""


@dataclass(frozen=True, eq=False)
class FractionalBank(Features):
    """Fractional derivatives of several orders, linear in the depth.

    orders: fractional order of each feature, in [0, 1]. `table` names the field with a column for
    each order.
    """

    orders: tuple[float, ...]

    table: ClassVar[str] = "weights"
    __repr__ = short_repr

    @property
    def n_features(self) -> int:
        return len(self.orders)

    @property
    def fractional_orders(self) -> tuple[float, ...]:
        return self.orders

    @property
    def table_rows(self) -> int:
        return len(getattr(self, self.table))

    def stiffened(self, factor: float) -> tuple[Self, float]:
        return self._with_table(getattr(self, self.table) * factor), 1.0

    def take(self, columns: Indices) -> Self:
        chosen = self._with_table(getattr(self, self.table)[:, columns])
        return replace(chosen, orders=tuple(self.orders[i] for i in columns))

    def require_valid(self) -> None:
        fits = len(self.orders) > 0 and all(0.0 <= r <= 1.0 for r in self.orders)
        require(fits, f"orders: {self.orders[:12]} are not within 0 .. 1")
        require_shape(self.table, getattr(self, self.table), (self.table_rows, len(self.orders)))

    def _with_table(self, values: Samples) -> Self:
        changes: dict[str, Any] = {self.table: values}
        return replace(self, **changes)


@dataclass(frozen=True, eq=False)
class FirBank(FractionalBank):
    """By a finite window (equation 16).

    taps: shape (length, orders), newest sample first, float64; feature = taps.T @ window, m/s^r.
    """

    taps: Samples
    __repr__ = short_repr

    table = "taps"

    def memory_s(self, dt_s: float) -> float:
        return len(self.taps) * dt_s


@dataclass(frozen=True, eq=False)
class FastFirBank(FractionalBank):
    """A FirBank's window, by a few direct taps and exponentials that all orders share.

    tau_ticks: shape (poles,), decay of each pole in samples. length: of the window, samples.
    weights: (direct + poles + 1, orders) of the newest rises of the position, of each pole's state
    (older rises, decaying, forgotten at the window's end), and of the window's oldest sample.
    """

    tau_ticks: Samples
    length: int
    weights: Samples

    engine = "fir-fast"

    def require_valid(self) -> None:
        super().require_valid()
        require_positive("tau_ticks", self.tau_ticks, (len(self.tau_ticks),))
        direct = len(self.weights) - len(self.tau_ticks) - 1
        require(direct >= 1, f"weights: {len(self.weights)} rows for {len(self.tau_ticks)} poles")
        require(direct + 1 < self.length, f"length: {self.length} samples")

    def memory_s(self, dt_s: float) -> float:
        return self.length * dt_s


@dataclass(frozen=True, eq=False)
class RecursiveBank(FractionalBank):
    """By exponentials that all orders share.

    A pole's state h follows h' = x' - h/tau, with x linear within a step. feature = h @ weights.
    tau_s: shape (poles,). weights: (poles, orders), s^-r.
    """

    tau_s: Samples
    weights: Samples

    engine = "recursive"
    exact_at_any_rate = True

    def require_valid(self) -> None:
        super().require_valid()
        require_positive("tau_s", self.tau_s, (len(self.weights),))

    def memory_s(self, dt_s: float) -> float:
        return float(self.tau_s.max())

    def settling_s(self, dt_s: float) -> float:
        return 4.0 * self.memory_s(dt_s)


@dataclass(frozen=True)
class Lags(Features):
    """The position and past positions. samples: lags, ascending, the first one 0."""

    samples: tuple[int, ...]

    @property
    def n_features(self) -> int:
        return len(self.samples)

    def memory_s(self, dt_s: float) -> float:
        return max(self.samples) * dt_s

    def require_valid(self) -> None:
        lags = sorted({int(lag) for lag in self.samples})
        fits = [*self.samples] == lags and lags[:1] == [0] and lags[-1] < 2**32
        require(fits, f"samples: {self.samples[:12]} are no whole lags that ascend from 0")

    def stiffened(self, factor: float) -> tuple["Lags", float]:
        return self, factor


@dataclass(frozen=True)
class PositionVelocity(Features):
    """Position (m) and velocity (m/s) by first-order adaptive windowing.

    length: maximum number of steps of the window. band_m: noise band. weight: of the newest
    velocity in an exponential moving average; 1: none.
    """

    length: int
    band_m: float
    weight: float = 1.0

    @property
    def n_features(self) -> int:
        return 2

    def memory_s(self, dt_s: float) -> float:
        return self.length * dt_s

    def settling_s(self, dt_s: float) -> float:
        averaged = 0.0 if self.weight == 1.0 else log(0.02) / log1p(-self.weight)
        return self.memory_s(dt_s) + averaged * dt_s

    def require_valid(self) -> None:
        require(0.0 < self.weight <= 1.0, f"weight: {self.weight} is not within 0 .. 1")
        require(self.length >= 1, f"length: {self.length} steps")
        require(self.band_m >= 0.0, f"band_m: {self.band_m} m is negative")

    def stiffened(self, factor: float) -> tuple["PositionVelocity", float]:
        return replace(self, band_m=self.band_m / factor), factor
