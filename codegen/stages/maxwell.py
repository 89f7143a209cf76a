"""Maxwell branches of the passive model: who steps which of them, and how.

Of constant rate, or of one that depends on the depth (sp_depth.h); in double where a float would
stop moving.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.literals import array_text
from springpot.codegen.model.model import Hammerstein
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.depth_laws import depth_curve, loss_by_depth, rates_by_depth
from springpot.codegen.stages.recursive import SLOW_TICKS, loss_and_gain
from springpot.codegen.stages.stage import padded

Place = tuple[NDArray[np.intp], Reals]  # piece and way of each tick's depth, both (n,)


@dataclass(frozen=True, eq=False)
class MaxwellBranches(ABC):
    """Neighbouring branches that are stepped alike.

    first: column of the first one. double: whether their states are. loss: last axis (count,).
    """

    first: int
    double: bool
    loss: Reals

    @property
    def count(self) -> int:
        """Branches, those of curve 0 that fill a vector too."""
        return int(self.loss.shape[-1])

    @property
    @abstractmethod
    def by_depth(self) -> bool:
        """Whether a tick needs the place of the depth (sp_depth.h)."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Prefix of the C's tables and states."""

    @property
    @abstractmethod
    def headers(self) -> tuple[str, ...]:
        """Of a tick."""

    @property
    @abstractmethod
    def measured_headers(self) -> tuple[str, ...]:
        """Of a measured time step."""

    @abstractmethod
    def tables(self) -> list[str]:
        """Constants of a tick."""

    @abstractmethod
    def measured_tables(self) -> tuple[str, ...]:
        """Constants of a measured time step."""

    @abstractmethod
    def step(self, follows: str) -> list[str]:
        """Lines of a tick, after `{follows}_branch` is known."""

    @abstractmethod
    def measured_step(self, follows: str) -> list[str]:
        """Lines of a measured time step, `dt_s`."""

    @abstractmethod
    def reference(self, rises: Reals, place: Place) -> Callable[[int, Reals], Reals]:
        """Step of the states (count,) at tick i; rises (n, count) in the states' type."""

    def instructions(self, costs: Costs) -> float:
        """Bound of a tick's."""
        return self.count * (costs.branch + (costs.slow_pole if self.double else 0.0))

    def _call(self, function: str, constants: str, settings: str, follows: str) -> list[str]:
        at = f" + {self.first}" if self.first else ""
        states = [f"{follows}_branch{at}", f"state->{follows}_before{at}"]
        states += [f"state->{follows}_{self.name}"] if self.double else []
        states += [f"state->{follows}_held{at}"]
        return [f"{function}({constants}, {settings},", f"    {', '.join(states)});"]


@dataclass(frozen=True, eq=False)
class ConstantRate(MaxwellBranches):
    """loss: (count,). per_tau (1/s), per_gain (inverse of what is folded into their curves):
    (count,), for a measured time step."""

    per_tau: Reals
    per_gain: Reals

    @property
    def by_depth(self) -> bool:
        return False

    @property
    def name(self) -> str:
        return "slow_branch" if self.double else "branch"

    @property
    def headers(self) -> tuple[str, ...]:
        return ("sp_poles.h", *(("sp_slow_poles.h",) if self.double else ()))

    @property
    def measured_headers(self) -> tuple[str, ...]:
        return ("sp_measured.h",)

    def tables(self) -> list[str]:
        return [array_text(f"{self.name}_loss", "double" if self.double else "sp_real", self.loss)]

    def measured_tables(self) -> tuple[str, ...]:
        return (
            array_text(f"{self.name}_per_tau", "sp_real", self.per_tau),
            array_text(f"{self.name}_per_gain", "sp_real", self.per_gain),
        )

    def step(self, follows: str) -> list[str]:
        function = "sp_slow_poles_apart" if self.double else "sp_poles_apart"
        return self._call(function, f"{self.name}_loss", f"{self.count}", follows)

    def measured_step(self, follows: str) -> list[str]:
        function = "sp_measured_slow_apart" if self.double else "sp_measured_apart"
        constants = f"{self.name}_per_tau, {self.name}_per_gain"
        return self._call(function, constants, f"{self.count}, dt_s", follows)

    def reference(self, rises: Reals, place: Place) -> Callable[[int, Reals], Reals]:
        return lambda i, h: h + (rises[i] - self.loss * h)


@dataclass(frozen=True, eq=False)
class RateByDepth(MaxwellBranches):
    """loss: (pieces, 2, count). rates: (pieces + 1, count), 1/s."""

    rates: Reals

    @property
    def by_depth(self) -> bool:
        return True

    @property
    def name(self) -> str:
        return "slow_depth_branch" if self.double else "depth_branch"

    @property
    def headers(self) -> tuple[str, ...]:
        return ("sp_depth.h",)

    @property
    def measured_headers(self) -> tuple[str, ...]:
        return ("sp_depth_dt.h",)

    def tables(self) -> list[str]:
        return [array_text(f"{self.name}_loss", "sp_real", self.loss.reshape(-1, self.count))]

    def measured_tables(self) -> tuple[str, ...]:
        return (array_text(f"{self.name}_rates", "sp_real", self.rates),)

    def step(self, follows: str) -> list[str]:
        function = "sp_depth_slow_poles" if self.double else "sp_depth_poles"
        settings = f"{self.count}, {follows}_depth"
        return self._call(function, f"{self.name}_loss", settings, follows)

    def measured_step(self, follows: str) -> list[str]:
        function = "sp_depth_slow_poles_dt" if self.double else "sp_depth_poles_dt"
        settings = f"{self.count}, {follows}_depth, dt_s"
        return self._call(function, f"{self.name}_rates", settings, follows)

    def instructions(self, costs: Costs) -> float:
        return super().instructions(costs) + self.count * costs.branch_depth

    def reference(self, rises: Reals, place: Place) -> Callable[[int, Reals], Reals]:
        lost = depth_curve(self.loss, *place).astype(rises.dtype)
        half = rises.dtype.type(0.5)
        return lambda i, h: h + (rises[i] - lost[i] * (h + half * rises[i]))


def branch_steps(
    model: Hammerstein, dt_s: float, dtype: type, vector_width: int
) -> tuple[tuple[MaxwellBranches, ...], Reals]:
    """The branches by who steps them, and their weights in that order, (capacity, J).

    Those in float first, of constant rate first among them and filled up to whole vectors of
    `vector_width`.
    """
    double = (model.slowest_s > SLOW_TICKS * dt_s) & (dtype is np.float32)
    filled = padded(max(len(double), 1), vector_width) - len(double)
    steps: list[MaxwellBranches] = []
    weights = [np.zeros((0, model.branch_n.shape[1]))]
    first = 0
    for in_double, depends in ((False, False), (False, True), (True, False), (True, True)):
        its = np.flatnonzero((double == in_double) & (model.by_depth == depends))
        fill = 0 if in_double or depends else filled
        if not len(its) + fill:
            continue
        tau_s = model.tau_s[its]
        if depends:
            steps.append(_by_depth(first, in_double, tau_s, model.rate_ratio, dt_s, dtype))
            weights.append(model.branch_n[its])
        else:
            steps.append(_constant(first, in_double, tau_s, fill, dt_s, dtype))
            gain = loss_and_gain(tau_s, dt_s)[1]
            weights.append(np.pad(gain[:, None] * model.branch_n[its], ((0, fill), (0, 0))))
        first += len(its) + fill
    return tuple(steps), np.concatenate(weights)


def _constant(
    first: int, double: bool, tau_s: Reals, fill: int, dt_s: float, dtype: type
) -> ConstantRate:
    loss, gain = loss_and_gain(tau_s, dt_s)
    padding = (0, fill)
    return ConstantRate(
        first=first,
        double=double,
        loss=np.pad(loss, padding, constant_values=1.0).astype(np.float64 if double else dtype),
        per_tau=np.pad(1.0 / tau_s, padding, constant_values=1.0).astype(dtype),
        per_gain=np.pad(1.0 / gain, padding, constant_values=1.0).astype(dtype),
    )


def _by_depth(
    first: int, double: bool, tau_s: Reals, ratio: float, dt_s: float, dtype: type
) -> RateByDepth:
    return RateByDepth(
        first=first,
        double=double,
        loss=loss_by_depth(tau_s, ratio, dt_s).astype(dtype),
        rates=rates_by_depth(tau_s, ratio).astype(dtype),
    )
