"""Maxwell branches of the passive model, grouped by how they are stepped, and the C of each group.

Of constant rate, or of one that depends on the depth (sp_depth.h); in double if a float would stop
moving.
"""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.literals import array_text
from springpot.codegen.model.formulas import (
    SMALLEST,
    Place,
    loss_and_gain,
    loss_by_depth,
    numbers,
    straight_values,
)
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.stages.exponentials import SLOW_TICKS, pole_states
from springpot.codegen.stages.stage import SceneTicks, padded


@dataclass(frozen=True)
class _Names:
    """C of a group: prefix of its tables and states; function and headers of a tick."""

    prefix: str
    step: str
    headers: tuple[str, ...]


_NAMES = {  # by_depth, double
    (False, False): _Names("branch", "sp_poles_apart", ("sp_poles.h",)),
    (False, True): _Names("slow_branch", "sp_slow_poles_apart", ("sp_poles.h", "sp_slow_poles.h")),
    (True, False): _Names("depth_branch", "sp_depth_poles", ("sp_depth.h",)),
    (True, True): _Names("slow_depth_branch", "sp_depth_slow_poles", ("sp_depth.h",)),
}


@dataclass(frozen=True, eq=False)
class MaxwellBranches:
    """Neighbouring branches that are stepped alike.

    first: column of the first one. by_depth: whether a tick needs the place of the depth. double:
    whether their states are. loss: of a tick, (count,); by depth at the nodes, (J + 1, count).
    """

    first: int
    by_depth: bool
    double: bool
    loss: Reals

    @property
    def names(self) -> _Names:
        return _NAMES[self.by_depth, self.double]

    @property
    def count(self) -> int:
        """Branches, those of curve 0 that fill a vector too."""
        return int(self.loss.shape[-1])

    def tables(self) -> list[str]:
        """Constants of a tick."""
        c_type = "double" if self.double and not self.by_depth else "sp_real"
        return [array_text(f"{self.names.prefix}_loss", c_type, self.loss)]

    def advance(self, rises: Reals, place: Place, h: Reals) -> Reals:
        """States after each tick, (n, count), from h, (count,); rises (n, count)."""
        if self.double:
            rises = rises.astype(np.float64)
        if not self.by_depth:
            return pole_states(self.loss, rises, h)
        half = rises.dtype.type(0.5)
        lost = straight_values(self.loss, place).astype(rises.dtype)
        states = np.empty_like(rises)
        for k, begin in enumerate(numbers(h)):
            z, ticks = begin, zip(numbers(rises[:, k]), numbers(lost[:, k]), strict=True)
            states[:, k] = [
                z := x if abs(x := z + (rise - loss * (z + half * rise))) >= SMALLEST else x * 0
                for rise, loss in ticks
            ]
        return states


def branch_steps(
    model: Hammerstein, ticks: SceneTicks
) -> tuple[tuple[MaxwellBranches, ...], Reals, Reals]:
    """The branches by who steps them; in that order their slopes, (capacity, J), and memory, N.

    Those in float first, of constant rate first among them and filled up to whole vectors.
    """
    dt_s, dtype = ticks.dt_s, ticks.dtype
    double = (model.slowest_s > SLOW_TICKS * dt_s) & (dtype is np.float32)
    filled = padded(max(len(double), 1), ticks.vector_width) - len(double)
    steps: list[MaxwellBranches] = []
    slopes_n = [np.zeros((0, model.nodes))]
    held_n: list[Reals] = []
    first = 0
    for in_double, depends in ((False, False), (False, True), (True, False), (True, True)):
        its = np.flatnonzero((double == in_double) & (model.by_depth == depends))
        fill = 0 if in_double or depends else filled
        if not len(its) + fill:
            continue
        tau_s, ratio, branch_n = model.tau_s[its], model.rate_ratio, model.branch_n[its]
        if depends:
            loss: Reals = loss_by_depth(tau_s, ratio, dt_s, model.nodes).astype(dtype)
        else:
            # The gain of a rise within a tick is folded into the curves; what fills has none.
            of_one, gain = loss_and_gain(tau_s, dt_s)
            loss = np.append(of_one, np.ones(fill))
            loss = loss.astype(np.float64 if in_double else dtype)
            branch_n = np.append(gain[:, None] * branch_n, np.zeros((fill, model.nodes)), axis=0)
        steps.append(MaxwellBranches(first, depends, in_double, loss))
        slopes_n.append(branch_n)
        held_n.append(np.append(model.memory.branch_n[its], np.zeros(fill)))
        first += len(its) + fill
    return tuple(steps), np.concatenate(slopes_n), np.concatenate(held_n)
