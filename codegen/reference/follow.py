"""Reference of sp_follow.h: the place goes with the tool; and where a place is on the grid."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from springpot.codegen.arrays import Reals
from springpot.codegen.stages.passive.placed import MapConfig
from springpot.codegen.stages.stage import bounded

NEAR = 0.125  # SP_LATERAL_NEAR


@dataclass(frozen=True)
class Cell:
    """sp_lateral_cell: node before the place, way from there, nodes per m; each of x and y."""

    node: Sequence[int]
    way: Sequence[Any]
    per_m: Sequence[Any]

    def twists(self, amounts: Reals) -> Reals:
        """sp_anchor_bend for 1 J, (materials,), 1/m^2."""
        i, j = self.node
        twist = (amounts[i + 1, j + 1] - amounts[i + 1, j]) - (amounts[i, j + 1] - amounts[i, j])
        found: Reals = twist * self.per_m[0] * self.per_m[1]
        return found


class Follow:
    """sp_follow_state."""

    def __init__(self, config: MapConfig, dtype: type[Any]) -> None:
        self._map, self._real = config, dtype
        self._off = [dtype(0)] * 2

    def rest(self, at: Sequence[Any]) -> None:
        """sp_follow_rest."""
        del at
        self._off = [self._real(0)] * 2

    def left(self, was: Sequence[Any], at: Sequence[Any]) -> bool:
        """sp_follow_left."""
        per_step = (self._map.per_step_x, self._map.per_step_y)
        steps = [
            (off + (before - now)) * per
            for off, before, now, per in zip(self._off, was, at, per_step, strict=False)
        ]
        return not all(abs(each) <= NEAR for each in steps)

    def move(self, was: Sequence[Any], at: Sequence[Any], touches: bool) -> list[Any]:
        """sp_follow_move."""
        ways = [at[k] - was[k] for k in range(2)]
        if not touches:
            self._off = [bounded(off - way) for off, way in zip(self._off, ways, strict=True)]
        return ways

    def cell(self, last: Sequence[Any]) -> Cell:
        """sp_follow_cell."""
        config = self._map
        firsts = (config.first_x_m, config.first_y_m)
        per_steps = (config.per_step_x, config.per_step_y)
        nodes, ways, pers = [], [], []
        for k, n in enumerate(config.nodes):
            passed = (last[k] + self._off[k] - firsts[k]) * per_steps[k]
            end = self._real(n - 1)
            steps = passed if 0 < passed < end else end if passed > 0 else self._real(0)
            nodes.append(min(int(steps), n - 2))
            ways.append(steps - self._real(nodes[k]))
            pers.append(per_steps[k] if 0 <= passed <= end else self._real(0))
        return Cell(nodes, ways, pers)

    def feel(self, bend_npm: Any, felt_n: list[Any]) -> list[Any]:
        """The tool feels what the object does."""
        del bend_npm
        return felt_n
