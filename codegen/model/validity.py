"""Rules of a model's parts beyond their types: shapes, signs, trees.

Another package's kind registers rules of its own with `require_valid.register`.
"""

from functools import singledispatch

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.errors import DataError
from springpot.codegen.model.features import FastFirBank, FirBank, FractionalBank, RecursiveBank
from springpot.codegen.model.model import Model, TrainedRange
from springpot.codegen.model.passive import Damage, Flow, Hammerstein, Places
from springpot.codegen.model.regressors import Forest, Quantisation, Rbf, require_trees

_MAX_NODES = 100  # of a curve, and of an axis of a map
_MAX_RATE_RATIO = 1e4  # of relaxation at the surface and at the trained depth
_ROUNDED = 1.0 - 1e-12


def _require(fits: bool, what: str) -> None:
    if not fits:
        raise DataError(what)


def _require_part(name: str, part: object, size: int) -> None:
    try:
        require_valid(part, size)
    except DataError as error:
        raise DataError(f"{name}.{error}") from None


@singledispatch
def require_valid(part: object, size: int = 0) -> None:
    """Raise DataError with field and reason.

    size: number of the model's features; of a curve's nodes, for a part of a passive model.
    """


@require_valid.register
def _model(model: Model, size: int = 0) -> None:
    _require(model.dt_s > 0.0, f"dt_s: {model.dt_s:g} s is no time step")
    alone = (model.features is None) != (model.regressor is None)
    _require(not alone, "features, regressor: one without the other")
    adds = model.hammerstein is not None and model.hammerstein_adds
    _require(adds or model.regressor is not None, "regressor, hammerstein: no force")
    _require(adds == model.hammerstein_adds, "hammerstein_adds: nothing to add")
    placed = model.hammerstein is not None and model.hammerstein.places is not None
    alone_at_a_surface = adds and model.regressor is None and model.contact == "surface"
    _require(alone_at_a_surface or not placed, "places: need a passive model with a surface")
    n_features = 0 if model.features is None else model.features.n_features
    for name in ("trained", "features", "regressor", "hammerstein"):
        _require_part(name, getattr(model, name), n_features)


@require_valid.register
def _trained(trained: TrainedRange, size: int = 0) -> None:
    _require(trained.min_m <= trained.max_m, "min_m: above max_m")
    _require(trained.min_n <= trained.max_n, "min_n: above max_n")
    _require(trained.max_mps >= 0.0, f"max_mps: {trained.max_mps:g} is negative")


@require_valid.register
def _hammerstein(passive: Hammerstein, size: int = 0) -> None:
    nodes, branches, stops = passive.nodes, passive.tau_s.size, passive.radius_m.size
    _require(passive.span_m > 0.0, f"span_m: {passive.span_m:g} m is no depth above 0")
    _require(1 <= nodes <= _MAX_NODES, f"elastic_n: {nodes} nodes, not 1 to {_MAX_NODES}")
    _not_negative("elastic_n", passive.elastic_n, (nodes,))
    _positive("tau_s", passive.tau_s, (branches,))
    _not_negative("branch_n", passive.branch_n, (branches, nodes))
    _positive("radius_m", passive.radius_m, (stops,))
    _not_negative("stop_n", passive.stop_n, (stops, nodes))
    _require(0 <= passive.n_by_depth <= branches, f"n_by_depth: {passive.n_by_depth} branches")
    known = 1 / _MAX_RATE_RATIO <= passive.rate_ratio <= _MAX_RATE_RATIO
    _require(known, f"rate_ratio: {passive.rate_ratio:g} is beyond {_MAX_RATE_RATIO:g}")
    _require_part("flow", passive.flow, nodes)
    _require_part("damage", passive.damage, nodes)
    _require_part("places", passive.places, passive.slopes_n.size)
    places = passive.places
    bounded = places is None or bool(np.all(passive.slopes_n >= _ROUNDED * places.most_n))
    _require(bounded, "places: steeper somewhere than the curves beside them say")


@require_valid.register
def _flow(flow: Flow, size: int) -> None:
    branches = (flow.rate_ps.size,)
    _positive("rate_ps", flow.rate_ps, branches)
    _among("power", flow.power, (3, 5), branches)
    _among("degree", flow.degree, (1, 2, 4), branches)
    _not_negative("force_n", flow.force_n, branches)


@require_valid.register
def _damage(damage: Damage, size: int) -> None:
    curves = damage.heal_s.size
    _among("power", damage.power, (1, 3), (curves,))
    _not_negative("heal_s", damage.heal_s, (curves,))
    _not_negative("curve_n", damage.curve_n, (curves, size))


@require_valid.register
def _places(places: Places, size: int) -> None:
    _require(places.amounts.ndim == 3, f"amounts: {places.amounts.ndim} axes, not 3")
    nodes, materials = places.nodes, places.amounts.shape[2]
    _require(all(2 <= n <= _MAX_NODES for n in nodes), f"amounts: {nodes}, not 2 to {_MAX_NODES}")
    _shaped("first_m", places.first_m, (2,))
    _positive("step_m", places.step_m, (2,))
    _not_negative("amounts", places.amounts, (*nodes, materials))
    _not_negative("slopes_n", places.slopes_n, (materials, size))


@require_valid.register
def _fir(bank: FirBank, size: int) -> None:
    _orders(bank)
    _shaped("taps", bank.taps, (len(bank.taps), len(bank.orders)))


@require_valid.register
def _fast_fir(bank: FastFirBank, size: int) -> None:
    _orders(bank)
    _positive("tau_ticks", bank.tau_ticks, (len(bank.tau_ticks),))
    direct = len(bank.weights) - len(bank.tau_ticks) - 1
    _require(direct >= 1, f"weights: {len(bank.weights)} rows for {len(bank.tau_ticks)} poles")
    _shaped("weights", bank.weights, (len(bank.weights), len(bank.orders)))
    _require(direct + 1 < bank.length, f"length: {bank.length} samples")


@require_valid.register
def _recursive(bank: RecursiveBank, size: int) -> None:
    _orders(bank)
    _positive("tau_s", bank.tau_s, (len(bank.tau_s),))
    _shaped("weights", bank.weights, (len(bank.tau_s), len(bank.orders)))


@require_valid.register
def _forest(forest: Forest, size: int) -> None:
    _require(forest.weight > 0.0, f"weight: {forest.weight:g} is not above 0")
    require_trees(forest, size)
    _require_part("quantisation", forest.quantisation, size)


@require_valid.register
def _quantisation(quantisation: Quantisation, size: int) -> None:
    _shaped("feature_min", quantisation.feature_min, (size,))
    _positive("bins_per_unit", quantisation.bins_per_unit, (size,))


@require_valid.register
def _rbf(rbf: Rbf, size: int) -> None:
    _positive("scale", rbf.scale, (size,))
    for name in ("mean", "feature_min", "feature_max"):
        _shaped(name, getattr(rbf, name), (size,))
    _require(bool(np.all(rbf.feature_min <= rbf.feature_max)), "feature_min: above feature_max")
    _shaped("centers", rbf.centers, (len(rbf.weights_n), size))
    _shaped("weights_n", rbf.weights_n, (len(rbf.weights_n),))
    _shaped("tail_n", rbf.tail_n, (size + 1,))


def _orders(bank: FractionalBank) -> None:
    fits = len(bank.orders) > 0 and all(0.0 <= r <= 1.0 for r in bank.orders)
    _require(fits, f"orders: {bank.orders[:12]} are not within 0 .. 1")


def _shaped(name: str, values: NDArray[np.generic], shape: tuple[int, ...]) -> None:
    _require(values.shape == shape, f"{name}: shape {values.shape}, not {shape}")


def _positive(name: str, values: NDArray[np.float64], shape: tuple[int, ...]) -> None:
    _shaped(name, values, shape)
    _require(bool(np.all(values > 0.0)), f"{name}: not above 0")


def _not_negative(name: str, values: NDArray[np.float64], shape: tuple[int, ...]) -> None:
    _shaped(name, values, shape)
    _require(bool(np.all(values >= 0.0)), f"{name}: negative, so not passive")


def _among(
    name: str, values: NDArray[np.int64], known: tuple[int, ...], shape: tuple[int, ...]
) -> None:
    _shaped(name, values, shape)
    _require(bool(np.isin(values, known).all()), f"{name}: not all of {known}")
