"""The balance of energy within a tick, of the reference, which the C equals bit for bit.

A tool rubs fast over a fine grid, several cells a tick. Whatever it does, the place moves by the
work of the springs alone, and what is renewed is paid for.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from codegen.stages.test_sliding_energy import SPAN_M, placed, plan_of, random_model

from springpot.codegen.model.formulas import curve_place
from springpot.codegen.model.places import Places
from springpot.codegen.reference.anchor import Anchor
from springpot.codegen.reference.lateral_motion import LateralMotion
from springpot.codegen.stages.passive.stored import stored
from springpot.emission import Plan, make_plan

CELLS, TICKS = 4, 400
ROUNDING = 1e-14  # of peak force times depth


class Watched(LateralMotion):
    """moved_j, renewed_j: by how much each tick's stored energy grew above what was paid for."""

    def __init__(self, plan: Plan) -> None:
        super().__init__(plan.lateral, np.float64)
        self.moved_j, self.renewed_j = [0.0], [0.0]
        self._paid_j = 0.0

    def _object_j(self) -> float:
        place = curve_place(np.array([self._u]), self._stage.of_one.config.n_pieces)
        here = self._place.cell().here(self._stage.placed.amounts)
        return sum(
            float(amount * stored(its, areas, place, *motion.memory)[0] * self._stage.m_per_piece)
            for motion, its, areas, (amount, *_) in zip(
                self._materials, self._stage.materials, self._stage.areas, here, strict=True
            )
        )

    def _springs_j(self, stretch_m: Sequence[Any]) -> float:
        stick, drag = self._stage.anchor.stick_npm, self._stage.drag.stiffness_npm
        return float(0.5 * (stick * np.square(stretch_m).sum() + drag * self._drawn_j()))

    def _drawn_j(self) -> float:
        return float(np.square(self._drawn).sum())

    def _move(self, at: list[Any], touches: bool) -> None:
        was, stretch = list(self.at), list(self._place._stretch)
        before_j = self._object_j() + self._springs_j(stretch)
        slides = touches and self._place._touched
        if slides:
            drawn = [e + at[k] - was[k] for k, e in enumerate(stretch)]
            before_j += self._springs_j(drawn) - self._springs_j(stretch)
        super()._move(at, touches)
        self.moved_j.append(self._object_j() + self._springs_j(self._place._stretch) - before_j)

    def _renew(self, amounts: list[tuple[Any, Any, Any]]) -> None:
        before_j = self._object_j()
        super()._renew(amounts)
        self.renewed_j.append(self._object_j() - before_j - self._paid_j)

    def _slip(self, u: Any, renewal_j: Any, felt: list[Any]) -> Any:
        before_j = self._drawn_j()
        renewed = super()._slip(u, renewal_j, felt)
        stiffness_npm = float(self._stage.drag.stiffness_npm)
        self._paid_j = 0.5 * stiffness_npm * (before_j - self._drawn_j())
        return renewed


def rubbed(seed: int, step_m: float, friction: float) -> tuple[float, float]:
    """The most that a move and a renewal add, over peak force x depth."""
    model, rng = random_model(seed), np.random.default_rng(seed)
    law = model.hammerstein
    size = (CELLS, CELLS, len(law.places.slopes_n))
    amounts = rng.exponential(5.0, size) * (rng.uniform(size=size) < 0.6) + 0.01
    grid = Places(np.zeros(2), np.full(2, step_m), amounts, law.places.slopes_n)
    bare = plan_of(placed(replace(law, places=None), grid))
    places = replace(bare.scene.places, friction=friction)
    watched = Watched(make_plan(bare.model, replace(bare.scene, places=places)))
    ticks = np.arange(TICKS)
    rubs = np.maximum(ticks - 200, 0)
    x, y = (0.5 * (CELLS - 1) * (1.0 + 0.95 * np.sin(w * rubs)) for w in (0.35, 0.27))
    depth = np.interp(ticks, [0, 200, TICKS - 10, TICKS], [-0.01, 0.8, 0.8, -0.01])
    position_m = np.column_stack([step_m * x, step_m * y, SPAN_M * depth])
    watched.rest(list(position_m[0]))
    peak_n = max(np.linalg.norm(watched.tick(list(at))[0]) for at in position_m)
    scale_j = float(peak_n) * 0.8 * SPAN_M
    return max(watched.moved_j) / scale_j, max(watched.renewed_j) / scale_j


def most(seeds: Sequence[int]) -> np.ndarray:
    found: np.ndarray = np.max(
        [rubbed(seed, step_m, friction)
         for seed in seeds for step_m in (5e-4, 5e-3) for friction in (0.0, 0.3)], axis=0
    )  # fmt: skip
    return found


@pytest.mark.parametrize("seeds", [(39,), pytest.param(range(30, 40), marks=pytest.mark.slow)])
def test_neither_a_move_nor_fresh_ground_adds_energy_within_a_tick(seeds: Sequence[int]) -> None:
    assert np.all(most(seeds) < ROUNDING)


def test_a_cell_left_with_the_slope_of_the_one_before_is_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Anchor, "_pulled", lambda *_: None)
    assert most(range(2))[0] > 1e4 * ROUNDING


def test_ground_renewed_where_it_takes_more_than_was_paid_is_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def renew(self: LateralMotion, _amounts: object) -> None:
        for motion in self._materials if self._renewed > 0 else ():
            motion.renew(self._renewed)

    monkeypatch.setattr(LateralMotion, "_renew", renew)
    assert rubbed(39, 5e-3, 0.0)[1] > 1e4 * ROUNDING
