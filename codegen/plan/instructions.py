"""Bound of the instructions of one tick, from the tables: what a budget is checked against.

Costs are of flags.mk's flags with gcc 12 on the target, a little above what the emulated boards
counted; tests hold the bound against the count for every kind of scene. A tick that restarts (the
first one, and one that takes a new position as true) fills the memory besides.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from springpot.codegen.forest.leaves import level_order
from springpot.codegen.model.ir import Forest
from springpot.codegen.plan.plan import Plan
from springpot.codegen.stages.fast_fir import FastFirStage
from springpot.codegen.stages.fir import FirStage
from springpot.codegen.stages.forest import CompactForestStage
from springpot.codegen.stages.hammerstein import HammersteinStage
from springpot.codegen.stages.lags import LagsStage
from springpot.codegen.stages.position_velocity import PositionVelocityStage
from springpot.codegen.stages.rbf import RbfStage
from springpot.codegen.stages.recursive import RecursiveStage

_LEVELS_A_ROUND = 3  # SP_FOREST_UNCHECKED
_FIRST_LEVELS = 4  # SP_FOREST_LEVELS


@dataclass(frozen=True)
class _Costs:
    """Instructions: fixed parts, and of each element of a unit."""

    tick: float
    coupling: float
    tap: float
    tap_row: float
    pole: float
    slow_pole: float
    direct: float
    weight: float
    lane: float
    lag: float
    velocity_step: float
    rank_step: float
    rank: float
    rounding: float
    tree: float
    tree_round: float
    center: float
    passive: float
    branch: float
    power: float
    stop: float
    filled: float


_THUMB = _Costs(
    tick=145, coupling=75, tap=4.5, tap_row=100, pole=16, slow_pole=500, direct=7, weight=4.6,
    lane=10, lag=14, velocity_step=29, rank_step=14, rank=50, rounding=22, tree=72, tree_round=28,
    center=13, passive=25, branch=21, power=8, stop=44, filled=4.2,
)  # fmt: skip
_RISCV = _Costs(
    tick=145, coupling=85, tap=4.6, tap_row=110, pole=20, slow_pole=700, direct=8, weight=6.0,
    lane=12, lag=16, velocity_step=27, rank_step=15, rank=60, rounding=36, tree=90, tree_round=38,
    center=15, passive=25, branch=24, power=7, stop=48, filled=4.8,
)  # fmt: skip
_OF_TARGET = {"cortex-m4f": _THUMB, "cortex-m7": _THUMB, "rv32imafc": _RISCV}


@dataclass(frozen=True)
class InstructionBound:
    """Of sp_step. tick: of any tick but a restart; restart: of that one."""

    tick: int
    restart: int


def instruction_bound(plan: Plan) -> InstructionBound | None:
    """Bound for the plan's target; None for a PC, for doubles in software, and for nested ifs."""
    costs = _OF_TARGET.get(plan.scene.runtime.target)
    regressor = plan.regressor
    if costs is None or plan.real == "double":
        return None
    if regressor is not None and not isinstance(regressor, CompactForestStage | RbfStage):
        return None
    stages = [stage for stage in (plan.passive, *(plan.excess or ())) if stage is not None]
    tick = (
        costs.tick
        + (costs.coupling if plan.couple is not None else 0.0)
        + _features(costs, plan.features)
        + _regressor(costs, plan)
        + sum(_passive(costs, stage) for stage in stages)
    )
    rest = sum(_passive(costs, stage) for stage in stages)
    rest += costs.filled * _memory(plan.features) + 60.0
    return InstructionBound(tick=round(tick), restart=round(tick + rest))


def _features(costs: _Costs, stage: Any) -> float:
    if isinstance(stage, FirStage):
        rows, length = stage.taps.shape
        return float(rows * (length * costs.tap + costs.tap_row))
    if isinstance(stage, FastFirStage):
        terms, lanes = stage.weights.shape
        return float(
            len(stage.keep) * costs.pole
            + stage.n_direct * costs.direct
            + lanes * (terms * costs.weight + costs.lane)
            + 60.0
        )
    if isinstance(stage, RecursiveStage):
        terms, lanes = stage.weights.shape
        return float(
            len(stage.loss) * costs.pole
            + len(stage.slow_loss) * costs.slow_pole
            + lanes * (terms * costs.weight + costs.lane)
            + 40.0
        )
    if isinstance(stage, LagsStage):
        return len(stage.lags) * costs.lag + 40.0
    if isinstance(stage, PositionVelocityStage):
        return float(len(stage.velocity.per_step) * costs.velocity_step + 60.0)
    return 0.0


def _regressor(costs: _Costs, plan: Plan) -> float:
    stage = plan.regressor
    if isinstance(stage, RbfStage):
        return len(stage.weights_n) * costs.center + 100.0
    if not isinstance(stage, CompactForestStage):
        return 0.0
    assert isinstance(plan.model.regressor, Forest)
    below = np.maximum(longest_walks(plan.model.regressor) - _FIRST_LEVELS, 0)
    rounds = below // _LEVELS_A_ROUND + 1
    ranks = sum(len(below_).bit_length() * costs.rank_step for below_ in stage.forest.thresholds)
    each = costs.rounding if stage.rounding is not None else costs.rank
    return float(
        len(below) * costs.tree
        + rounds.sum() * costs.tree_round
        + ranks
        + stage.n_features * each
        + 80.0
    )


def longest_walks(forest: Forest) -> Any:
    """Splits on the longest way to a leaf, of each tree: shape (trees,)."""
    place, level = level_order(forest)
    starts = np.sort(place[forest.roots])
    tree = np.searchsorted(starts, place, side="right") - 1
    longest = np.zeros(len(starts), dtype=np.int64)
    np.maximum.at(longest, tree, level)
    return longest


def _passive(costs: _Costs, stage: HammersteinStage) -> float:
    config = stage.config
    return float(
        costs.passive
        + config.n_branches * (costs.branch + config.degree * costs.power)
        + config.n_stops * costs.stop
    )


def _memory(stage: Any) -> int:
    """Numbers that a restart fills."""
    return sum(len(member.scalars) for member in getattr(stage, "members", ()))
