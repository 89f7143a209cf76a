"""Small-signal stiffness of a model: what acts at once, and the branches that relax meanwhile."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.model.formulas import (
    count_intervals,
    evaluate_curves,
    interpolate_linear,
    locate_on_curve,
)
from springpot.codegen.stages.passive.beside import FUNCTIONS
from springpot.codegen.stages.passive.hammerstein import HammersteinStage

Response = NDArray[np.complex128]
_HELD_DEPTHS = np.arange(0.05, 1.101, 0.05)  # over the trained depth: as deep as a hand holds
_PRESSED_DEPTHS = np.arange(1.15, 1.301, 0.05)  # as deep as a push may come, below the clamp


@dataclass(frozen=True, eq=False)
class ObjectTangent:
    """Slopes of the force at some depths, N/m, for motions so small that stops stick.

    spring_npm: what acts at once, (depths,). branch_npm, decay: slope of each branch, and the
    fraction of its force that it loses in a tick, (depths, branches). is_held: depths at which a
    hand may rest, (depths,); the others are only pressed.
    """

    spring_npm: Samples
    branch_npm: Samples
    decay: Samples
    is_held: NDArray[np.bool_]

    @property
    def is_spring(self) -> bool:
        """True if nothing relaxes: the object is counted stiffer, to a loop, than one that does."""
        return not self.branch_npm.size

    @staticmethod
    def from_spring(stiffness_npm: float) -> "ObjectTangent":
        """Return the tangent of an object that never relaxes."""
        none = np.zeros((1, 0))
        return ObjectTangent(np.array([stiffness_npm]), none, none, np.ones(1, dtype=bool))

    def select_depths(self, count: int) -> "ObjectTangent":
        """Return so many of the held depths, evenly chosen, the deepest among them."""
        held = np.flatnonzero(self.is_held)
        rows = held[np.unique(np.linspace(0, len(held) - 1, count).round().astype(np.intp))]
        return ObjectTangent(
            self.spring_npm[rows], self.branch_npm[rows], self.decay[rows], self.is_held[rows]
        )

    def compute_response(self, z: Response) -> Response:
        """Return the object's dynamic stiffness, force over depth at each z, N/m: (depths, z).

        A branch follows sp_poles.h: h = (1 - l) h + (1 - l/2) (b - b of the tick before).
        """
        back = 1.0 / z
        response = np.tile(self.spring_npm[:, None].astype(np.complex128), len(z))
        for slope_npm, decay in zip(self.branch_npm.T, self.decay.T, strict=True):
            if slope_npm.any():
                lost = decay[:, None]
                passed = (1.0 - 0.5 * lost) * (1.0 - back) / (1.0 - (1.0 - lost) * back)
                response += slope_npm[:, None] * passed
        return response


def compute_passive_tangent(
    stage: HammersteinStage, base_m: float, span_m: float, max_n: float
) -> ObjectTangent:
    """Linearise a passive model at rest at each depth, for the stability of the closed loop.

    base_m, span_m: where the trained depth begins, and its length, m. Depths whose force at rest
    exceeds max_n, N, are left out: the clamp keeps the force constant there, so its slope is 0.
    """
    config = stage.config
    u_per_m = float(config.u_per_m)
    depths = np.concatenate([_HELD_DEPTHS, _PRESSED_DEPTHS])
    u = (base_m + span_m * depths - float(config.origin_m)) * u_per_m
    location = locate_on_curve(u, config.n_intervals)
    in_contact_per_m = u_per_m * (u > 0.0)

    def evaluate_slopes(nodes: Samples) -> Samples:
        """Slopes of curves (nodes, 2, curves), N/m: (depths, curves)."""
        per_interval = interpolate_linear(nodes[:, 1].astype(np.float64), location)
        slopes = per_interval * count_intervals(config.n_intervals) * in_contact_per_m[:, None]
        return np.asarray(slopes)

    spring = stage.spring[:, :, None].astype(np.float64)
    spring_npm = evaluate_slopes(spring)[:, 0]
    static_n = evaluate_curves(spring, location)[:, 0]
    if stage.flow is not None:
        degree = np.array(FUNCTIONS, dtype=np.float64)[stage.flow.function]
        depth = np.clip(u, 0.0, 1.0)[:, None]
        per_u = (degree * depth ** (degree - 1.0)) @ stage.flow.force_n.astype(np.float64)
        spring_npm += per_u * in_contact_per_m
    if stage.damage is not None:
        # Below the largest depth M so far a curve is g(v) (v/M)^q; its slope at v = M: g' + q g/v.
        power = np.where(np.arange(stage.damage.count) < stage.damage.n_linear, 1.0, 3.0)
        curves = stage.damage.curves.astype(np.float64)
        damage_n = evaluate_curves(curves, location)
        spring_npm += evaluate_slopes(curves).sum(axis=1)
        spring_npm += (damage_n @ power) * in_contact_per_m / np.maximum(u, 1e-9)
        static_n += damage_n.sum(axis=1)
    decay = np.concatenate([
        interpolate_linear(step.loss.astype(np.float64), location) if step.by_depth
        else np.tile(step.loss.astype(np.float64), (len(u), 1))
        for step in stage.steps
    ], axis=1)  # fmt: skip
    is_held = depths <= _HELD_DEPTHS[-1]
    kept = static_n + float(config.bias_n) < max_n
    kept[0] = True  # a tangent needs a depth
    branch_npm = evaluate_slopes(stage.branches)
    return ObjectTangent(spring_npm[kept], branch_npm[kept], decay[kept], is_held[kept])
