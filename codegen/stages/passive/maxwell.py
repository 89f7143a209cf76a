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
    CurveLocation,
    compute_depth_loss,
    compute_loss_and_gain,
    interpolate_linear,
    to_scalars,
)
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.stages.exponentials import SLOW_TICKS, step_poles
from springpot.codegen.stages.stage import SceneTicks, round_up


@dataclass(frozen=True)
class _Names:
    """C of a group: prefix of its tables and states; function and headers of a tick."""

    prefix: str
    step: str
    headers: tuple[str, ...]


_NAMES = {  # by_depth, double
    (False, False): _Names("branch", "sp_poles_separate", ("sp_poles.h",)),
    (False, True): _Names(
        "slow_branch", "sp_slow_poles_separate", ("sp_poles.h", "sp_slow_poles.h")
    ),
    (True, False): _Names("depth_branch", "sp_poles_by_depth", ("sp_depth.h",)),
    (True, True): _Names("slow_depth_branch", "sp_slow_poles_by_depth", ("sp_depth.h",)),
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

    def advance(self, rises: Reals, location: CurveLocation, h: Reals) -> Reals:
        """Return the branches' forces after each tick, (n, count); h: before; rises (n, count)."""
        if self.double:
            rises = rises.astype(np.float64)
        if not self.by_depth:
            return step_poles(self.loss, rises, h)
        half = rises.dtype.type(0.5)
        decay = interpolate_linear(self.loss, location).astype(rises.dtype)
        states = np.empty_like(rises)
        for k, begin in enumerate(to_scalars(h)):
            z, ticks = begin, zip(to_scalars(rises[:, k]), to_scalars(decay[:, k]), strict=True)
            states[:, k] = [
                z := x if abs(x := z + (rise - loss * (z + half * rise))) >= SMALLEST else x * 0
                for rise, loss in ticks
            ]
        return states


def group_branches(
    model: Hammerstein, ticks: SceneTicks
) -> tuple[tuple[MaxwellBranches, ...], Reals, Reals]:
    """Group Maxwell branches by how C steps them: float or double, constant rate or by depth.

    Returns the groups, and in their order the slopes, (capacity, J), and memory, N. Those in float
    come first, of constant rate first among them and filled up to whole vectors.
    """
    dt_s, dtype = ticks.dt_s, ticks.dtype
    double = (model.slowest_s > SLOW_TICKS * dt_s) & (dtype is np.float32)
    filled = round_up(max(len(double), 1), ticks.vector_width) - len(double)
    steps: list[MaxwellBranches] = []
    slopes_n = [np.zeros((0, model.nodes))]
    memory_n: list[Reals] = []
    first = 0
    for in_double, by_depth in ((False, False), (False, True), (True, False), (True, True)):
        group = np.flatnonzero((double == in_double) & (model.by_depth == by_depth))
        fill = 0 if in_double or by_depth else filled
        if not len(group) + fill:
            continue
        tau_s, ratio, branch_n = model.tau_s[group], model.rate_ratio, model.branch_n[group]
        if by_depth:
            loss: Reals = compute_depth_loss(tau_s, ratio, dt_s, model.nodes).astype(dtype)
        else:
            # The gain of a rise within a tick is folded into the curves; what fills has none.
            decay, gain = compute_loss_and_gain(tau_s, dt_s)
            loss = np.append(decay, np.ones(fill))
            loss = loss.astype(np.float64 if in_double else dtype)
            branch_n = np.append(gain[:, None] * branch_n, np.zeros((fill, model.nodes)), axis=0)
        steps.append(MaxwellBranches(first, by_depth, in_double, loss))
        slopes_n.append(branch_n)
        memory_n.append(np.append(model.memory.branch_n[group], np.zeros(fill)))
        first += len(group) + fill
    return tuple(steps), np.concatenate(slopes_n), np.concatenate(memory_n)
