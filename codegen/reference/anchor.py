"""Reference of sp_anchor.h: friction, an anchor that a spring ties to the tool."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.stages.passive.lateral import AnchorConfig
from springpot.codegen.stages.passive.placed import MapConfig
from springpot.codegen.stages.stage import SMALLEST, bounded, flushed

NEAR = 0.125  # SP_ANCHOR_NEAR


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

    def here(self, amounts: Reals) -> list[tuple[Any, Any, Any]]:
        """sp_lateral_amounts: of each material its amount, and its slopes in x and y, 1/m."""
        one = amounts.dtype.type(1)
        (i, j), (x, y) = self.node, self.way
        near, over, far, both = (
            amounts[i, j], amounts[i, j + 1], amounts[i + 1, j], amounts[i + 1, j + 1]
        )  # fmt: skip
        left, right = (one - y) * near + y * over, (one - y) * far + y * both
        low, high = (one - x) * near + x * far, (one - x) * over + x * both
        by_x, by_y = (right - left) * self.per_m[0], (high - low) * self.per_m[1]
        return list(zip((one - x) * left + x * right, by_x, by_y, strict=True))


class Anchor:
    """sp_anchor_state; amounts: of the map."""

    def __init__(
        self, grid: MapConfig, config: AnchorConfig, amounts: Reals, dtype: type[Any]
    ) -> None:
        self._config, self._amounts, self._real = config, amounts, dtype
        self._first = (grid.first_x_m, grid.first_y_m)
        self._per_m = (grid.per_step_x, grid.per_step_y)
        self._nodes = grid.nodes
        zero = dtype(0)
        self._at, self._stretch, self._object = [zero] * 2, [zero] * 2, [zero] * 2
        self._normal, self._bend, self._touched = zero, zero, False
        self._cell = [0, 0]

    def rest(self, at: Sequence[Any]) -> None:
        """sp_anchor_rest."""
        self._at = [bounded(steps) for steps in self._steps(at)]
        for k, n in enumerate(self._nodes):
            x = self._at[k]
            self._cell[k] = 0 if not x >= 0 else int(x) + 1 if x < self._real(n - 1) else n
        self._stretch, self._touched = [self._real(0)] * 2, False

    def left(self, at: Sequence[Any]) -> bool:
        """sp_anchor_left."""
        steps = self._steps(at)
        return not all(abs(x - its) <= NEAR for x, its in zip(steps, self._at, strict=True))

    def move(
        self,
        was: Sequence[Any],
        at: Sequence[Any],
        touches: bool,
        drawn: Sequence[Any],
        stored_j: Sequence[Any],
    ) -> list[Any]:
        """sp_anchor_move; drawn: the drag's spring, stored_j: each material, in the last tick."""
        stays, self._touched = not (touches and self._touched), touches
        if stays:
            self._stretch = [self._real(0)] * 2
            return [self._real(0)] * 2
        ways = [at[k] - was[k] for k in range(2)]
        self._stretch = [bounded(e + way) for e, way in zip(self._stretch, ways, strict=True)]
        moved = [self._real(0)] * 2
        for _ in range(self._config.ways):
            moved, came = self._slip(moved)
            if not came:
                break
            self._pulled([d + way for d, way in zip(drawn, moved, strict=True)], stored_j)
        return moved

    def let_go(self) -> None:
        """The object does not push: the spring begins anew where it does."""
        self._touched = False

    def cell(self) -> Cell:
        """sp_anchor_cell."""
        nodes, ways, pers = [], [], []
        for k, n in enumerate(self._nodes):
            nodes.append(min(max(self._cell[k] - 1, 0), n - 2))
            way = self._at[k] - self._real(nodes[k])
            ways.append(min(max(way, self._real(0)), self._real(1)))
            pers.append(self._per_m[k] if 0 < self._cell[k] < n else self._real(0))
        return Cell(nodes, ways, pers)

    def feel(self, bend_npm: Any, felt_n: list[Any]) -> list[Any]:
        """sp_anchor_feel."""
        self._bend = bounded(abs(bend_npm) + self._config.drag_npm)
        self._normal = felt_n[2]
        self._object = [bounded(n) for n in felt_n[:2]]
        return [-self._config.stick_npm * e for e in self._stretch] + felt_n[2:]

    def _steps(self, at: Sequence[Any]) -> list[Any]:
        return [(at[k] - self._first[k]) * self._per_m[k] for k in range(2)]

    def _pulled(self, drawn: Sequence[Any], stored_j: Sequence[Any]) -> None:
        """sp_anchor_pulled."""
        cell, drag_npm, zero = self.cell(), self._config.drag_npm, self._real(0)
        felt, bend_npm = [zero] * 2, zero
        here, twists = cell.here(self._amounts), cell.twists(self._amounts)
        for (_, *slopes), twist, its in zip(here, twists, stored_j, strict=True):
            felt = [n - slope * its for n, slope in zip(felt, slopes, strict=True)]
            bend_npm = bend_npm + twist * its
        self._bend = bounded(abs(bend_npm) + drag_npm)
        self._object = [bounded(n - drag_npm * d) for n, d in zip(felt, drawn, strict=True)]

    def _slip(self, before: list[Any]) -> tuple[list[Any], bool]:
        """sp_anchor_slip: the anchor's way with that before, and whether it came to an edge."""
        stick, real = self._config.stick_npm, self._real
        pull = [bounded(stick * e + n) for e, n in zip(self._stretch, self._object, strict=True)]
        x, y = map(abs, pull)
        total = np.sqrt(x * x + y * y)
        excess = total - self._config.friction * self._normal
        if not excess > 0 or not total > real(SMALLEST):
            return before, False
        m_per_n = min(excess / total, real(1)) / (stick + self._bend)
        ways = [bounded(m_per_n * n * per_m) for n, per_m in zip(pull, self._per_m, strict=True)]
        parts = [self._part(k, way) for k, way in enumerate(ways)]
        moved, came = [], False
        for k, way in enumerate(ways):
            cell = self._cell[k]
            went = self._along(k, way * parts[1 - k])
            went_m = went / self._per_m[k]
            self._stretch[k] = flushed(bounded(self._stretch[k] - went_m))
            moved.append(bounded(before[k] + went_m))
            came |= self._cell[k] != cell and bool(abs(went) > 0)
        return moved, came

    def _part(self, k: int, way: Any) -> Any:
        """sp_anchor_part."""
        at, cell, real = self._at[k], self._cell[k], self._real
        to, part, edge = bounded(at + way), real(1), real(cell)
        small = real(SMALLEST)
        if cell < self._nodes[k] and to > edge and way > small:
            part = (edge - at) / way
        elif cell > 0 and to < edge - real(1) and way < -small:
            part = (edge - real(1) - at) / way
        return part if 0 < part < 1 else real(1)

    def _along(self, k: int, way: Any) -> Any:
        """sp_anchor_along."""
        came, cell, real = self._at[k], self._cell[k], self._real
        to = bounded(came + way)
        edge = real(cell)
        if cell < self._nodes[k] and to > edge:
            to, self._cell[k] = edge, cell + 1
        elif cell > 0 and to < edge - real(1):
            to, self._cell[k] = edge - real(1), cell - 1
        self._at[k] = to
        return to - came
