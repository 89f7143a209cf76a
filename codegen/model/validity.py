"""Rules of a model's parts beyond their types: shapes, signs, ranges, trees.

Rules of a kind of one's own are registered with `require_valid`; without, its types are checked.
"""

import math
import re
from functools import singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.errors import DataError
from springpot.codegen.model.features import (
    FastFirBank,
    FirBank,
    FractionalBank,
    Lags,
    PositionVelocity,
    RecursiveBank,
)
from springpot.codegen.model.model import Model, TrainedRange
from springpot.codegen.model.passive import Damage, Flow, Hammerstein
from springpot.codegen.model.places import Places
from springpot.codegen.model.provenance import require_provenance
from springpot.codegen.model.regressors import Forest, Quantisation, Rbf, require_trees

# Far beyond what a hand, a soft object and a control loop can have.
_MAX_M, _MAX_MPS, _MAX_N = 100.0, 1e4, 1e4
_MIN_DT_S, _MAX_DT_S = 1e-6, 1e2
_MAX_SAMPLES = 1_000_000  # of a window: state of the C
_MAX_RATE_RATIO = 1e4  # of relaxation at the surface and at the trained depth
_MAX_NODES = 100  # of a curve
_MAX_TERMS = 1_000  # branches, stops, poles
_MAX_MATERIALS = 8
_ROUNDED = 1.0 - 1e-12
_KIND = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.+-]{0,63}")  # part of commands that pages show


def _require(fits: bool, what: str) -> None:
    if not fits:
        raise DataError(what)


@singledispatch
def require_valid(part: Any, n_features: int) -> None:
    """Raise DataError with field and reason.

    n_features: of the model's features, 0 without; of a curve's nodes for a part of it.
    """


@require_valid.register
def _model(model: Model, n_features: int) -> None:
    _require(_KIND.fullmatch(model.kind) is not None, f"kind: {model.kind!r} is no name of a kind")
    _require(_MIN_DT_S <= model.dt_s <= _MAX_DT_S, f"dt_s: {model.dt_s:g} s is no time step")
    alone = (model.features is None) != (model.regressor is None)
    _require(not alone, "features, regressor: one without the other")
    adds = model.hammerstein is not None and model.hammerstein_adds
    _require(adds or model.regressor is not None, "regressor, hammerstein: no force")
    _require(adds == model.hammerstein_adds, "hammerstein_adds: nothing to add")
    placed = model.hammerstein is not None and model.hammerstein.places is not None
    alone_at_a_surface = adds and model.regressor is None and model.contact == "surface"
    _require(alone_at_a_surface or not placed, "places: of no passive model with a surface")
    require_provenance(model.provenance)
    for part, value in (
        ("trained", model.trained),
        ("features", model.features),
        ("regressor", model.regressor),
        ("hammerstein", model.hammerstein),
    ):
        try:
            require_valid(value, n_features)
        except DataError as error:
            raise DataError(f"{part}.{error}") from None


@require_valid.register
def _trained(trained: TrainedRange, n_features: int) -> None:
    for what, low, high, limit in (
        ("min_m, max_m", trained.min_m, trained.max_m, _MAX_M),
        ("min_n, max_n", trained.min_n, trained.max_n, _MAX_N),
        ("max_mps", 0.0, trained.max_mps, _MAX_MPS),
    ):
        fits = -limit <= low <= high <= limit
        _require(fits, f"{what}: {low:g} to {high:g} is no range within {-limit:g} .. {limit:g}")


@require_valid.register
def _hammerstein(passive: Hammerstein, n_features: int) -> None:
    nodes, branches, stops = passive.nodes, passive.tau_s.size, passive.radius_m.size
    _require(0.0 < passive.span_m <= _MAX_M, f"span_m: {passive.span_m:g} m is no depth above 0")
    _require(abs(passive.origin_m) <= _MAX_M, f"origin_m: {passive.origin_m:g} m")
    _require(1 <= nodes <= _MAX_NODES, f"elastic_n: {nodes} nodes, not 1 to {_MAX_NODES}")
    _shaped("elastic_n", passive.elastic_n, (nodes,))
    _shaped("tau_s", passive.tau_s, (branches,))
    _shaped("branch_n", passive.branch_n, (branches, nodes))
    _shaped("radius_m", passive.radius_m, (stops,))
    _shaped("stop_n", passive.stop_n, (stops, nodes))
    _require(max(branches, stops) <= _MAX_TERMS, f"tau_s, radius_m: more than {_MAX_TERMS}")
    _positive("tau_s", passive.tau_s)
    _positive("radius_m", passive.radius_m)
    _require(0 <= passive.n_by_depth <= branches, f"n_by_depth: {passive.n_by_depth} branches")
    known = 1 / _MAX_RATE_RATIO <= passive.rate_ratio <= _MAX_RATE_RATIO
    _require(known, f"rate_ratio: {passive.rate_ratio:g} is not within 1/{_MAX_RATE_RATIO:g} .. "
             f"{_MAX_RATE_RATIO:g}")  # fmt: skip
    for name in ("elastic_n", "branch_n", "stop_n"):
        _not_negative(name, getattr(passive, name))
    for part, size in (("flow", nodes), ("damage", nodes), ("places", passive.slopes_n.size)):
        try:
            require_valid(getattr(passive, part), size)
        except DataError as error:
            raise DataError(f"{part}.{error}") from None
    places = passive.places
    bounded = places is None or bool(np.all(passive.slopes_n >= _ROUNDED * places.most_n))
    _require(bounded, "places: steeper somewhere than the curves beside them say")


@require_valid.register
def _flow(flow: Flow, _: int) -> None:
    branches = flow.rate_ps.size
    _require(0 < branches <= _MAX_TERMS, f"rate_ps: {branches} branches")
    for name in ("rate_ps", "power", "degree", "force_n"):
        _shaped(name, getattr(flow, name), (branches,))
    _positive("rate_ps", flow.rate_ps)
    _among("power", flow.power, (3, 5))
    _among("degree", flow.degree, (1, 2, 4))
    _not_negative("force_n", flow.force_n)


@require_valid.register
def _damage(damage: Damage, nodes: int) -> None:
    curves = damage.heal_s.size
    _require(0 < curves <= _MAX_TERMS, f"heal_s: {curves} curves")
    for name in ("heal_s", "power"):
        _shaped(name, getattr(damage, name), (curves,))
    _shaped("curve_n", damage.curve_n, (curves, nodes))
    _among("power", damage.power, (1, 3))
    for name in ("heal_s", "curve_n"):
        _not_negative(name, getattr(damage, name))


@require_valid.register
def _places(places: Places, slopes: int) -> None:
    _require(places.amounts.ndim == 3, f"amounts: {places.amounts.ndim} axes, not 3")
    nodes = places.nodes
    _require(all(2 <= n <= _MAX_NODES for n in nodes), f"amounts: {nodes}, not 2 to {_MAX_NODES}")
    materials = places.amounts.shape[2]
    _require(1 <= materials <= _MAX_MATERIALS, f"amounts: {materials} materials")
    _shaped("first_m", places.first_m, (2,))
    _shaped("step_m", places.step_m, (2,))
    _positive("step_m", places.step_m)
    _require(float(np.abs([places.first_m, places.last_m]).max()) <= _MAX_M, "first_m, step_m: far")
    _shaped("slopes_n", places.slopes_n, (materials, slopes))
    _not_negative("amounts", places.amounts)
    _not_negative("slopes_n", places.slopes_n)


@require_valid.register
def _fir(bank: FirBank, n_features: int) -> None:
    _orders(bank)
    _require(0 < len(bank.taps) <= _MAX_SAMPLES, f"taps: {bank.taps.shape[:1]} samples")
    _shaped("taps", bank.taps, (len(bank.taps), len(bank.orders)))


@require_valid.register
def _fast_fir(bank: FastFirBank, n_features: int) -> None:
    _orders(bank)
    _poles("tau_ticks", bank.tau_ticks)
    direct = len(bank.weights) - len(bank.tau_ticks) - 1
    _require(direct >= 1, f"weights: {len(bank.weights)} rows for {len(bank.tau_ticks)} poles")
    _shaped("weights", bank.weights, (len(bank.weights), len(bank.orders)))
    _require(direct + 1 < bank.length <= _MAX_SAMPLES, f"length: {bank.length} samples")


@require_valid.register
def _recursive(bank: RecursiveBank, n_features: int) -> None:
    _orders(bank)
    _poles("tau_s", bank.tau_s)
    _shaped("weights", bank.weights, (len(bank.tau_s), len(bank.orders)))


@require_valid.register
def _lags(lags: Lags, n_features: int) -> None:
    ascending = all(a < b for a, b in zip(lags.samples, lags.samples[1:], strict=False))
    fits = ascending and lags.samples[:1] == (0,) and lags.samples[-1] <= _MAX_SAMPLES
    _require(fits, f"samples: {lags.samples[:12]} do not ascend from 0 to at most {_MAX_SAMPLES}")


@require_valid.register
def _position_velocity(features: PositionVelocity, n_features: int) -> None:
    _require(1 <= features.length <= _MAX_SAMPLES, f"length: {features.length} steps")
    _require(0.0 <= features.band_m <= _MAX_M, f"band_m: {features.band_m:g} m")


@require_valid.register
def _forest(forest: Forest, n_features: int) -> None:
    _require(forest.weight > 0.0, f"weight: {forest.weight:g} is not above 0")
    require_trees(forest, n_features)
    if forest.quantisation is not None:
        try:
            require_valid(forest.quantisation, n_features)
        except DataError as error:
            raise DataError(f"quantisation.{error}") from None


@require_valid.register
def _quantisation(quantisation: Quantisation, n_features: int) -> None:
    _shaped("feature_min", quantisation.feature_min, (n_features,))
    _shaped("bins_per_unit", quantisation.bins_per_unit, (n_features,))
    _positive("bins_per_unit", quantisation.bins_per_unit)


@require_valid.register
def _rbf(rbf: Rbf, n_features: int) -> None:
    for name in ("mean", "scale", "feature_min", "feature_max"):
        _shaped(name, getattr(rbf, name), (n_features,))
    _positive("scale", rbf.scale)
    ordered = bool(np.all(rbf.feature_min <= rbf.feature_max))
    _require(ordered, "feature_min: above feature_max")
    _require(len(rbf.centers) >= 1, "centers: none")
    _shaped("centers", rbf.centers, (len(rbf.centers), n_features))
    _shaped("weights_n", rbf.weights_n, (len(rbf.centers),))
    _shaped("tail_n", rbf.tail_n, (n_features + 1,))


def _orders(bank: FractionalBank) -> None:
    fits = 0 < len(bank.orders) <= _MAX_TERMS and all(0.0 <= r <= 1.0 for r in bank.orders)
    _require(fits, f"orders: {bank.orders[:12]} are not within 0 .. 1")


def _poles(name: str, tau: NDArray[np.float64]) -> None:
    _shaped(name, tau, (tau.size,))
    _require(0 < tau.size <= _MAX_TERMS, f"{name}: {tau.size} poles")
    _positive(name, tau)


def _shaped(name: str, values: NDArray[np.float64], shape: tuple[int, ...]) -> None:
    _require(values.shape == shape, f"{name}: shape {values.shape}, not {shape}")


def _positive(name: str, values: NDArray[np.float64]) -> None:
    low = float(values.min(initial=math.inf))
    _require(low > 0.0, f"{name}: {low:g} is not above 0")


def _not_negative(name: str, values: NDArray[np.float64]) -> None:
    low = float(values.min(initial=0.0))
    _require(low >= 0.0, f"{name}: {low:g} is negative: it would not be passive")


def _among(name: str, values: NDArray[np.int64], known: tuple[int, ...]) -> None:
    _require(bool(np.isin(values, known).all()), f"{name}: not all of {known}")
