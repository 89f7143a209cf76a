"""Reference of the materials of a map under a tool of three axes: `tick3` of the emitted C."""

from typing import Any

import numpy as np

from springpot.codegen.model.formulas import curve_place
from springpot.codegen.reference.anchor import Anchor
from springpot.codegen.stages.passive.lateral import LateralStage
from springpot.codegen.stages.passive.motion import PassiveMotion
from springpot.codegen.stages.passive.stored import RENEWED, stored
from springpot.codegen.stages.passive.surface import RecoveringSurface
from springpot.codegen.stages.stage import SMALLEST, bounded


class LateralMotion:
    """State of all materials, and of their place: sp_lateral.h, sp_drag.h."""

    def __init__(self, stage: LateralStage, dtype: type[Any]) -> None:
        self._stage, self._real = stage, dtype
        zero = dtype(0)
        self.at = [zero, zero, zero]
        self._drawn, self._renewed = [zero, zero], zero
        config = stage.placed.config
        self._place = Anchor(config, stage.anchor, stage.placed.amounts, dtype)
        self._stored = [zero] * len(stage.materials)
        self._takes, self._paid = list(self._stored), zero
        self._materials: list[PassiveMotion] = []
        self._u: Any = zero
        self._force_n: Any = zero

    def rest(self, at: list[Any]) -> None:
        """restart3."""
        self._u, self._force_n = self._share(at[2]), self._real(0)
        self._materials = [PassiveMotion(its, self._u) for its in self._stage.materials]
        self.at, self._drawn, self._renewed = list(at), [self._real(0)] * 2, self._real(0)
        self._place.rest(at)

    def tick(self, at: list[Any]) -> tuple[list[Any], bool, bool]:
        """Force, N, whether the object pushes, and whether the place is on the grid."""
        inside = bool(at[2] > 0)
        if not inside and self._place.left(at):
            self.rest(at)
        tool = self._share(at[2])
        u = self._surface(tool)
        touches = inside and not u > tool
        self._move(at, touches)
        cell = self._place.cell()
        amounts = cell.here(self._stage.placed.amounts)
        self._renew(amounts)
        self._stored, self._takes = [], []
        felt, renewal_j = [self._real(0)] * 3, self._real(0)
        bend_npm = self._real(0)
        place = curve_place(np.array([u]), self._stage.of_one.config.n_pieces)
        twists = cell.twists(self._stage.placed.amounts)
        for motion, its, areas, here, twist in zip(
            self._materials, self._stage.materials, self._stage.areas, amounts, twists, strict=True
        ):
            force_n, _ = motion.along(np.array([u]))
            held, play = motion.memory
            m_per_piece = self._stage.m_per_piece
            pieces, renewal = stored(its, areas, place, held, play)
            stored_j = bounded(pieces * m_per_piece)
            self._stored.append(stored_j)
            self._takes.append(bounded(renewal * m_per_piece))
            renewal_j = renewal_j + here[0] * self._takes[-1]
            felt[0] = felt[0] - here[1] * stored_j
            felt[1] = felt[1] - here[2] * stored_j
            felt[2] = felt[2] + here[0] * force_n[0]
            bend_npm = bend_npm + twist * stored_j
        self._u, self._force_n, self._paid = u, felt[2], bounded(renewal_j)
        pushes = touches and bool(felt[2] > 0)
        self._renewed = self._slip(u, renewal_j, felt) if pushes else self._real(0)
        on_grid = bool(cell.per_m[0] > 0 and cell.per_m[1] > 0)
        if pushes:
            felt = self._place.feel(bend_npm, felt)
        else:
            self._place.let_go()
        return felt, pushes, on_grid

    def _move(self, at: list[Any], touches: bool) -> None:
        """sp_lateral_move."""
        moved = self._place.move(self.at, at, touches, self._drawn, self._stored)
        zero = self._real(0)
        self._drawn = [
            bounded(drawn + way) if touches else zero
            for drawn, way in zip(self._drawn, moved, strict=True)
        ]
        self.at = list(at)

    def _renew(self, amounts: list[tuple[Any, Any, Any]]) -> None:
        """sp_drag_afforded, and what it says."""
        takes, share = self._real(0), self._renewed
        for here, its in zip(amounts, self._takes, strict=True):
            takes = takes + here[0] * its
        if takes > self._paid:
            some = self._paid > 0 and takes > self._real(SMALLEST)
            part = self._paid / takes if some else self._real(0)
            share = share * part if part < 1 else share
        for motion in self._materials if share > 0 else ():
            motion.renew(share)

    def _slip(self, u: Any, renewal_j: Any, felt: list[Any]) -> Any:
        """sp_drag_slip."""
        config, zero = self._stage.drag, self._real(0)
        x, y = map(abs, self._drawn)
        drawn = np.sqrt(x * x + y * y)
        width = config.width_m * np.sqrt(u if u > 0 else zero)
        most = config.stiffness_npm * width * drawn
        renewed = zero
        if most > self._real(SMALLEST) and most > renewal_j:
            stays = renewal_j / most if renewal_j > 0 else zero
            renewed = min((drawn - stays * drawn) / width, self._real(RENEWED))
            self._drawn = [each * stays for each in self._drawn]
        for k in range(2):
            felt[k] = felt[k] - config.stiffness_npm * self._drawn[k]
        return renewed

    def _share(self, depth: Any) -> Any:
        config = self._stage.of_one.config
        return ((depth if depth > 0 else self._real(0)) - config.origin_m) * config.per_span

    def _surface(self, tool: Any) -> Any:
        if not tool < self._u:
            return tool
        placed, pieces = self._stage.placed, self._stage.of_one.config.n_pieces
        begin = placed.begins["stiffest"]
        of_materials = placed.materials[:, begin : begin + pieces]
        amounts = self._place.cell().here(placed.amounts)
        stiffest = amounts[0][0] * of_materials[0]
        for here, its in zip(amounts[1:], of_materials[1:], strict=True):
            stiffest = stiffest + here[0] * its
        surface = RecoveringSurface(np.maximum(stiffest, placed.least))
        return surface.at(tool, self._u, self._force_n)
