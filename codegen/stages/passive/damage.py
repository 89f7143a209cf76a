"""What was pressed deeper before is softer: sp_damage.h."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Reals, Samples
from springpot.codegen.literals import array_text
from springpot.codegen.model.formulas import Place, curve_nodes, curve_values
from springpot.codegen.model.passive import Damage, power_order
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.stage import REAL, Member, SceneTicks, numbers


@dataclass(frozen=True, eq=False)
class DamageCurves:
    """The first n_linear have power 1, the others 3. curves: (J + 1, 2, D).

    healed: of a tick, (D,).
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

    def instructions(self, costs: Costs) -> float:
        """Bound of a tick's."""
        return self.count * (costs.curve + costs.damage)

    def advance(self, u: Reals, place: Place, deepest: Reals) -> tuple[Reals, Reals]:
        """Forces of ticks at u (n,), N, in the order of the C; and M after the last one."""
        values = curve_values(self.curves, place)
        v = np.where(u > 0, u, u.dtype.type(0))
        force_n, ends = np.zeros_like(u), np.empty_like(deepest)
        states = zip(numbers(self.healed), numbers(deepest), strict=True)
        for k, (healed, begin) in enumerate(states):
            kept_along, most = [], begin
            for its_v in numbers(v):
                kept = most - healed * (most - its_v)
                kept_along.append(kept)
                most = kept if kept > its_v else its_v
            kept = np.array(kept_along, dtype=u.dtype)
            below = kept > v
            share = np.where(below, v / np.where(below, kept, u.dtype.type(1)), u.dtype.type(1))
            force_n += values[:, k] * (share if k < self.n_linear else share * share * share)
            ends[k] = most
        return force_n, ends


def damage_curves(damage: Damage, ticks: SceneTicks) -> DamageCurves:
    """The curves of a model, those of power 1 first: in `power_order`."""
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
    most = np.maximum.accumulate(damage.curve_n, axis=1)
    total: Samples = (damage.curve_n + damage.power[:, None] * most).sum(axis=0)
    return total
