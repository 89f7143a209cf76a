"""Decide if the surface of an object recovers while the tool is away, and fit it so.

A passive model is fitted along the tool's way. If its surface recovers (sp_surface.h), it is not
where the tool is while that is away, and what it remembers is another thing. So it is fitted again
along the way that it took itself, a few times, and stays if it explains the recordings better.
"""

from dataclasses import replace
from math import inf

import numpy as np

from springpot.codegen.arrays import rms
from springpot.codegen.model.passive import Hammerstein
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.passive.nonnegative import normal_equations, sparse_solve
from springpot.trainer.models.passive.passive_force import simulate_passive
from springpot.trainer.models.passive.passive_rows import PassiveRows
from springpot.trainer.models.passive.passive_terms import Terms, build_model, keep_used_terms
from springpot.trainer.models.passive.term_values import build_design_matrices
from springpot.trainer.models.training_set import TrainingSet

_MIN_SEPARATED_FRACTION = 0.002  # of the rows: so few in which the object lets go change nothing
_MAX_ERROR_RATIO = 1.01  # times the error of a force that is cut at 0
_MAX_ROUNDS, _MAX_ROUND_RATIO = 7, 0.97  # along its own way, as long as each has so much less error
SPARSE_LOSS = 0.005  # of the error: what few branches, stops and curves may add
_GAP_TOLERANCE = 1e-9  # of the trained depth


def fit_recovery(
    model: Hammerstein, terms: Terms, penalty: float, rows: PassiveRows, data: TrainingSet
) -> Hammerstein:
    """Fit a surface that recovers while the tool is away; return that model if it errs no more.

    Only if the object lets go. terms: those that it was chosen from, and is chosen from once more;
    penalty: on their roughness.
    """
    if not rows.surface or float(np.mean(rows.separated)) < _MIN_SEPARATED_FRACTION:
        return model
    clamped = _SurfaceMotion(model, rows, data)
    best, limit_n = model, _MAX_ERROR_RATIO * clamped.error_n
    candidate, last_n = replace(model, recovers=True), inf
    for _ in range(_MAX_ROUNDS):
        motion = _SurfaceMotion(candidate, rows, data)
        if motion.error_n <= limit_n:
            best, limit_n = candidate, motion.error_n
        if not motion.detached.any() or motion.error_n > _MAX_ROUND_RATIO * last_n:
            break
        fitted, terms = motion.refit(terms, penalty, sparse=last_n == inf)
        candidate, last_n = replace(fitted, recovers=True), motion.error_n
    return best


class _SurfaceMotion:
    """A model along the training recordings: where it was, and its error there, N."""

    def __init__(self, model: Hammerstein, rows: PassiveRows, data: TrainingSet) -> None:
        """Simulate a model over the set: depths of its surface, and rows without contact."""
        self._rows, self._data, self._at = rows, data, data.rows_by_motion(rows.rows)
        self._motions, forces_n, gaps_m = list[DepthMotion](), [], []
        for motion, rows_here in zip(data.motions, self._at, strict=True):
            force_n, depth_m, _ = simulate_passive(model, motion, data.dt_s, rows.surface)
            self._motions.append(replace(motion, depth_m=depth_m))
            forces_n.append(force_n[rows_here])
            gaps_m.append((depth_m - motion.depth_m)[rows_here])
        self.detached = data.to_row_order(rows.rows, gaps_m) > _GAP_TOLERANCE * model.span_m
        self.error_n = rms(data.to_row_order(rows.rows, forces_n) - rows.force_n)

    def refit(self, terms: Terms, penalty: float, sparse: bool) -> tuple[Hammerstein, Terms]:
        """Fit again along the surface's motion, to the rows in which the tool is on it."""
        columns_by_motion = build_design_matrices(terms, self._motions, self._data.dt_s, self._at)
        values = self._data.to_row_order(self._rows.rows, columns_by_motion)[~self.detached]
        normalised_force = self._rows.force_n[~self.detached] / self._rows.peak_n
        normal = normal_equations(values, normalised_force).penalised(penalty * terms.roughness())
        weights = sparse_solve(normal, terms.blocks, SPARSE_LOSS) if sparse else normal.solve()
        return build_model(terms, self._rows.peak_n * weights), keep_used_terms(terms, weights)
