"""Branches that relax the faster the more they hold: sp_flow.h."""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals, Samples
from springpot.codegen.literals import array_text
from springpot.codegen.model.formulas import flow_functions, flow_loss
from springpot.codegen.model.passive import Flow, power_order
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.stage import LARGEST, REAL, SMALLEST, Member, SceneTicks, numbers

FUNCTIONS = (1, 2, 4)  # degrees, SP_FLOW_FUNCTIONS of sp_flow.h


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

    def instructions(self, costs: Costs) -> float:
        """Bound of a tick's."""
        return costs.flow + self.count * costs.flow_branch

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
        rises = real(0.5) * np.diff(functions, prepend=before[None, :], axis=0)
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
