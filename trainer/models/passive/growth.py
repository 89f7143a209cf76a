"""Continue curves beyond the trained depth as presses within it foretell."""

from dataclasses import dataclass, replace

import numpy as np

from springpot.codegen.arrays import Indices, Samples, rms
from springpot.codegen.model.passive import Hammerstein
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.passive.nonnegative import normal_equations
from springpot.trainer.models.passive.passive_force import simulate_passive
from springpot.trainer.models.passive.passive_rows import IMPERCEPTIBLE_FRACTION, PassiveRows
from springpot.trainer.models.passive.passive_terms import Terms, build_model, keep_used_terms
from springpot.trainer.models.passive.term_values import build_design_matrix
from springpot.trainer.models.training_set import TrainingSet

# Powers of the slope that are straight in the depth: slopes grow as (1 + c u)^5, exp(c u), or as
# 1/(1 - c u)^3 where pores close.
SLOPE_POWERS = (0.2, 0.0, -1.0 / 3.0)
_STRAIGHT = 1.0  # power of a slope that itself rises straight
_MAX_ERROR_RATIO = 0.9  # times the error of a constant slope
_TRIAL_DEPTHS = (0.85, 0.9, 0.95)  # of the trained depth: that far a trial is fitted
_MIN_ROWS = 10  # rows of a trial, and of its test
_ERROR_EXPONENT = 4  # a law weighs by so many times its error, inverted
_EXTENSION_RATIO = 1.25  # times the trained depth: there slopes stop growing
_TOP_FRACTION, _MIN_INTERVALS = 0.3, 3  # share of the pieces that the growth is fitted to
_MIN_SLOPE_RATIO, _MAX_SLOPE_RATIO = 1e-2, 8.0  # times the slope at the trained depth
# Times the slope of all curves together there: of 72 simulated objects, a soft layer on a stiff one
# was given 1.4 times its force at half as deep again; with 2.5 it is 1.5 times, with 8 3.3 times.
_MAX_TOTAL_RATIO = 2.25


@dataclass(frozen=True)
class Growth:
    """How slopes go on: weights of a constant one and of each of `SLOPE_POWERS`, (4,), sum 1.

    foretold: by what the laws say of presses within the depth; else the slope of all curves
    together rises by no more than a straight line through its last part does.
    """

    weights: Samples
    foretold: bool


def estimate_growth(
    terms: Terms, weights: Samples, penalty: float, rows: PassiveRows, data: TrainingSet
) -> Growth | None:
    """Weigh laws of growth beyond the depth by how well they foretell the deeper part within.

    A constant slope and each of `SLOPE_POWERS`. None if there are too few rows to tell. The laws,
    of the terms with weights, are fitted to the way in to a share of the depth, and tested on the
    rest. A mean errs less than the best of them, which chance decides where two are close: also
    where none is clearly better than a constant slope, which few objects have.
    """
    terms = keep_used_terms(terms, weights)
    deepest_m = data.map_motions(
        rows.rows, lambda motion, at: np.maximum.accumulate(motion.depth_m)[at]
    )
    trials_n = [
        _extrapolation_rmse_n(terms, share, deepest_m, penalty, rows, data)
        for share in _TRIAL_DEPTHS
    ]
    if not all(trials_n):
        return None
    errors_n = np.exp(np.log(np.hypot(trials_n, IMPERCEPTIBLE_FRACTION * rows.peak_n)).mean(axis=0))
    foretold = bool(errors_n.min() <= _MAX_ERROR_RATIO * errors_n[0])
    likelihood = (errors_n.min() / errors_n) ** _ERROR_EXPONENT
    likelihood[0] *= not foretold
    return Growth(likelihood / likelihood.sum(), foretold)


def _extrapolation_rmse_n(
    terms: Terms, depth_fraction: float, deepest_m: Samples, penalty: float, rows: PassiveRows,
    data: TrainingSet,
) -> list[float]:  # fmt: skip
    """Compute the RMSE beyond a share of the depth, N, of laws fitted to the way there.

    The first one is that of a constant slope, the others of each of `SLOPE_POWERS`.

    deepest_m: how deep each row's motion has been, (rows,). Empty if too few rows are on either
    side.
    """
    terms = replace(terms, span_m=depth_fraction * terms.span_m)
    depth_m = np.concatenate(data.depths_m)[rows.rows]
    before = (terms.normalised_depth(deepest_m) <= 1.0) & ~rows.separated
    beyond = (terms.normalised_depth(depth_m) > 1.0) & ~rows.separated
    if min(np.count_nonzero(before), np.count_nonzero(beyond)) < _MIN_ROWS:
        return []
    values = build_design_matrix(terms, data, rows.rows)
    normal = normal_equations(values[before], rows.force_n[before] / rows.peak_n)
    weights = rows.peak_n * normal.penalised(penalty * terms.roughness()).solve()
    model = build_model(terms, weights)

    def error_n(law_weights: Samples) -> float:
        """Return the RMSE beyond the share of depth, N, of a mean of laws."""
        extrapolated = extrapolate_curves(model, Growth(law_weights, foretold=True))

        def force_n(motion: DepthMotion, at: Indices) -> Samples:
            if terms.normalised_depth(motion.depth_m).max() <= 1.0:  # not asked for
                return np.zeros(len(at))
            return simulate_passive(extrapolated, motion, data.dt_s, surface=False)[0][at]

        return rms((data.map_motions(rows.rows, force_n) - rows.force_n)[beyond])

    constant_n = rms((values @ weights - rows.force_n)[beyond])
    return [constant_n, *map(error_n, np.eye(1 + len(SLOPE_POWERS))[1:])]


def extrapolate_curves(model: Hammerstein, growth: Growth) -> Hammerstein:
    """Continue a model's curves to 1.25 of its depth; the force within the depth stays the same.

    The C has nodes alone: what is deeper needs no code.
    """
    if model.places is not None:
        materials = (model.with_slopes(slopes_n) for slopes_n in model.places.slopes_n)
        extrapolated = [extrapolate_curves(material, growth) for material in materials]
        places = replace(
            model.places, slopes_n=np.stack([material.slopes_n for material in extrapolated])
        )
        return replace(extrapolated[0].with_slopes(places.most_n), places=places)

    curves = [model.elastic_n[None], model.branch_n, model.stop_n]
    curves += [] if model.damage is None else [model.damage.curve_n]
    grown = _EXTENSION_RATIO * _extrapolate_slopes(np.concatenate(curves), growth)
    elastic_n, branch_n, stop_n, damage_n = np.split(
        grown, np.cumsum([len(part) for part in curves[:3]])
    )
    # u' = u/1.25 is the share of the new depth. Rates: q^(1/2 - u)/tau = q'^(1/2 - u')/tau'.
    ratio = model.rate_ratio**_EXTENSION_RATIO
    slower = np.where(model.by_depth, ratio ** (0.5 - 0.5 / _EXTENSION_RATIO), 1.0)
    flow, memory = model.flow, model.memory
    branch_memory = memory.flow
    if flow is not None:  # b = u^degree is as many times b', and so is h
        unit = _EXTENSION_RATIO**flow.degree
        rate_ps, force_n = flow.rate_ps * unit ** (flow.power - 1.0), flow.force_n * unit
        flow, branch_memory = replace(flow, rate_ps=rate_ps, force_n=force_n), branch_memory / unit
    return replace(
        model,
        span_m=_EXTENSION_RATIO * model.span_m,
        elastic_n=elastic_n[0],
        tau_s=model.tau_s * slower,
        branch_n=branch_n,
        stop_n=stop_n,
        rate_ratio=ratio,
        flow=flow,
        damage=model.damage and replace(model.damage, curve_n=damage_n),
        end_memory=replace(
            memory,
            flow=branch_memory,
            deepest=memory.deepest / _EXTENSION_RATIO,
            play=memory.play / _EXTENSION_RATIO,
            u=memory.u / _EXTENSION_RATIO,
        ),
    )


def _extrapolate_slopes(slopes_n: Samples, growth: Growth) -> Samples:
    """Slopes (curves, J) with further nodes up to 1.25, as dense as those; their sum is limited.

    Each curve grows by itself: real cylinders of silicone have an error of half of that with one
    factor for all. But a curve that gave little force may grow by anything: the sum is limited
    (test_a_curve_that_little_force_came_from_grows_no_more_than_all_together).
    """
    last_n, total_n = slopes_n[:, -1:], slopes_n.sum(axis=0)[None]
    ratios = [np.ones_like(last_n), *(_slope_ratios(slopes_n, power) for power in SLOPE_POWERS)]
    rises_n = last_n * sum(w * (r - 1.0) for w, r in zip(growth.weights, ratios, strict=True))
    powers = SLOPE_POWERS if growth.foretold else (_STRAIGHT,)
    most = np.max([_slope_ratios(total_n, power)[0] for power in powers], axis=0) - 1.0
    most = np.minimum(most, np.linspace(0.0, _MAX_TOTAL_RATIO - 1.0, len(most) + 1)[1:])
    total_rise_n = np.maximum(rises_n.sum(axis=0), 1e-12)
    kept = np.minimum(total_n[0, -1] * most / total_rise_n, 1.0)
    return np.concatenate([slopes_n, last_n + kept * rises_n], axis=1)


def _slope_ratios(slopes_n: Samples, power: float) -> Samples:
    """Extrapolate each curve's slope, as a ratio to its last one: (curves, nodes), never below 1.

    A line of the slope's power through the last node, of least squares of the slope before it.
    """
    pieces, last_n = slopes_n.shape[1] - 1, slopes_n[:, -1:]
    extra_u = np.arange(1, round((_EXTENSION_RATIO - 1.0) * pieces) + 1) / pieces
    top = max(round(_TOP_FRACTION * pieces), _MIN_INTERVALS)
    u = np.arange(-top, 0) / pieces
    before = slopes_n[:, -1 - top : -1] / np.where(last_n > 0.0, last_n, 1.0)
    before = np.maximum(before, _MIN_SLOPE_RATIO)
    transformed = np.log(before) if power == 0.0 else (before**power - 1.0) / power
    gradient = before ** (1.0 - power)  # how much a slope changes by one of its power
    rate = (gradient**2 * u * transformed).sum(axis=1) / np.sum((gradient * u) ** 2, axis=1)
    rises = np.maximum(rate, 0.0)[:, None] * extra_u
    if power == 0.0:
        ratios: Samples = np.exp(rises)
    else:
        ratios = np.maximum(1.0 + power * rises, 1e-6) ** (1.0 / power)
    return np.minimum(ratios, _MAX_SLOPE_RATIO)
