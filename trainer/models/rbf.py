"""Kinds `rbf-fd` and `rbf-pv`: cubic radial basis functions with a linear tail on two features."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import reduce
from itertools import combinations
from operator import add

import numpy as np

from springpot.codegen.arrays import Indices, Samples, rms
from springpot.codegen.errors import UsageError
from springpot.codegen.model.features import Features, FractionalBank, PositionVelocity
from springpot.codegen.model.regressors import Rbf
from springpot.codegen.types import JsonMapping
from springpot.trainer.features import depth_features
from springpot.trainer.models.depths import compute_depth_m
from springpot.trainer.models.fit import Fit, FitOptions, assemble
from springpot.trainer.models.folds import Folds, build_cv_schemes
from springpot.trainer.models.passive.nonnegative import Normal, normal_equations
from springpot.trainer.models.passive.passive_fit import fit_passive
from springpot.trainer.models.predict import rbf_columns, standardise
from springpot.trainer.models.rf_fd import PAPER_ORDERS, build_fractional_features
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording

FOAW_S, FOAW_BAND_M = 0.024, 15e-6  # of a velocity (Janabi-Sharifi et al. 2000)
SEARCH_CENTERS = 100
SEARCH_ROWS = 10_000  # of the validation recordings
# Of the largest singular value squared. Without it the weights of near centers are large, of both
# signs: their sum loses digits in float32, and between the samples it is far off.
_DAMPING = 1e-10
# Of cross-validation. Recordings of one frequency each cannot show what a pair does with several at
# once; how it bears a fit with hardly any damping foretells that better than the fit that ships: on
# five silicones its choices err by 1.00 to 1.35 times the best pair's, that one's by 1.39 to 1.73.
_TRIAL_DAMPING = 1e-13
Pair = tuple[int, int]


def fit_rbf_fd(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Radial basis functions on two fractional derivatives (equation 12), of all pairs of orders.

    The pair is chosen by cross-validation over recordings; with options.select "paper" by the error
    on those for validation, as the paper did. Raises UsageError without them, or two orders.
    """
    begin = time.perf_counter()
    rows, orders = data.rows(options.fraction, options.seed), options.orders or PAPER_ORDERS
    if len(orders) < 2:
        raise UsageError("orders: rbf-fd chooses two: give at least two")
    bank = build_fractional_features(data.dt_s, options.window_s, options.engine, orders)
    values, force_n = data.features(bank, rows), data.force_n(rows)
    feature_s = time.perf_counter() - begin
    key = ("pairs", orders, options.window_s, options.engine, options.fraction, options.seed)
    families = build_cv_schemes(data, rows, options.seed)
    cv_errors, search_s = data.cached(key, lambda: _pair_errors(values, force_n, families))
    begin = time.perf_counter()
    errors = {"cv": cv_errors}
    if validation:
        errors["paper"] = _paper_errors(bank, values, force_n, data, validation)
    pairs = {
        how: min(errors_by_pair, key=errors_by_pair.__getitem__)
        for how, errors_by_pair in errors.items()
    }
    if options.select not in pairs:
        raise UsageError("--select paper chooses orders on validation recordings: give --validate")
    search_s += time.perf_counter() - begin
    chosen = pairs[options.select]
    metadata = {"pairs": {how: [orders[i] for i in pair] for how, pair in pairs.items()}}
    features = bank.take(np.array(chosen))
    fit = _fit_rbf("rbf-fd", name, data, options, features, values[:, chosen], force_n, metadata)
    return replace(fit, feature_s=feature_s, search_s=search_s)


def fit_rbf_pv(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Radial basis functions on position and velocity (equation 13, [13])."""
    begin = time.perf_counter()
    rows = data.rows(options.fraction, options.seed)
    steps = max(1, round(FOAW_S / data.dt_s))
    features = PositionVelocity(steps, FOAW_BAND_M, options.velocity_weight)
    values, force_n = data.features(features, rows), data.force_n(rows)
    feature_s = time.perf_counter() - begin
    fit = _fit_rbf("rbf-pv", name, data, options, features, values, force_n, {})
    return replace(fit, feature_s=feature_s)


def _fit_rbf(
    kind: str,
    name: str,
    data: TrainingSet,
    options: FitOptions,
    features: Features,
    values: Samples,
    force_n: Samples,
    metadata: JsonMapping,
) -> Fit:
    """Fit the functions on features (rows, 2), and the passive fallback beside them."""
    begin = time.perf_counter()
    scaling = fit_scaler(values)
    z = standardise(scaling, values)
    centers = z[select_farthest_points(z, options.n_centers)]
    system = rbf_columns(z, centers)
    weights_n, tail_n = np.split(solve_damped(normal_equations(system, force_n)), [len(centers)])
    condition = float(np.linalg.cond(system / np.sqrt(np.square(system).sum(axis=0))))
    rbf = replace(scaling, centers=centers, weights_n=weights_n, tail_n=tail_n)
    fit_s = time.perf_counter() - begin
    passive = fit_passive(data, options)
    metadata = {"n_centers": len(centers), "condition": condition, **metadata}
    parts, rows = (features, rbf), len(values)
    model = assemble(kind, name, data, options, rows, parts, passive, False, metadata)
    return Fit(model, rows, feature_s=0.0, fit_s=fit_s, metadata=metadata)


def _pair_errors(values: Samples, force_n: Samples, families: Sequence[Folds]) -> dict[Pair, float]:
    """Return the cross-validated RMSE of every pair of orders, as a product over ways to fold.

    By recording, and by condition where there are enough of them: pairs that interpolate between
    recordings alike differ in what they do between conditions. Normal equations of a fold are made
    once, and serve every fit that does not hold it out.
    """
    return {
        pair: float(np.prod([_held_out_rmse(system, force_n, one) for one in families]))
        for pair, system, _ in _build_systems(values, values[:0])
    }


def _build_systems(values: Samples, others: Samples) -> Iterator[tuple[Pair, Samples, Samples]]:
    """Yield each pair of features with its functions at the rows of `values` and of `others`.

    The centres are among the rows of `values`.
    """
    for pair in combinations(range(values.shape[1]), 2):
        scaling = fit_scaler(values[:, pair])
        z = standardise(scaling, values[:, pair])
        centers = z[select_farthest_points(z, SEARCH_CENTERS)]
        system = rbf_columns(z, centers)
        yield pair, system, rbf_columns(standardise(scaling, others[:, pair]), centers)


def _held_out_rmse(system: Samples, force_n: Samples, folds: Folds) -> float:
    """Return the RMSE over folds, N, each predicted by weights fitted on the other folds."""
    numbers = np.unique(folds.number).tolist()
    held_out = {number: folds.number == number for number in numbers}
    normals = {k: normal_equations(system[rows], force_n[rows]) for k, rows in held_out.items()}
    errors_n = []
    for number in folds.tested:
        shown = reduce(add, (normals[other] for other in numbers if other != number))
        rows, weights = held_out[number], solve_damped(shown, _TRIAL_DAMPING)
        errors_n.append(system[rows] @ weights - force_n[rows])
    return rms(np.concatenate(errors_n))


def _paper_errors(
    bank: FractionalBank,
    values: Samples,
    force_n: Samples,
    data: TrainingSet,
    validation: Sequence[Recording],
) -> dict[Pair, float]:
    """RMSE of every pair on evenly spaced rows of the validation recordings."""
    step = max(1, sum(len(rec.force_n) for rec in validation) // SEARCH_ROWS)
    tests = [
        (depth_features(bank, compute_depth_m(rec, data.contact), rec.dt_s,
                        np.arange(0, len(rec.force_n), step)), rec.force_n[::step])
        for rec in validation
    ]  # fmt: skip
    tested, measured_n = (np.concatenate(parts) for parts in zip(*tests, strict=True))
    errors = {}
    for pair, system, other in _build_systems(values, tested):
        errors[pair] = rms(other @ solve_damped(normal_equations(system, force_n)) - measured_n)
    return errors


def fit_scaler(features: Samples) -> Rbf:
    """Mean, deviation and extremes of each column of features (n, features); no functions yet."""
    scale, none = features.std(axis=0), np.empty(0)
    low, high = features.min(axis=0), features.max(axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    return Rbf(features.mean(axis=0), scale, low, high, np.empty((0, len(scale))), none, none)


def select_farthest_points(z: Samples, count: int) -> Indices:
    """Choose up to `count` points, (centers,), each the farthest from all chosen before."""
    chosen = [int(np.argmax(np.square(z).sum(axis=1)))]
    distance = np.square(z - z[chosen[0]]).sum(axis=1)
    while len(chosen) < min(count, len(z)) and distance.max() > 0.0:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.square(z - z[chosen[-1]]).sum(axis=1))
    return np.array(chosen)


def solve_damped(normal: Normal, share: float = _DAMPING) -> Samples:
    """Weights, (columns,), of least squares damped by a share of the largest squared value."""
    norms = np.sqrt(np.diag(normal.matrix))
    scaled = normal.matrix / np.outer(norms, norms)
    damping = share * float(np.linalg.eigvalsh(scaled)[-1])
    weights: Samples = np.linalg.solve(scaled + damping * np.eye(len(norms)), normal.vector / norms)
    return weights / norms
