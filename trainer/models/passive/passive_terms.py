"""The passive model: non-negative least squares on springs, Maxwell branches and stop operators."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.model.formulas import (
    basis,
    curve_values,
    depth_place,
    loss_by_depth,
    stretched,
)
from springpot.codegen.model.model import BASIS_SIZE, Basis, Hammerstein
from springpot.trainer.features.values import highpass, highpass_by_depth
from springpot.trainer.models.training_set import TrainingSet

PASSIVE_POLES = 12
FEWEST_BY_DEPTH = 4  # poles, of which half can have a rate that depends on the depth
_FIRST = 0.02  # of the second differences' weight: enough to keep a curve straight in a gap
RADIUS_SHARES = (0.02, 0.06, 0.2, 0.5)  # of the trained depth
_CHUNK = 1 << 16  # samples that stand as Python's numbers at once


@dataclass(frozen=True)
class Shape:
    """Curves of the depth, and how half of the branches' rate depends on it: see `Hammerstein`."""

    basis: Basis
    stretch: float = 0.0
    rate_ratio: float = 1.0


@dataclass(frozen=True)
class Terms:
    """The terms that a fit chooses from.

    Columns: the spring's basis; each pole's branches, those whose rate depends on the depth last;
    each radius's stops; then, where the bias is fitted, +1 and -1.
    """

    shape: Shape
    origin_m: float
    span_m: float
    tau_s: tuple[float, ...]
    n_by_depth: int
    radius_m: tuple[float, ...]
    bias: bool

    @property
    def n_basis(self) -> int:
        return BASIS_SIZE[self.shape.basis]

    @property
    def curves(self) -> int:
        """The spring, the poles' branches and the stops: a curve of `n_basis` terms each."""
        return 1 + len(self.tau_s) + len(self.radius_m)

    @property
    def count(self) -> int:
        return self.n_basis * self.curves + 2 * self.bias

    @property
    def blocks(self) -> Indices:
        """Number of each term's curve, (terms,); the bias is one more."""
        return np.minimum(np.arange(self.count) // self.n_basis, self.curves)

    def roughness(self) -> Samples:
        """Quadratic form of the weights, (terms, terms): how each curve of ramps bends.

        Squared second differences of its slopes, and a fiftieth of the first ones: a rise between
        two trained depths goes on as it does beside them, and what no row has seen too. Without a
        penalty on them it goes into whichever ramp the solver likes.
        """
        form = np.zeros((self.count, self.count))
        if self.shape.basis == "ramps":
            slopes = np.eye(self.n_basis)
            first, second = (np.diff(slopes, n, axis=0) for n in (1, 2))
            end = self.n_basis * self.curves
            block = second.T @ second + _FIRST * first.T @ first
            form[:end, :end] = np.kron(np.eye(self.curves), block)
        return form


def standard_terms(
    data: TrainingSet, shape: Shape, bias: bool, poles: int = PASSIVE_POLES
) -> Terms:
    """Four radii, and `poles` time constants from two samples to the longest recording.

    Where the rate depends on the depth, half of them of each sort.
    """
    trained = data.trained
    span_m = trained.max_m - trained.min_m
    n_by_depth = 0 if shape.rate_ratio == 1.0 else poles // 2
    longest_s = max(data.longest_s, 4.0 * data.dt_s)
    tau_s = [
        np.geomspace(2.0 * data.dt_s, longest_s, count)
        for count in (poles - n_by_depth, n_by_depth)
    ]
    return Terms(
        shape=shape,
        origin_m=trained.min_m,
        span_m=span_m,
        tau_s=tuple(np.concatenate(tau_s).tolist()),
        n_by_depth=n_by_depth,
        radius_m=tuple(share * span_m for share in RADIUS_SHARES),
        bias=bias,
    )


def columns(terms: Terms, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    """Values of all terms along one recording, at rows: shape (rows, terms).

    One function of the basis at a time: a day's recording has 1e8 samples.
    """
    u = (depth_m - terms.origin_m) / terms.span_m
    v = stretched(u, terms.shape.stretch) if terms.shape.stretch > 0.0 else u
    n, poles = terms.n_basis, len(terms.tau_s)
    constant = poles - terms.n_by_depth
    loss = loss_by_depth(np.array(terms.tau_s[constant:]), terms.shape.rate_ratio, dt_s)
    values = np.ones((len(rows), terms.count))
    for j, along in enumerate(basis(terms.shape.basis, v)):
        values[:, j] = along[rows]
        for k, tau_s in enumerate(terms.tau_s[:constant], 1):
            values[:, n * k + j] = highpass(along, tau_s, dt_s)[rows]
    for k in range(terms.n_by_depth):
        lost = curve_values(loss[:, :, k, None], depth_place(u))[:, 0]
        for j, along in enumerate(basis(terms.shape.basis, v), n * (1 + constant + k)):
            values[:, j] = highpass_by_depth(along, lost)[rows]
    for k, radius_m in enumerate(terms.radius_m, 1 + poles):
        played = basis(terms.shape.basis, play(v, radius_m / terms.span_m)[rows])
        for j, behind in enumerate(played):
            values[:, n * k + j] = values[:, j] - behind
    if terms.bias:
        values[:, -1] = -1.0
    return values


def play(u: Samples, radius: float) -> Samples:
    """Play operator of one radius, (n,), from rest at the first sample."""
    out = np.empty_like(u)
    p = float(u[0])
    for begin in range(0, len(u), _CHUNK):
        for i, x in enumerate(u[begin : begin + _CHUNK].tolist(), begin):
            p = min(max(p, x - radius), x + radius)
            out[i] = p
    return out


def hammerstein_force(model: Hammerstein, depth_m: Samples, dt_s: float, rows: Indices) -> Samples:
    """Force of a fitted model at rows of one recording, (rows,), N, in float64."""
    terms, weights = _terms_and_weights(model)
    force_n: Samples = columns(terms, depth_m, dt_s, rows) @ weights
    return force_n


def to_model(terms: Terms, weights: Samples) -> Hammerstein:
    """Terms and their non-negative weights -> IR, without the poles and radii of weight 0."""
    n, poles, radii = terms.n_basis, len(terms.tau_s), len(terms.radius_m)
    branch = weights[n : n * (1 + poles)].reshape(poles, n)
    stop = weights[n * (1 + poles) : n * (1 + poles + radii)].reshape(radii, n)
    kept, stops = branch.any(axis=1), stop.any(axis=1)
    n_by_depth = int(np.count_nonzero(branch[poles - terms.n_by_depth :].any(axis=1)))
    return Hammerstein(
        basis=terms.shape.basis,
        origin_m=terms.origin_m,
        span_m=terms.span_m,
        elastic_n=weights[:n],
        tau_s=np.array(terms.tau_s)[kept],
        branch_n=branch[kept],
        radius_m=np.array(terms.radius_m)[stops],
        stop_n=stop[stops],
        bias_n=float(weights[-2] - weights[-1]) if terms.bias else 0.0,
        n_by_depth=n_by_depth,
        rate_ratio=terms.shape.rate_ratio if n_by_depth else 1.0,
        stretch=terms.shape.stretch,
    )


def parameter_count(model: Hammerstein) -> int:
    """Numbers that the fit chose: weights above 0, and the bias."""
    weights = (model.elastic_n, model.branch_n, model.stop_n)
    return sum(int(np.count_nonzero(w)) for w in weights) + (model.bias_n != 0.0)


def _terms_and_weights(model: Hammerstein) -> tuple[Terms, NDArray[np.float64]]:
    terms = Terms(
        shape=Shape(model.basis, model.stretch, model.rate_ratio),
        origin_m=model.origin_m,
        span_m=model.span_m,
        tau_s=tuple(model.tau_s.tolist()),
        radius_m=tuple(model.radius_m.tolist()),
        n_by_depth=model.n_by_depth,
        bias=model.bias_n != 0.0,
    )
    bias: Iterable[float] = (model.bias_n, 0.0) if terms.bias else ()
    blocks = [model.elastic_n, model.branch_n.ravel(), model.stop_n.ravel(), np.array([*bias])]
    return terms, np.concatenate(blocks)
