"""Values of the terms of a passive model along a motion."""

from collections.abc import Callable

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.model.formulas import (
    Place,
    curve_place,
    curve_values,
    flow_functions,
    flow_grown,
    flow_loss,
    loss_by_depth,
    play,
    rates_by_depth,
    straight_values,
)
from springpot.codegen.model.passive import FLOW_SHARE
from springpot.codegen.stages.passive.beside import FUNCTIONS
from springpot.trainer.features import highpass, highpass_by_depth
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.passive.passive_terms import Terms
from springpot.trainer.models.training_set import TrainingSet

_AT_ONCE = 1 << 18  # samples of functions along a motion: those of a press fit into a cache


def columns(terms: Terms, motion: DepthMotion, dt_s: float, rows: Indices) -> Samples:
    """Values of all terms along a motion from rest, at rows of it: shape (rows, terms)."""
    u = terms.shares(motion.depth_m)
    radii = np.array(terms.radius_m) / terms.span_m
    played = [np.array(play(u, float(u[0]), radius))[rows] for radius in radii]
    place, *plays = (curve_place(each, terms.nodes) for each in (u, *played))

    def curves_of(along: Samples, some: Samples) -> list[Samples]:
        here = along[rows]
        return [
            here,
            *(highpass(along, tau_s, dt_s, motion.pauses)[rows] for tau_s in terms.tau_s),
            *(here - curve_values(some, played) for played in plays),
        ]

    values = _by_function(terms, place, curves_of)
    bias = np.tile([1.0, -1.0], (len(rows), 1)) if terms.bias else np.empty((len(rows), 0))
    return np.concatenate([values, bias, _added(terms, motion, dt_s, rows, place)], axis=1)


def term_columns(terms: Terms, data: TrainingSet, rows: Indices) -> Samples:
    """Values of all terms at rows of all recordings, (rows, terms)."""
    return data.along_motions(rows, lambda motion, at: columns(terms, motion, data.dt_s, at))


def added_columns(terms: Terms, motion: DepthMotion, dt_s: float, rows: Indices) -> Samples:
    """Those of `columns` that a richer law adds to the plain ones, (rows, terms - plain ones)."""
    place = curve_place(terms.shares(motion.depth_m), terms.nodes)
    return _added(terms, motion, dt_s, rows, place)


def _added(terms: Terms, motion: DepthMotion, dt_s: float, rows: Indices, place: Place) -> Samples:
    u, steps_s = terms.shares(motion.depth_m), _steps_s(motion, dt_s)
    lost = _lost(terms, place, steps_s)
    shares = [worn_share(u, heal_s, steps_s)[rows] ** power for heal_s, power in terms.damage]
    found = [np.empty((len(rows), 0))]
    if lost or shares:
        found.append(_by_function(
            terms, place,
            lambda along, _: [*(highpass_by_depth(along, each)[rows] for each in lost),
                              *(along[rows] * share[:, None] for share in shares)],
        ))  # fmt: skip
    if terms.flow:
        found.append(flowing(terms, u, steps_s)[rows])
    return np.concatenate(found, axis=1)


def _by_function(
    terms: Terms, place: Place, curves_of: Callable[[Samples, Samples], list[Samples]]
) -> Samples:
    """Columns of curves, (rows, curves x width): of each function of a curve, and its nodes.

    curves_of: from values of some functions along the motion, (n, k), and at their nodes, to those
    of each curve, (rows, k). Few functions at a time: a day's recording has 1e8 samples.
    """
    functions = terms.functions
    width, found = functions.shape[2], []
    at_once = max(1, _AT_ONCE // len(place[0]))
    for j in range(0, width, at_once):
        some = functions[:, :, j : j + at_once]
        found.append(np.stack(curves_of(curve_values(some, place), some), axis=1))
    values = np.concatenate(found, axis=2)
    return values.reshape(len(values), -1)


def _steps_s(motion: DepthMotion, dt_s: float) -> Samples:
    """Time before each sample, (n,), s."""
    steps_s = np.full(len(motion.depth_m), dt_s)
    for sample, seconds in motion.pauses:
        steps_s[sample] = seconds
    return steps_s


def _lost(terms: Terms, place: Place, steps_s: Samples) -> list[Samples]:
    """Share that each branch with a rate by depth loses in each step, (n,)."""
    tau_s, ratio = np.array(terms.depth_tau_s), terms.rate_ratio
    dt_s = float(steps_s[0])
    losses = loss_by_depth(tau_s, ratio, dt_s, terms.nodes)
    rates = rates_by_depth(tau_s, ratio, terms.nodes)
    paused = np.flatnonzero(steps_s != dt_s)
    there = (place[0][paused], place[1][paused])
    found = []
    for k in range(len(tau_s)):
        lost = straight_values(losses[:, k, None], place)[:, 0]
        rate = straight_values(rates[:, k, None], there)[:, 0]
        lost[paused] = -np.expm1(-steps_s[paused] * rate)
        found.append(lost)
    return found


def worn_share(u: Samples, heal_s: float, steps_s: Samples) -> Samples:
    """Depth as a share of the largest one so far, (n,), which heals towards it: sp_damage.h."""
    v = np.maximum(u, 0.0)
    if heal_s == 0.0:
        deepest = np.maximum.accumulate(v)
    else:
        healed, most = -np.expm1(-steps_s / heal_s), float(v[0])
        deepest = np.empty_like(v)
        for i, (at, share) in enumerate(zip(v.tolist(), healed.tolist(), strict=True)):
            most = max(most - share * (most - at), at)
            deepest[i] = most
    return np.divide(v, deepest, out=np.ones_like(v), where=deepest > 0.0)


def flowing(terms: Terms, u: Samples, steps_s: Samples) -> Samples:
    """States of the flowing branches, (n, branches): sp_flow.h."""
    order = np.argsort([power for _, power, _ in terms.flow], kind="stable")
    tau_s, power, degree = (np.array(each)[order] for each in zip(*terms.flow, strict=True))
    rate_ps = 1.0 / (tau_s * FLOW_SHARE ** (power - 1.0))
    loss, n_cubic = flow_loss(rate_ps, power, 1.0), int(np.count_nonzero(power == 3))
    function = np.array([FUNCTIONS.index(each) for each in degree.tolist()])
    rises = 0.5 * np.diff(flow_functions(u), prepend=flow_functions(u[:1]), axis=0)
    states = np.empty((len(u), len(order)))
    h = np.zeros(len(order))
    for i, (rise, step_s) in enumerate(zip(rises[:, function], steps_s.tolist(), strict=True)):
        h = h + rise
        h = h / flow_grown(h, step_s * loss, n_cubic) + rise
        states[i] = h
    found = np.empty_like(states)
    found[:, order] = states
    return found
