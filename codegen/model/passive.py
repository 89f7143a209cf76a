"""The passive model: springs, Maxwell branches, stops, flow, damage; curves that never fall."""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import (
    Flags,
    Indices,
    Samples,
    require,
    require_not_negative,
    require_positive,
    require_shape,
)
from springpot.codegen.messages import short_repr
from springpot.codegen.model.places import MAX_NODES, Places

# How a motion begins: with the object at rest, or with the state in which the training presses left
# it; auto: as the training recordings begin.
Start = Literal["auto", "rested", "continues"]
_MAX_RATE_RATIO = 1e4  # of relaxation at the surface and at u = 1
_BOUND_TOLERANCE = 1.0 - 1e-12
FLOW_REFERENCE_FRACTION = 0.2  # of the force at u = 1: there a flow has its stated time constant


def _require_in(
    name: str, values: NDArray[np.int64], known: tuple[int, ...], shape: tuple[int, ...]
) -> None:
    require_shape(name, values, shape)
    require(bool(np.isin(values, known).all()), f"{name}: not all of {known}")


@dataclass(frozen=True, eq=False)
class Flow:
    """Branches that relax the faster the more they hold: z' = rate |h|^(power - 1) h, h = b(u) - z.

    b(u) = u^degree, straight beyond u = 1. rate_ps: 1/s where h is 1; power: 3 or 5; degree: 1, 2
    or 4; force_n: of h = 1, >= 0. All (F,).
    """

    rate_ps: Samples
    power: NDArray[np.int64]
    degree: NDArray[np.int64]
    force_n: Samples

    def require_valid(self) -> None:
        """Raise DataError, with field and reason."""
        branches = (self.rate_ps.size,)
        require_positive("flow.rate_ps", self.rate_ps, branches)
        _require_in("flow.power", self.power, (3, 5), branches)
        _require_in("flow.degree", self.degree, (1, 2, 4), branches)
        require_not_negative("flow.force_n", self.force_n, branches)

    @property
    def tau_s(self) -> Samples:
        """Time constant of each branch while it holds FLOW_SHARE, (F,), s."""
        return 1.0 / (self.rate_ps * FLOW_REFERENCE_FRACTION ** (self.power - 1.0))


@dataclass(frozen=True, eq=False)
class Damage:
    """Softening by the largest depth so far: g(v) (v/M)^power, M the largest v so far.

    v = u in the object, M heals towards v with the time heal_s, 0: never. power: 1 or 3. Both (D,).
    curve_n: slopes of g, (D, J), as in `Hammerstein`.
    """

    heal_s: Samples
    power: NDArray[np.int64]
    curve_n: Samples

    def require_valid(self, nodes: int) -> None:
        """Raise DataError, with field and reason."""
        curves = self.heal_s.size
        _require_in("damage.power", self.power, (1, 3), (curves,))
        require_not_negative("damage.heal_s", self.heal_s, (curves,))
        require_not_negative("damage.curve_n", self.curve_n, (curves, nodes))


def sort_by_power(part: Flow | Damage) -> Indices:
    """Return numbers of the branches, or curves, lower powers first: as the C has them."""
    return np.argsort(part.power, kind="stable")


@dataclass(frozen=True, eq=False)
class Memory:
    """The whole state of a pressed object that stands at u and gives force_n there, N.

    branch_n: force of each branch, (P,), N; flow: h of each flowing branch, (F,); deepest: M of
    each curve of damage, (D,); play: where that of each stop is, (K,). With less than all of it
    a model went where no motion leads: it pushed with 2 N on a hand that touched nothing.
    """

    branch_n: Samples
    flow: Samples
    deepest: Samples
    play: Samples
    u: float
    force_n: float

    def require_valid(self, branches: int, flowing: int, curves: int, stops: int) -> None:
        """Raise DataError, with field and reason."""
        require_shape("end_memory.branch_n", self.branch_n, (branches,))
        require_shape("end_memory.flow", self.flow, (flowing,))
        require_not_negative("end_memory.deepest", self.deepest, (curves,))
        require_shape("end_memory.play", self.play, (stops,))


@dataclass(frozen=True, eq=False)
class Hammerstein:
    """Non-negative sum of springs, Maxwell branches, stops, flow and damage: passive in the large.

    u = (x - origin_m)/span_m: span_m is the trained depth, or more where slopes grow beyond it. A
    curve g(u) is 0 at u <= 0; its slope, N for u from 0 to 1, is given at J equally spaced nodes
    from 0 to 1, is straight between them and constant beyond. A curve is smooth, and never falls
    where the slopes are not negative.
    force = bias_n + g_elastic + sum of highpass_tau(g_branch) + sum of g_stop(u) - g_stop(play u).
    elastic_n: (J,). tau_s: (P,), branch_n: (P, J). radius_m: (K,), stop_n: (K, J). Slopes >= 0.
    n_by_depth: of the last branches, which relax at the rate rate_ratio^(1/2 - u)/tau: rate_ratio
    is that at the surface over that at u = 1. recovers: where the object has a surface,
    it comes back by itself while the tool is away (sp_surface.h); else the force is 0 at least.
    places: how slopes differ from place to place; those above are then the most of any place.
    end_memory: the state after the training presses; None: only what damage does not heal.
    continues: a motion begins with that state, and not with an object at rest. end_depth_m: where
    the tool was at the end of the only training recording, m: nothing else shows how others begin;
    None: there are more recordings, or a person has said how a motion begins.
    """

    origin_m: float
    span_m: float
    elastic_n: Samples
    tau_s: Samples
    branch_n: Samples
    radius_m: Samples
    stop_n: Samples
    bias_n: float
    n_by_depth: int = 0
    rate_ratio: float = 1.0
    flow: Flow | None = None
    damage: Damage | None = None
    recovers: bool = False
    places: Places | None = field(default=None, metadata={"left_out": True})
    end_memory: Memory | None = field(default=None, metadata={"left_out": True})
    continues: bool = False
    end_depth_m: float | None = field(default=None, metadata={"left_out": True})
    __repr__ = short_repr

    def require_valid(self) -> None:
        """Raise DataError, with field and reason."""
        nodes, branches, stops = self.nodes, self.tau_s.size, self.radius_m.size
        require(self.span_m > 0.0, f"span_m: {self.span_m:g} m is no depth above 0")
        require(1 <= nodes <= MAX_NODES, f"elastic_n: {nodes} nodes, not 1 to {MAX_NODES}")
        require_not_negative("elastic_n", self.elastic_n, (nodes,))
        require_positive("tau_s", self.tau_s, (branches,))
        require_not_negative("branch_n", self.branch_n, (branches, nodes))
        require_positive("radius_m", self.radius_m, (stops,))
        require_not_negative("stop_n", self.stop_n, (stops, nodes))
        require(0 <= self.n_by_depth <= branches, f"n_by_depth: {self.n_by_depth} branches")
        known = 1 / _MAX_RATE_RATIO <= self.rate_ratio <= _MAX_RATE_RATIO
        require(known, f"rate_ratio: {self.rate_ratio:g} is beyond {_MAX_RATE_RATIO:g}")
        if self.flow is not None:
            self.flow.require_valid()
        if self.damage is not None:
            self.damage.require_valid(nodes)
        flowing = 0 if self.flow is None else self.flow.rate_ps.size
        curves = 0 if self.damage is None else self.damage.heal_s.size
        self.memory.require_valid(branches, flowing, curves, stops)
        if self.places is not None:
            self.places.require_valid(self.slopes_n.size)
            bounded = bool(np.all(self.slopes_n >= _BOUND_TOLERANCE * self.places.most_n))
            require(bounded, "places: steeper somewhere than the curves beside them say")

    @property
    def nodes(self) -> int:
        """Nodes of each curve."""
        return len(self.elastic_n)

    @property
    def by_depth(self) -> Flags:
        """Mark the branches with a rate that depends on the depth, (P,)."""
        return np.arange(len(self.tau_s)) >= len(self.tau_s) - self.n_by_depth

    @property
    def slowest_s(self) -> Samples:
        """Longest time constant of each branch at any depth, (P,), s."""
        slower = np.sqrt(max(self.rate_ratio, 1.0 / self.rate_ratio))
        return self.tau_s * np.where(self.by_depth, slower, 1.0)

    @property
    def memory_s(self) -> float:
        """Longest time constant, s."""
        flowing_s = 0.0 if self.flow is None else float(self.flow.tau_s.max(initial=0.0))
        return max(float(self.slowest_s.max(initial=0.0)), flowing_s)

    @property
    def memory(self) -> Memory:
        """Return the state after training; if none was stored: unhealed damage, else at rest."""
        if self.end_memory is not None:
            return self.end_memory
        pressed = np.zeros(0) if self.damage is None else np.where(self.damage.heal_s > 0, 0.0, 1.0)
        flow = np.zeros(0 if self.flow is None else len(self.flow.rate_ps))
        branch_n, play = np.zeros(len(self.tau_s)), np.zeros(len(self.radius_m))
        return Memory(branch_n, flow, pressed, play, 0.0, 0.0)

    @property
    def slopes_n(self) -> Samples:
        """Collect all that the force is linear in, (slopes,), N: curves, stops, damage, flow."""
        damage_n = np.zeros(0) if self.damage is None else self.damage.curve_n
        flow_n = np.zeros(0) if self.flow is None else self.flow.force_n
        parts = (self.elastic_n, self.branch_n, self.stop_n, damage_n, flow_n)
        return np.concatenate([part.ravel() for part in parts])

    def with_slopes(self, slopes_n: Samples) -> "Hammerstein":
        """Return the same law with other `slopes_n`, (slopes,), and one place."""
        damage, flow = self.damage, self.flow
        shaped = [self.elastic_n, self.branch_n, self.stop_n]
        shaped += [np.zeros(0) if damage is None else damage.curve_n]
        cuts = np.cumsum([part.size for part in shaped])
        parts = np.split(slopes_n, cuts)
        elastic_n, branch_n, stop_n, damage_n = (
            part.reshape(like.shape) for part, like in zip(parts[:-1], shaped, strict=True)
        )
        return replace(
            self,
            elastic_n=elastic_n,
            branch_n=branch_n,
            stop_n=stop_n,
            damage=damage and replace(damage, curve_n=damage_n),
            flow=flow and replace(flow, force_n=parts[-1]),
            places=None,
        )

    def stiffened(self, factor: float) -> "Hammerstein":
        """Return the model with the force at x that this one has at factor x."""
        return replace(
            self,
            origin_m=self.origin_m / factor,
            span_m=self.span_m / factor,
            radius_m=self.radius_m / factor,
            end_depth_m=None if self.end_depth_m is None else self.end_depth_m / factor,
        )
