"""Whether the surface of an object recovers while the tool is away, and what fits it then.

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
from springpot.trainer.models.passive.passive_force import model_along
from springpot.trainer.models.passive.passive_rows import PassiveRows
from springpot.trainer.models.passive.passive_terms import Terms, reduced, to_model
from springpot.trainer.models.passive.term_values import columns
from springpot.trainer.models.training_set import TrainingSet

_SELDOM = 0.002  # of the rows: so few in which the object lets go change nothing
_AS_GOOD = 1.01  # times the error of a force that is cut at 0
_ROUNDS, _GAIN = 7, 0.97  # along its own way, as long as each has so much less error
SPARSE_LOSS = 0.005  # of the error: what few branches, stops and curves may add
_ROUNDING = 1e-9  # of the trained depth


def recovering(
    model: Hammerstein, terms: Terms, penalty: float, rows: PassiveRows, data: TrainingSet
) -> Hammerstein:
    """The model, or one that recovers, if the object lets go and it has no more error.

    terms: those that it was chosen from, and is chosen from once more; penalty: on their roughness.
    """
    if not rows.surface or float(np.mean(rows.let_go)) < _SELDOM:
        return model
    clamped = _Way(model, rows, data)
    best, limit_n = model, _AS_GOOD * clamped.error_n
    trial, last_n = replace(model, recovers=True), inf
    for _ in range(_ROUNDS):
        way = _Way(trial, rows, data)
        if way.error_n <= limit_n:
            best, limit_n = trial, way.error_n
        if not way.away.any() or way.error_n > _GAIN * last_n:
            break
        fitted, terms = way.fitted(terms, penalty, sparse=last_n == inf)
        trial, last_n = replace(fitted, recovers=True), way.error_n
    return best


class _Way:
    """A model along the training recordings: where it was, and its error there, N."""

    def __init__(self, model: Hammerstein, rows: PassiveRows, data: TrainingSet) -> None:
        self._rows, self._data, self._at = rows, data, data.motion_rows(rows.rows)
        self._motions, forces_n, beyond_m = list[DepthMotion](), [], []
        for motion, at in zip(data.motions, self._at, strict=True):
            force_n, depth_m, _ = model_along(model, motion, data.dt_s, rows.surface)
            self._motions.append(replace(motion, depth_m=depth_m))
            forces_n.append(force_n[at])
            beyond_m.append((depth_m - motion.depth_m)[at])
        self.away = data.in_order(rows.rows, beyond_m) > _ROUNDING * model.span_m
        self.error_n = rms(data.in_order(rows.rows, forces_n) - rows.force_n)

    def fitted(self, terms: Terms, penalty: float, sparse: bool) -> tuple[Hammerstein, Terms]:
        """Fitted again, along this way, to the rows in which the tool was not away; its terms."""
        found = columns(terms, self._motions, self._data.dt_s, self._at)
        values = self._data.in_order(self._rows.rows, found)[~self.away]
        share = self._rows.force_n[~self.away] / self._rows.peak_n
        normal = normal_equations(values, share).penalised(penalty * terms.roughness())
        weights = sparse_solve(normal, terms.blocks, SPARSE_LOSS) if sparse else normal.solve()
        return to_model(terms, self._rows.peak_n * weights), reduced(terms, weights)
