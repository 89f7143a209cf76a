"""What a passive model may have beside springs, branches and stops: flow, damage, a surface."""

from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Flags, Reals, Samples
from springpot.codegen.literals import array_text
from springpot.codegen.model.formulas import (
    SMALLEST,
    CurveLocation,
    compute_flow_loss,
    count_intervals,
    evaluate_curves,
    evaluate_flow_functions,
    integrate_slopes,
    locate_on_curve,
    scalar_type,
    to_scalars,
)
from springpot.codegen.model.passive import Damage, Flow, sort_by_power
from springpot.codegen.stages.stage import LARGEST, REAL, Member, SceneTicks
from springpot.codegen.types import RealType, Scalar

FUNCTIONS = (1, 2, 4)  # degrees, SP_FLOW_FUNCTIONS of sp_flow.h
MIN_STIFFNESS_FRACTION = (
    1e-6  # of the largest slope: an interval without stiffness would recover at once
)


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
        """Return the most that the force rises at each node, (J,), N for u from 0 to 1."""
        u = np.linspace(0.0, 1.0, nodes) if nodes > 1 else np.ones(1)
        degrees = np.array(FUNCTIONS)[self.function].astype(float)
        steep: Samples = degrees * u[:, None] ** (degrees - 1.0)
        return steep @ self.force_n.astype(np.float64)

    def advance(self, u: Reals, before: Reals, h: Reals) -> tuple[Reals, Reals, Reals]:
        """Return the dashpots' force, (n,), N, at depths u, (n,), and their state after it.

        u is the depth over the trained one. The operations are those of sp_flow.h, in its order.
        """
        real = self.loss.dtype.type
        root = sqrt if real is np.float64 else np.sqrt
        functions = evaluate_flow_functions(u)
        rises = real(0.5) * (functions - np.concatenate([before[None], functions[:-1]]))
        force_n, ends = np.zeros_like(u), np.empty_like(h)
        for k, (loss, begin) in enumerate(zip(to_scalars(self.loss), to_scalars(h), strict=True)):
            states, h_now, cubic = [], begin, k < self.n_cubic
            for half in to_scalars(rises[:, self.function[k]]):
                midpoint = min(max(h_now + half, -LARGEST), LARGEST)
                square = midpoint * midpoint
                grown = root(1 + loss * (square if cubic else square * square))
                grown = grown if cubic else root(grown)
                h_now = midpoint / grown + half
                h_now = h_now if abs(h_now) >= SMALLEST else h_now * 0
                states.append(h_now)
            force_n += self.force_n[k] * np.array(states, dtype=u.dtype)
            ends[k] = h_now
        return force_n, functions[-1], ends


def build_flow_branches(flow: Flow, ticks: SceneTicks) -> FlowBranches:
    """Return a model's nonlinear dashpots (sp_flow.h), those of power 3 first, as C does."""
    order = sort_by_power(flow)
    power, rate = flow.power[order], flow.rate_ps[order]
    degrees = flow.degree[order].tolist()
    return FlowBranches(
        loss=compute_flow_loss(rate, power, ticks.dt_s).astype(ticks.dtype),
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

    def advance(self, u: Reals, place: CurveLocation, deepest: Reals) -> tuple[Reals, Reals]:
        """Return the damage curves' force, (n,), N, at depths u, (n,), and their greatest depths.

        The Mullins effect. u is the depth over the trained one. The operations are those of
        sp_damage.h, in its order.
        """
        real, v = u.dtype.type, np.where(u > 0, u, u.dtype.type(0))[:, None]
        max_depth, ends = np.empty((len(u), len(deepest)), u.dtype), np.empty_like(deepest)
        for k, begin in enumerate(to_scalars(deepest)):
            healed_path, most, healed = [], begin, to_scalars(self.healed)[k]
            for depth_v in to_scalars(v[:, 0]):
                healed_most = most - healed * (most - depth_v)
                healed_path.append(healed_most)
                most = healed_most if healed_most > depth_v else depth_v
            max_depth[:, k], ends[k] = healed_path, most
        below = max_depth > v
        depth_ratio = np.where(below, v / np.where(below, max_depth, real(1)), real(1))
        depth_ratio[:, self.n_linear :] *= (
            depth_ratio[:, self.n_linear :] * depth_ratio[:, self.n_linear :]
        )
        curves_n = evaluate_curves(self.curves, place) * depth_ratio
        return sum(curves_n.T, np.zeros_like(u)), ends


def build_damage_curves(damage: Damage, ticks: SceneTicks) -> DamageCurves:
    """Return the damage curves (Mullins effect, sp_damage.h) of a model, those of power 1 first."""
    dtype = ticks.dtype
    order = sort_by_power(damage)
    heal_s = damage.heal_s[order]
    rate = np.where(heal_s > 0.0, 1.0 / np.where(heal_s > 0.0, heal_s, 1.0), 0.0)
    return DamageCurves(
        curves=integrate_slopes(damage.curve_n[order]).astype(dtype),
        healed=(-np.expm1(-ticks.dt_s * rate)).astype(dtype),
        n_linear=int(np.count_nonzero(damage.power == 1)),
    )


def bound_damage_slopes_n(damage: Damage) -> Samples:
    """Return the most that damage's force rises at each node, (J,), N for u from 0 to 1.

    d/dv g (v/M)^q <= g' + q g/v, and g/v is at most the largest slope so far.
    """
    most_n = np.maximum.accumulate(damage.curve_n, axis=1)
    total: Samples = (damage.curve_n + damage.power[:, None] * most_n).sum(axis=0)
    return total


@dataclass(frozen=True, eq=False)
class RecoveringSurface:
    """max_slope_n: (J,), N: upper bound of the force gained in each interval."""

    max_slope_n: Reals

    headers = ("sp_surface.h",)

    def members(self, name: str) -> tuple[Member, ...]:
        return (Member(f"sp_surface_state {name}_surface", (REAL, REAL)),)

    def tables(self) -> list[str]:
        return [
            "/* At most so stiff is each piece of the depth, N a piece (sp_surface.h). */",
            array_text("max_slope_n", "sp_real", self.max_slope_n),
        ]

    def at(self, u: Scalar, before: Scalar, force_n: Scalar) -> Scalar:
        """Return the surface's depth while the tool is at u: the tool's, or recovering.

        `before`: its depth in the tick before (sp_surface_model_u).
        """
        if not u < before:
            return u
        if not force_n > 0:
            return before
        retracted = self._retract(before, force_n)
        back = retracted if retracted < before else before
        return u if u > back else back

    def may_leave(self, u: Reals, before: Reals, force_n: Reals) -> Flags:
        """Find the ticks, (n,), in which the tool may leave the surface: all, and few others.

        Where the largest slope up to `before`, over that distance, takes more than the force.
        """
        steepest = np.maximum.accumulate(self.max_slope_n.astype(np.float64))
        distance = (before.astype(np.float64) - u) * count_intervals(len(self.max_slope_n))
        required_n = steepest[locate_on_curve(before, len(self.max_slope_n))[0]] * distance
        return (u < before) & (force_n < 1.01 * required_n)

    @cached_property
    def _max_slopes_n(self) -> list[Scalar]:
        return to_scalars(self.max_slope_n)

    def _retract(self, before: Scalar, force_n: Scalar) -> Scalar:
        """Return the depth to which a free surface recovers in a tick (sp_surface_recovered_u)."""
        real, max_slope_n = scalar_type(self.max_slope_n.dtype.type), self._max_slopes_n
        last = len(max_slope_n) - 1
        interval_position = (before if before > 0 else real(0)) * real(count_intervals(last + 1))
        interval, left_n = int(min(interval_position, last)), force_n
        fraction = interval_position - real(interval)
        required_n = max_slope_n[interval] * fraction
        while interval > 0 and left_n > required_n:
            left_n = left_n - required_n
            interval, fraction = interval - 1, real(1)
            required_n = max_slope_n[interval]
        fraction = fraction - left_n / max_slope_n[interval]
        end = real(interval) + (fraction if fraction > 0 else real(0))
        return end / real(count_intervals(len(max_slope_n)))


def build_surface(most_n: Samples, dtype: RealType) -> RecoveringSurface:
    """Bound each piece's stiffness, so that the surface recovers without ever pulling.

    most_n: the most that the force rises at each node, (J,), N for u from 0 to 1.
    """
    max_slope_n = np.maximum(np.append(most_n[1:], most_n[-1]), most_n)
    max_slope_n = np.maximum(
        max_slope_n, MIN_STIFFNESS_FRACTION * max(float(max_slope_n.max()), 1e-3)
    )
    # Rounded up, so that it is a bound in the scene's number type too.
    rounded = np.nextafter(
        (max_slope_n / count_intervals(len(max_slope_n))).astype(dtype), dtype(np.inf)
    )
    return RecoveringSurface(rounded)
