"""Continue curves beyond the trained depth as presses within it foretell."""

from dataclasses import replace

import numpy as np

from springpot.codegen.arrays import Indices, Samples, rms
from springpot.codegen.model.passive import Hammerstein, Memory
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.passive.nonnegative import normal_equations
from springpot.trainer.models.passive.passive_force import model_along
from springpot.trainer.models.passive.passive_rows import NEGLIGIBLE, PassiveRows
from springpot.trainer.models.passive.passive_terms import Terms, reduced, to_model
from springpot.trainer.models.passive.term_values import term_columns
from springpot.trainer.models.training_set import TrainingSet

# Powers of the slope that are straight in the depth: slopes grow as (1 + c u)^5, exp(c u), or as
# 1/(1 - c u)^3 where pores close.
POWERS = (0.2, 0.0, -1.0 / 3.0)
_CLEARLY = 0.9  # times the error of a constant slope
_SHARES = (0.85, 0.9, 0.95)  # of the trained depth: that far a trial is fitted
_FEWEST = 10  # rows of a trial, and of its test
_SHARPNESS = 8  # a law weighs by so many times its error, inverted
_FURTHER = 1.25  # times the trained depth: there slopes stop growing
_TOP, _FEWEST_PIECES = 0.3, 3  # share of the pieces that the growth is fitted to
_LEAST, _STEEPEST = 1e-2, 8.0  # times the slope at the trained depth


def growth_weights(
    terms: Terms, weights: Samples, penalty: float, rows: PassiveRows, data: TrainingSet
) -> Samples | None:
    """Weigh a constant slope and each of `POWERS` by what they foretell deeper: (4,), sum 1.

    None if none foretells it clearly better than a constant slope does. Laws of the terms with
    weights are fitted to the way in to a share of the depth, and tested on the rest. A mean errs
    less than the best of them, which chance decides where two are close.
    """
    terms = reduced(terms, weights)
    deepest_m = data.along_motions(
        rows.rows, lambda motion, at: np.maximum.accumulate(motion.depth_m)[at]
    )
    tried = [_errors_n(terms, share, deepest_m, penalty, rows, data) for share in _SHARES]
    if not all(tried):
        return None
    errors_n = np.exp(np.log(np.hypot(tried, NEGLIGIBLE * rows.peak_n)).mean(axis=0))
    if errors_n.min() > _CLEARLY * errors_n[0]:
        return None
    found = (errors_n.min() / errors_n) ** _SHARPNESS
    return np.asarray(found / found.sum(), dtype=np.float64)


def _errors_n(
    terms: Terms, share: float, deepest_m: Samples, penalty: float, rows: PassiveRows,
    data: TrainingSet,
) -> list[float]:  # fmt: skip
    """RMSE beyond a share of the depth, N, of laws fitted to the way there: constant, `POWERS`.

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

    def error_n(only: Samples) -> float:
        model = continued(law, only)

        def force_n(motion: DepthMotion, at: Indices) -> Samples:
            if terms.shares(motion.depth_m).max() <= 1.0:  # not asked for
                return np.zeros(len(at))
            return model_along(model, motion, data.dt_s, surface=False)[0][at]

        return rms((data.along_motions(rows.rows, force_n) - rows.force_n)[beyond])

    constant_n = rms((values @ weights - rows.force_n)[beyond])
    return [constant_n, *map(error_n, np.eye(1 + len(POWERS))[1:])]


def continued(model: Hammerstein, weights: Samples) -> Hammerstein:
    """Give a model nodes to 1.25 of its depth; the force within the depth stays the same.

    weights: see `growth_weights`. The C has nodes alone: what is deeper needs no code.
    """
    if model.places is not None:
        own = (model.with_slopes(slopes_n) for slopes_n in model.places.slopes_n)
        made = [continued(material, weights) for material in own]
        places = replace(model.places, slopes_n=np.stack([its.slopes_n for its in made]))
        return replace(made[0].with_slopes(places.most_n), places=places)

    def longer(slopes_n: Samples) -> Samples:
        return _FURTHER * _longer(slopes_n, weights)

    # u' = u/1.25 is the share of the new depth. Rates: q^(1/2 - u)/tau = q'^(1/2 - u')/tau'.
    ratio = model.rate_ratio**_FURTHER
    slower = np.where(model.by_depth, ratio ** (0.5 - 0.5 / _FURTHER), 1.0)
    flow, memory = model.flow, model.memory
    held = memory.flow
    if flow is not None:  # b = u^degree is as many times b', and so is h
        unit = _FURTHER**flow.degree
        rate_ps, force_n = flow.rate_ps * unit ** (flow.power - 1.0), flow.force_n * unit
        flow, held = replace(flow, rate_ps=rate_ps, force_n=force_n), held / unit
    return replace(
        model,
        span_m=_FURTHER * model.span_m,
        elastic_n=longer(model.elastic_n[None])[0],
        tau_s=model.tau_s * slower,
        branch_n=longer(model.branch_n),
        stop_n=longer(model.stop_n),
        rate_ratio=ratio,
        flow=flow,
        damage=model.damage and replace(model.damage, curve_n=longer(model.damage.curve_n)),
        conditioned=Memory(memory.branch_n, held, memory.deepest / _FURTHER),
    )


def _longer(slopes_n: Samples, weights: Samples) -> Samples:
    """Slopes (curves, J) with further nodes up to 1.25, as dense as those.

    Of each power, a line through the last node, of least squares of the slope at those before. Each
    curve grows by itself: real cylinders of silicone have an error of half of that with one factor
    for all.
    """
    pieces, last_n = slopes_n.shape[1] - 1, slopes_n[:, -1:]
    further = np.arange(1, round((_FURTHER - 1.0) * pieces) + 1) / pieces
    top = max(round(_TOP * pieces), _FEWEST_PIECES)
    u = np.arange(-top, 0) / pieces
    before = slopes_n[:, -1 - top : -1] / np.where(last_n > 0.0, last_n, 1.0)
    before = np.maximum(before, _LEAST)
    found = [np.ones((len(slopes_n), len(further)))]
    for power in POWERS:
        straight = np.log(before) if power == 0.0 else (before**power - 1.0) / power
        steep = before ** (1.0 - power)  # how much a slope changes by one of its power
        rate = (steep**2 * u * straight).sum(axis=1) / np.sum((steep * u) ** 2, axis=1)
        rises = np.maximum(rate, 0.0)[:, None] * further
        if power == 0.0:
            times = np.exp(rises)
        else:
            times = np.maximum(1.0 + power * rises, 1e-6) ** (1.0 / power)
        found.append(np.minimum(times, _STEEPEST))
    grown = np.tensordot(weights, np.stack(found), axes=1)
    return np.concatenate([slopes_n, last_n * grown], axis=1)
