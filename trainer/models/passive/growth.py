"""Choose whether slopes grow beyond the trained depth, by presses within it."""

from dataclasses import replace

import numpy as np

from springpot.codegen.arrays import Indices, Samples, rms
from springpot.codegen.model.passive import Hammerstein
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.folds import geometric_mean
from springpot.trainer.models.passive.nonnegative import normal_equations
from springpot.trainer.models.passive.passive_force import model_along
from springpot.trainer.models.passive.passive_rows import NEGLIGIBLE, PassiveRows
from springpot.trainer.models.passive.passive_terms import Terms, reduced, to_model
from springpot.trainer.models.passive.term_values import term_columns
from springpot.trainer.models.training_set import TrainingSet

GROWTHS = (1.0, 2.0)
_SHARES = (0.7, 0.85)  # of the trained depth: that far a trial is fitted
_CLEARLY, _NO_WORSE = 0.9, 1.02  # times the error, in all and at each share
_FEWEST = 10  # rows of a trial, and of its test


def growing(
    model: Hammerstein, terms: Terms, weights: Samples, penalty: float, rows: PassiveRows,
    data: TrainingSet,
) -> Hammerstein:  # fmt: skip
    """Return the model with the growth that would have predicted its own deepest presses best.

    Laws of its terms are fitted to the way in to a share of the depth. Silicone cylinders a quarter
    deeper than trained were missed by 43 to 48 % of the peak with a constant slope, and are by 12
    to 14 % with growth (compression tests of Dawood's tissue phantom database); by 4 to 6 % and .1
    to 3 % in tension (Marechal's soft robotics database). Some soften there: they keep a constant
    slope.
    """
    terms = reduced(terms, weights)
    deepest_m = data.along_motions(
        rows.rows, lambda motion, at: np.maximum.accumulate(motion.depth_m)[at]
    )
    tried = [_errors_n(terms, share, deepest_m, penalty, rows, data) for share in _SHARES]
    if not all(tried):
        return model
    constant, *grown = np.hypot(np.transpose(tried), NEGLIGIBLE * rows.peak_n)
    times = [its / constant for its in grown]
    allowed = [k for k, its in enumerate(times) if its.max() <= _NO_WORSE]
    best = min(allowed, key=lambda k: geometric_mean(times[k]), default=None)
    if best is None or geometric_mean(times[best]) > _CLEARLY:
        return model
    return replace(model, growth=GROWTHS[best])


def _errors_n(
    terms: Terms, share: float, deepest_m: Samples, penalty: float, rows: PassiveRows,
    data: TrainingSet,
) -> list[float]:  # fmt: skip
    """Errors beyond a share of the depth, N, of laws fitted to the way there: one each growth.

    deepest_m: how deep each row's motion has been, (rows,). Empty if too few rows are on either
    side.
    """
    terms = replace(terms, span_m=share * terms.span_m)
    depth_m = np.concatenate(data.depths_m)[rows.rows]
    before = (terms.shares(deepest_m) <= 1.0) & ~rows.let_go
    beyond = (terms.shares(depth_m) > 1.0) & ~rows.let_go
    if min(np.count_nonzero(before), np.count_nonzero(beyond)) < _FEWEST:
        return []
    values = term_columns(terms, data, rows.rows)
    normal = normal_equations(values[before], rows.force_n[before] / rows.peak_n)
    weights = rows.peak_n * normal.penalised(penalty * terms.roughness()).solve()
    law = to_model(terms, weights)

    def error_n(growth: float) -> float:
        model = replace(law, growth=growth)

        def force_n(motion: DepthMotion, at: Indices) -> Samples:
            if terms.shares(motion.depth_m).max() <= 1.0:  # not asked for
                return np.zeros(len(at))
            return model_along(model, motion, data.dt_s, surface=False)[0][at]

        return rms((data.along_motions(rows.rows, force_n) - rows.force_n)[beyond])

    constant_n = rms((values @ weights - rows.force_n)[beyond])
    return [constant_n, *map(error_n, GROWTHS)]
