"""Terms that a passive model is fitted from, and the model that their weights make."""

from dataclasses import dataclass, replace
from itertools import compress, product

import numpy as np

from springpot.codegen.arrays import Indices, Samples
from springpot.codegen.model.passive import FLOW_REFERENCE_FRACTION, Damage, Flow, Hammerstein
from springpot.codegen.stages.passive.beside import FUNCTIONS
from springpot.trainer.models.training_set import TrainingSet

PASSIVE_POLES = 12
DEPTH_POLES = 6  # with a rate that depends on the depth
RADIUS_SHARES = (0.02, 0.06, 0.2, 0.5)  # of the trained depth
EXPONENTS = (4.0, 8.0, 16.0, 32.0)  # of curves that stiffen steeply: exp(c u)
N_FLOW_TIMES, FLOW_POWERS = 5, (3, 5)
_SHORTEST_FLOW_S = 0.01
HEAL_S, DAMAGE_POWERS = (0.0, 60.0), (1, 3)  # 0: never
_EXPONENTIAL_PENALTY = 1e-3  # of it: for exponentials
_LOWEST_FRACTION = 0.02  # of the depth, from the lowest one
_CLEAR_FRACTION = 0.01  # of the range of the force: noise and offsets are less
_SLOPE_PENALTY = 0.02  # of the second differences' weight: enough to keep a curve straight in a gap


@dataclass(frozen=True)
class Terms:
    """The terms that a fit chooses from, in columns.

    First the plain ones: the spring's curve, those of the branches (tau_s) and of the stops
    (radius_m), and the signs that a bias may have, without a surface. Then what a richer law adds:
    curves of branches with a rate by depth (depth_tau_s, rate_ratio: see `Hammerstein`), curves of
    damage (time of healing, power), a column each for flowing branches (time constant, power,
    degree), lower powers first.
    """

    origin_m: float
    span_m: float
    nodes: int
    tau_s: tuple[float, ...]
    radius_m: tuple[float, ...]
    bias: tuple[float, ...]
    depth_tau_s: tuple[float, ...] = ()
    rate_ratio: float = 1.0
    damage: tuple[tuple[float, int], ...] = ()
    flow: tuple[tuple[float, int, int], ...] = ()

    @property
    def width(self) -> int:
        """Columns of a curve: a hat of slope at each node, and the exponentials."""
        return self.nodes + len(EXPONENTS)

    def append_exponentials(self, hats: Samples) -> Samples:
        """Columns of curves, (..., curves x width), from those of their hats, which they sum up."""
        curve_hats = hats.reshape(*hats.shape[:-1], -1, self.nodes)
        steep = curve_hats @ column_slopes(self.nodes)[self.nodes :].T / (self.nodes - 1.0)
        return np.concatenate([curve_hats, steep], axis=-1).reshape(*hats.shape[:-1], -1)

    @property
    def curves(self) -> tuple[int, int]:
        """Plain curves, and those of a richer law."""
        plain = 1 + len(self.tau_s) + len(self.radius_m)
        return plain, len(self.depth_tau_s) + len(self.damage)

    @property
    def plain_count(self) -> int:
        """Plain columns."""
        return self.width * self.curves[0] + len(self.bias)

    @property
    def count(self) -> int:
        """Count all columns."""
        return self.plain_count + self.width * self.curves[1] + len(self.flow)

    @property
    def blocks(self) -> Indices:
        """Number the block of each column, (terms,): a curve, the bias, or a flowing branch."""
        plain, richer = self.curves
        sizes = [self.width] * plain + [len(self.bias)] * bool(self.bias) + [self.width] * richer
        sizes += [1] * len(self.flow)
        return np.repeat(np.arange(len(sizes)), sizes)

    def normalised_depth(self, depth_m: Samples) -> Samples:
        """Depths as shares of the span, (n,): u of `Hammerstein`."""
        return (depth_m - self.origin_m) / self.span_m

    def roughness(self) -> Samples:
        """Return the quadratic form of weights that penalises bends of the curves, (terms, terms).

        Squared second differences of the hats, and a fiftieth of the first ones: a rise between two
        trained depths goes on as it does beside them, and what no row has seen. Exponentials are
        smooth, but one that no row has seen has no weight.
        """
        hats = np.eye(self.nodes)
        first, second = (np.diff(hats, n, axis=0) for n in (1, 2))
        block = np.zeros((self.width, self.width))
        block[: self.nodes, : self.nodes] = second.T @ second + _SLOPE_PENALTY * first.T @ first
        block[self.nodes :, self.nodes :] = _EXPONENTIAL_PENALTY * np.eye(len(EXPONENTS))
        form = np.zeros((self.count, self.count))
        begins = (0, self.plain_count)
        for begin, curves in zip(begins, self.curves, strict=True):
            block_range = slice(begin, begin + curves * self.width)
            form[block_range, block_range] = np.kron(np.eye(curves), block)
        return form

    def slopes_n(self, weights: Samples) -> tuple[Samples, Samples]:
        """Slopes at the nodes of the plain curves, (curves, nodes), N, and of the others."""
        begins = (0, self.plain_count)
        plain, richer = (
            weights[begin : begin + curves * self.width].reshape(-1, self.width)
            @ column_slopes(self.nodes)
            for begin, curves in zip(begins, self.curves, strict=True)
        )
        return plain, richer


def column_slopes(nodes: int) -> Samples:
    """Return the slopes at the nodes of each column of a curve, (width, nodes).

    Columns are hats between nodes and exponentials. Each is about 1 at u = 1, and straight beyond
    it. exp(c u) rises between nodes as straight slopes between its own slopes at the nodes say.
    """
    u = np.linspace(0.0, 1.0, nodes)
    steep = np.stack([np.exp(c * (u - 1.0)) for c in EXPONENTS])
    trapezoid = np.full(nodes, 1.0 / (nodes - 1))
    trapezoid[[0, -1]] *= 0.5
    return np.concatenate([(nodes - 1.0) * np.eye(nodes), steep / (steep @ trapezoid)[:, None]])


def plain_terms(data: TrainingSet, nodes: int, poles: int = PASSIVE_POLES) -> Terms:
    """Return a spring, four stops, `poles` branches from two samples to the longest recording.

    A bias only where the tool never leaves the object: at a surface the force is 0 by itself.
    """
    trained = data.trained
    span_m = trained.max_m - trained.min_m
    return Terms(
        origin_m=trained.min_m,
        span_m=span_m,
        nodes=nodes,
        tau_s=_space_times_s(data, 2.0 * data.dt_s, poles),
        radius_m=tuple(share * span_m for share in RADIUS_SHARES),
        bias=() if data.contact == "surface" else _allowed_bias_signs(data),
    )


def _allowed_bias_signs(data: TrainingSet) -> tuple[float, ...]:
    """Return the signs that a constant force may have: both, or that of clear forces at rest.

    A rest that no recording shows is not determined: a pad that sticks was given a push of 0.17 N
    where -2.9 to -1.3 N were measured, in the only recording, which begins in a short hold.
    """
    depth_m, force_n = np.concatenate(data.depths_m), data.force_n(np.arange(data.rows_total))
    low_m = data.trained.min_m + _LOWEST_FRACTION * (data.trained.max_m - data.trained.min_m)
    low_n, clear_n = force_n[depth_m <= low_m], _CLEAR_FRACTION * float(np.ptp(force_n))
    pushes, pulls = float(low_n.max()) > clear_n, float(low_n.min()) < -clear_n
    return (1.0, -1.0) if pushes == pulls else (1.0,) if pushes else (-1.0,)


def add_depth_rates(terms: Terms, data: TrainingSet, rate_ratio: float) -> Terms:
    """Add branches with a rate that depends on the depth."""
    times_s = _space_times_s(data, 2.0 * data.dt_s, DEPTH_POLES)
    return replace(terms, depth_tau_s=times_s, rate_ratio=rate_ratio)


def add_damage(terms: Terms) -> Terms:
    """Add curves that are softer below the largest depth so far."""
    return replace(terms, damage=tuple(product(HEAL_S, DAMAGE_POWERS)))


def add_flow(terms: Terms, data: TrainingSet) -> Terms:
    """Add branches that flow."""
    times_s = _space_times_s(data, max(_SHORTEST_FLOW_S, 2.0 * data.dt_s), N_FLOW_TIMES)
    flow = [(t, power, degree) for power in FLOW_POWERS for t in times_s for degree in FUNCTIONS]
    return replace(terms, flow=tuple(flow))


def keep_used_terms(terms: Terms, weights: Samples) -> Terms:
    """Keep the terms that have weights above 0, the spring, and a bias."""
    blocks = np.bincount(terms.blocks, weights) > 0.0
    plain, richer = terms.curves
    branch, stop = np.split(blocks[1:plain], [len(terms.tau_s)])
    optional = blocks[plain + bool(terms.bias) :]
    depth, damage, flow = np.split(optional, [len(terms.depth_tau_s), richer])
    return replace(
        terms,
        tau_s=tuple(compress(terms.tau_s, branch)),
        radius_m=tuple(compress(terms.radius_m, stop)),
        depth_tau_s=tuple(compress(terms.depth_tau_s, depth)),
        damage=tuple(compress(terms.damage, damage)),
        flow=tuple(compress(terms.flow, flow)),
    )


def _space_times_s(data: TrainingSet, shortest_s: float, count: int) -> tuple[float, ...]:
    longest_s = max(data.longest_s, 2.0 * shortest_s)
    return tuple(np.geomspace(shortest_s, longest_s, count).tolist())


def build_model(terms: Terms, weights: Samples) -> Hammerstein:
    """Build the model of terms and their weights of 0 and more, without those of 0."""
    plain, richer = terms.slopes_n(weights)
    elastic_n, branch_n, stop_n = np.split(plain, [1, 1 + len(terms.tau_s)])
    depth_n, damage_n = np.split(richer, [len(terms.depth_tau_s)])
    constant, by_depth, stopped = (curves.any(axis=1) for curves in (branch_n, depth_n, stop_n))
    bias = slice(terms.plain_count - len(terms.bias), terms.plain_count)
    return Hammerstein(
        origin_m=terms.origin_m,
        span_m=terms.span_m,
        elastic_n=elastic_n[0],
        tau_s=np.append(np.array(terms.tau_s)[constant], np.array(terms.depth_tau_s)[by_depth]),
        branch_n=np.concatenate([branch_n[constant], depth_n[by_depth]]),
        radius_m=np.array(terms.radius_m)[stopped],
        stop_n=stop_n[stopped],
        bias_n=float(weights[bias] @ np.array(terms.bias)),
        n_by_depth=int(np.count_nonzero(by_depth)),
        rate_ratio=terms.rate_ratio if by_depth.any() else 1.0,
        flow=_build_flow(terms, weights[terms.count - len(terms.flow) :]),
        damage=_build_damage(terms, damage_n),
    )


def _build_flow(terms: Terms, force_n: Samples) -> Flow | None:
    used = [(*term, n) for term, n in zip(terms.flow, force_n.tolist(), strict=True) if n > 0.0]
    if not used:
        return None
    tau_s, power, degree, branch_n = (np.array(term) for term in zip(*used, strict=True))
    return Flow(1.0 / (tau_s * FLOW_REFERENCE_FRACTION ** (power - 1.0)), power, degree, branch_n)


def _build_damage(terms: Terms, curve_n: Samples) -> Damage | None:
    used = curve_n.any(axis=1)
    if not used.any():
        return None
    heal_s, power = (np.array(values)[used] for values in zip(*terms.damage, strict=True))
    return Damage(heal_s, power, curve_n[used])
