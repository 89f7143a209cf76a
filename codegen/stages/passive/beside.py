"""What a passive model may have beside springs, branches and stops: flow, damage, a surface."""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Flags, Reals, Samples
from springpot.codegen.literals import array_text
from springpot.codegen.model.formulas import (
    SMALLEST,
    Place,
    curve_nodes,
    curve_place,
    curve_values,
    flow_functions,
    flow_loss,
    numbers,
    pieces_of_one,
)
from springpot.codegen.model.passive import Damage, Flow, power_order
from springpot.codegen.stages.stage import LARGEST, REAL, Member, SceneTicks
from springpot.codegen.types import RealType, Scalar

FUNCTIONS = (1, 2, 4)  # degrees, SP_FLOW_FUNCTIONS of sp_flow.h
LEAST = 1e-6  # of the stiffest piece: what no spring resists would come back at once


@dataclass(frozen=True, eq=False)
class FlowBranches:
    """The first n_cubic have power 3, the others 5; function: index into FUNCTIONS. All (F,)."""

    loss: Reals
    force_n: Reals
    function: NDArray[np.uint8]
    n_cubic: int

    headers = ("sp_flow.h",)

    @property
    def count(self) -> int:
        """Branches."""
        return len(self.loss)

    def members(self, name: str) -> tuple[Member, ...]:
        return (
            Member(f"sp_real {name}_flow_before[{len(FUNCTIONS)}]", (REAL,) * len(FUNCTIONS)),
            Member(f"sp_real {name}_flow[{self.count}]", (REAL,) * self.count),
        )

    def tables(self) -> list[str]:
        return [
            "/* Flowing branches: (p - 1) rate dt, N, and which function of u (sp_flow.h). */",
            array_text("flow_loss", "sp_real", self.loss),
            array_text("flow_n", "sp_real", self.force_n),
            array_text("flow_function", "uint8_t", self.function),
        ]

    def slopes_n(self, nodes: int) -> Samples:
        """The most that the force rises at each node, (J,), N for u from 0 to 1."""
        u = np.linspace(0.0, 1.0, nodes) if nodes > 1 else np.ones(1)
        degrees = np.array(FUNCTIONS)[self.function].astype(float)
        steep: Samples = degrees * u[:, None] ** (degrees - 1.0)
        return steep @ self.force_n.astype(np.float64)

    def advance(self, u: Reals, before: Reals, h: Reals) -> tuple[Reals, Reals, Reals]:
        """Forces of ticks at u (n,), N, in the order of the C; and b and h after the last one."""
        real = self.loss.dtype.type
        root = sqrt if real is np.float64 else np.sqrt
        functions = flow_functions(u)
        rises = real(0.5) * (functions - np.concatenate([before[None], functions[:-1]]))
        force_n, ends = np.zeros_like(u), np.empty_like(h)
        for k, (loss, begin) in enumerate(zip(numbers(self.loss), numbers(h), strict=True)):
            along, its_h, cubic = [], begin, k < self.n_cubic
            for half in numbers(rises[:, self.function[k]]):
                held = min(max(its_h + half, -LARGEST), LARGEST)
                square = held * held
                grown = root(1 + loss * (square if cubic else square * square))
                grown = grown if cubic else root(grown)
                its_h = held / grown + half
                its_h = its_h if abs(its_h) >= SMALLEST else its_h * 0
                along.append(its_h)
            force_n += self.force_n[k] * np.array(along, dtype=u.dtype)
            ends[k] = its_h
        return force_n, functions[-1], ends


def flow_branches(flow: Flow, ticks: SceneTicks) -> FlowBranches:
    """The branches of a model, those of power 3 first."""
    order = power_order(flow)
    power, rate = flow.power[order], flow.rate_ps[order]
    degrees = flow.degree[order].tolist()
    return FlowBranches(
        loss=flow_loss(rate, power, ticks.dt_s).astype(ticks.dtype),
        force_n=flow.force_n[order].astype(ticks.dtype),
        function=np.array([FUNCTIONS.index(degree) for degree in degrees], dtype=np.uint8),
        n_cubic=int(np.count_nonzero(power == 3)),
    )


@dataclass(frozen=True, eq=False)
class DamageCurves:
    """Forces that fall with the largest depth so far: curves, (nodes, value and slope, count).

    healed: of a tick, (count,). n_linear: the first ones have power 1, the others 3.
    """

    curves: Reals
    healed: Reals
    n_linear: int

    headers = ("sp_damage.h",)

    @property
    def count(self) -> int:
        """Curves."""
        return len(self.healed)

    def members(self, name: str) -> tuple[Member, ...]:
        return (Member(f"sp_real {name}_deepest[{self.count}]", (REAL,) * self.count),)

    def tables(self) -> list[str]:
        return [
            "/* Damage: its curves, and what heals in a tick (sp_damage.h). */",
            array_text("damage", "sp_real", self.curves.reshape(-1, self.count)),
            array_text("healed", "sp_real", self.healed),
        ]

    def advance(self, u: Reals, place: Place, deepest: Reals) -> tuple[Reals, Reals]:
        """Forces of ticks at u (n,), N, in the order of the C; and M after the last one."""
        real, v = u.dtype.type, np.where(u > 0, u, u.dtype.type(0))[:, None]
        left, ends = np.empty((len(u), len(deepest)), u.dtype), np.empty_like(deepest)
        for k, begin in enumerate(numbers(deepest)):
            along, most, healed = [], begin, numbers(self.healed)[k]
            for its_v in numbers(v[:, 0]):
                its_left = most - healed * (most - its_v)
                along.append(its_left)
                most = its_left if its_left > its_v else its_v
            left[:, k], ends[k] = along, most
        below = left > v
        share = np.where(below, v / np.where(below, left, real(1)), real(1))
        share[:, self.n_linear :] *= share[:, self.n_linear :] * share[:, self.n_linear :]
        curves_n = curve_values(self.curves, place) * share
        return sum(curves_n.T, np.zeros_like(u)), ends


def damage_curves(damage: Damage, ticks: SceneTicks) -> DamageCurves:
    """The curves of a model, those of power 1 first."""
    dtype = ticks.dtype
    order = power_order(damage)
    heal_s = damage.heal_s[order]
    rate = np.where(heal_s > 0.0, 1.0 / np.where(heal_s > 0.0, heal_s, 1.0), 0.0)
    return DamageCurves(
        curves=curve_nodes(damage.curve_n[order]).astype(dtype),
        healed=(-np.expm1(-ticks.dt_s * rate)).astype(dtype),
        n_linear=int(np.count_nonzero(damage.power == 1)),
    )


def steepest_n(damage: Damage) -> Samples:
    """The most that damage's force rises at each node, (J,), N for u from 0 to 1.

    d/dv g (v/M)^q <= g' + q g/v, and g/v is at most the largest slope so far.
    """
    most_n = np.maximum.accumulate(damage.curve_n, axis=1)
    total: Samples = (damage.curve_n + damage.power[:, None] * most_n).sum(axis=0)
    return total


@dataclass(frozen=True, eq=False)
class RecoveringSurface:
    """stiffest: (J,), N a piece: the most that the force can rise through each piece."""

    stiffest: Reals

    headers = ("sp_surface.h",)

    def members(self, name: str) -> tuple[Member, ...]:
        return (Member(f"sp_surface_state {name}_surface", (REAL, REAL)),)

    def tables(self) -> list[str]:
        return [
            "/* At most so stiff is each piece of the depth, N a piece (sp_surface.h). */",
            array_text("stiffest", "sp_real", self.stiffest),
        ]

    def at(self, u: Scalar, before: Scalar, force_n: Scalar) -> Scalar:
        """sp_surface_at: where the model is while the tool is at u; it was at `before`."""
        if not u < before:
            return u
        if not force_n > 0:
            return before
        found = self._back(before, force_n)
        back = found if found < before else before
        return u if u > back else back

    def may_leave(self, u: Reals, before: Reals, force_n: Reals) -> Flags:
        """Ticks, (n,), in which the tool may come off: all with `at` above u, and few others.

        At the stiffest of all pieces up to `before` its way takes more than the force.
        """
        steepest = np.maximum.accumulate(self.stiffest.astype(np.float64))
        way = (before.astype(np.float64) - u) * pieces_of_one(len(self.stiffest))
        takes_n = steepest[curve_place(before, len(self.stiffest))[0]] * way
        return (u < before) & (force_n < 1.01 * takes_n)

    def _back(self, before: Scalar, force_n: Scalar) -> Scalar:
        """sp_surface_back: how far the surface comes back in a tick."""
        real, last = self.stiffest.dtype.type, len(self.stiffest) - 1
        passed = (before if before > 0 else real(0)) * real(pieces_of_one(last + 1))
        piece, left_n = int(min(passed, last)), force_n
        way = passed - real(piece)
        takes_n = self.stiffest[piece] * way
        while piece > 0 and left_n > takes_n:
            left_n = left_n - takes_n
            piece, way = piece - 1, real(1)
            takes_n = self.stiffest[piece]
        way = way - left_n / self.stiffest[piece]
        end = real(piece) + (way if way > 0 else real(0))
        return end / real(pieces_of_one(len(self.stiffest)))


def surface_of(most_n: Samples, dtype: RealType) -> RecoveringSurface:
    """Bound the stiffness of each piece, above which a step back could pull.

    most_n: the most that the force rises at each node, (J,), N for u from 0 to 1.
    """
    stiffest = np.maximum(np.append(most_n[1:], most_n[-1]), most_n)
    stiffest = np.maximum(stiffest, LEAST * max(float(stiffest.max()), 1e-3))
    # Rounded up, so that it is a bound in the scene's number type too.
    rounded = np.nextafter((stiffest / pieces_of_one(len(stiffest))).astype(dtype), dtype(np.inf))
    return RecoveringSurface(rounded)
