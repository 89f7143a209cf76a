"""Values of the terms of a passive model along a motion."""

from collections.abc import Callable, Sequence

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.model.formulas import (
    Place,
    curve_nodes,
    curve_place,
    curve_values,
    flow_functions,
    flow_loss,
    loss_by_depth,
    play,
    rates_by_depth,
    straight_values,
)
from springpot.codegen.model.passive import FLOW_SHARE
from springpot.codegen.stages.passive.beside import FUNCTIONS
from springpot.trainer.features import decaying, highpass, highpass_by_depth
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.passive.passive_terms import Terms
from springpot.trainer.models.training_set import TrainingSet

_TICKS = 512  # of flow at once
_AT_ONCE = 1 << 18  # samples of functions along a motion: those of a press fit into a cache


def term_columns(terms: Terms, data: TrainingSet, rows: Indices) -> Samples:
    """Values of all terms at rows of all recordings, (rows, terms)."""
    found = columns(terms, data.motions, data.dt_s, data.motion_rows(rows))
    return data.in_order(rows, found)


def columns(
    terms: Terms, motions: Sequence[DepthMotion], dt_s: float, rows_of: Sequence[Indices]
) -> list[Samples]:
    """Values of all terms along motions from rest, at rows of each: (its rows, terms)."""
    found = []
    flow = flowing(terms, motions, dt_s, rows_of)
    for motion, rows, its_flow in zip(motions, rows_of, flow, strict=True):
        plain = terms.with_exponentials(plain_hats(terms, dt_s, motion, rows))
        richer = terms.with_exponentials(added_hats(terms, dt_s, motion, rows))
        bias = np.tile([1.0, -1.0], (len(rows), int(terms.bias)))
        found.append(np.concatenate([plain, bias, richer, its_flow], axis=1))
    return found


def plain_hats(terms: Terms, dt_s: float, motion: DepthMotion, rows: Indices) -> Samples:
    """Values of the hats of plain curves at rows of a motion, (rows, curves x nodes)."""
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

    return _by_hat(terms, place, curves_of)


def added_hats(terms: Terms, dt_s: float, motion: DepthMotion, rows: Indices) -> Samples:
    """Those that a richer law adds: branches with a rate by depth, and damage."""
    if not terms.curves[1]:
        return np.empty((len(rows), 0))
    u, steps_s = terms.shares(motion.depth_m), _steps_s(motion, dt_s)
    place = curve_place(u, terms.nodes)
    lost = _lost(terms, place, steps_s)
    worn = {heal_s: worn_share(u, heal_s, steps_s)[rows] for heal_s, _ in terms.damage}
    shares = [worn[heal_s][:, None] ** power for heal_s, power in terms.damage]
    return _by_hat(
        terms, place,
        lambda along, _: [*(highpass_by_depth(along, each)[rows] for each in lost),
                          *(along[rows] * share for share in shares)],
    )  # fmt: skip


def _by_hat(
    terms: Terms, place: Place, curves_of: Callable[[Samples, Samples], list[Samples]]
) -> Samples:
    """Columns of hats, (rows, curves x nodes).

    curves_of: from values of some functions along the motion, (n, k), and at their nodes, to those
    of each curve, (rows, k). Few functions at a time: a day's recording has 1e8 samples.
    """
    functions, found = curve_nodes((terms.nodes - 1.0) * np.eye(terms.nodes)), []
    at_once = max(1, _AT_ONCE // len(place[0]))
    for j in range(0, terms.nodes, at_once):
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


def _lost(terms: Terms, place: Place, steps_s: Samples) -> Samples:
    """Share that each branch with a rate by depth loses in each step, (branches, n)."""
    tau_s, ratio, dt_s = np.array(terms.depth_tau_s), terms.rate_ratio, float(steps_s[0])
    lost: Samples = straight_values(loss_by_depth(tau_s, ratio, dt_s, terms.nodes), place)
    paused = np.flatnonzero(steps_s != dt_s)
    there = place[0][paused], place[1][paused]
    rates_ps = straight_values(rates_by_depth(tau_s, ratio, terms.nodes), there)
    lost[paused] = -np.expm1(-steps_s[paused, None] * rates_ps)
    return lost.T


def worn_share(u: Samples, heal_s: float, steps_s: Samples) -> Samples:
    """Depth as a share of the largest one so far, (n,), which heals towards it: sp_damage.h."""
    v = np.maximum(u, 0.0)
    deepest = np.maximum.accumulate(v)
    if heal_s > 0.0:
        # M - v falls by what heals and by what v rises, and is 0 at least.
        left = np.exp(-steps_s / heal_s)
        deepest = v + decaying(left, -left * np.diff(v, prepend=v[:1]), least_0=True)
    return np.divide(v, deepest, out=np.ones_like(v), where=deepest > 0.0)


def flowing(
    terms: Terms, motions: Sequence[DepthMotion], dt_s: float, rows_of: Sequence[Indices]
) -> list[Samples]:
    """States of the flowing branches at rows of each motion, (its rows, branches): sp_flow.h.

    Tick by tick, all motions at once: a tick of many takes hardly longer than of one.
    """
    found = [np.empty((len(rows), len(terms.flow))) for rows in rows_of]
    if not terms.flow:
        return found
    tau_s, power, degree = map(np.array, zip(*terms.flow, strict=True))
    rate_ps = 1.0 / (tau_s * FLOW_SHARE ** (power - 1.0))
    loss, n_cubic = flow_loss(rate_ps, power, 1.0), int(np.count_nonzero(power == 3))
    function = [FUNCTIONS.index(each) for each in degree.tolist()]
    longest_first = sorted(range(len(motions)), key=lambda k: -len(motions[k].depth_m))
    along = [flow_functions(terms.shares(motion.depth_m)) for motion in motions]
    rises = [0.5 * np.diff(each, prepend=each[:1], axis=0) for each in along]
    steps_s = [_steps_s(motion, dt_s) for motion in motions]
    h = np.zeros((len(function), len(motions)))
    for begin in range(0, len(along[longest_first[0]]), _TICKS):
        its = slice(begin, begin + _TICKS)
        going = [k for k in longest_first if len(along[k]) > begin]
        rise = _side_by_side([rises[k][its] for k in going])[:, function]
        lost = loss[:, None] * _side_by_side([steps_s[k][its, None] for k in going])
        states = _flowed(h[:, : len(going)], rise, lost, n_cubic)
        h = states[-1]
        for k, of_motion in zip(going, np.moveaxis(states, 2, 0), strict=True):
            some = slice(*np.searchsorted(rows_of[k], (begin, begin + _TICKS)))
            found[k][some] = of_motion[rows_of[k][some] - begin]
    return found


def _side_by_side(values: Sequence[Samples]) -> Samples:
    """Values of motions, (n, k) each, the longest first: (n, k, motions), 0 after an end."""
    found = np.zeros((*values[0].shape, len(values)))
    for number, its in enumerate(values):
        found[: len(its), :, number] = its
    return found


def _flowed(h: Samples, rises: Samples, lost: Samples, n_cubic: int) -> Samples:
    """States of branches after ticks, (n, branches, motions), from h; all in place for speed.

    h -> (h + rise)/grown + rise: of the first branches grown is (1 + lost h^2)^(1/2), of the others
    (1 + lost h^4)^(1/4).
    """
    flat, h = (len(rises), -1), h.ravel()
    states, grown = np.empty(rises.shape), np.empty_like(h)
    fifth = grown[n_cubic * rises.shape[2] :]
    each = (its.reshape(flat) for its in (rises, lost, states))
    for rise, its_lost, held in zip(*each, strict=True):
        np.add(h, rise, out=held)
        np.multiply(held, held, out=grown)
        np.multiply(fifth, fifth, out=fifth)
        np.multiply(grown, its_lost, out=grown)
        np.add(grown, 1.0, out=grown)
        np.sqrt(grown, out=grown)
        np.sqrt(fifth, out=fifth)
        np.divide(held, grown, out=held)
        h = np.add(held, rise, out=held)
    return states
