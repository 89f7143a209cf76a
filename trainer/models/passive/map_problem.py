"""The grid of a map, and its least squares: materials and their amounts, fitted in turn.

The force at a place is linear in what its materials are, and in how much there is of each. So each
of the two is found by non-negative least squares from the sites' normal equations while the other
stays.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from math import inf
from operator import add

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.model.places import Places, interpolate_amounts
from springpot.trainer.models.passive.nonnegative import Normal, sparse_solve
from springpot.trainer.models.passive.passive_terms import Terms, build_model, keep_used_terms
from springpot.trainer.models.passive.recovery import SPARSE_LOSS
from springpot.trainer.recordings.recording import Site

MATERIALS = (1, 2)
# On the second differences of the amounts from node to node: enough to fill nodes without a site.
# Leaving sites out would choose a hundred times as much, for it has to bridge holes; on places
# between sites that is half as much error again.
_AMOUNT_PENALTY = 1e-3
_FOLDS, _SWEEPS = 5, 8
_MAX_ERROR_RATIO = 0.9  # times the error of a map with fewer materials
_MIN_AMOUNT_FRACTION = (
    1e-3  # of the largest amount, at every node: what nothing resists has no surface
)
NODES_PER_SITE = 2  # nodes along an axis for each that as many sites in a grid would have


@dataclass(frozen=True, eq=False)
class Grid:
    """Nodes in x and y, and where. weights: of each node at each site, (sites, nodes)."""

    first_m: Samples
    step_m: Samples
    nodes: tuple[int, int]
    weights: Samples

    @property
    def roughness(self) -> Samples:
        """Return the quadratic form of the amounts that bends cost, (nodes, nodes)."""
        nx, ny = self.nodes
        eye = np.eye(nx * ny).reshape(nx, ny, -1)
        bends = (
            np.diff(eye, 2, axis=0), np.diff(eye, 2, axis=1),
            np.sqrt(2.0) * np.diff(np.diff(eye, axis=0), axis=1),
        )  # fmt: skip
        rows = np.concatenate([bend.reshape(-1, nx * ny) for bend in bends])
        form: Samples = rows.T @ rows
        return form


def build_grid(sites: Sequence[Site], nodes_per_site: int = NODES_PER_SITE) -> Grid:
    """Lay a grid over the sites' rectangle, with twice as many nodes along each axis as sites.

    The least bend fills what is between. One node for each site is off by 1.3 to 4.6 times as much
    between the sites of a grid, for its pieces are straight, and leaves nodes without any site
    where the sites are no grid.
    """
    sites_m = np.array(sites)
    first_m, span_m = sites_m.min(axis=0), np.ptp(sites_m, axis=0)
    extent_m = np.maximum(span_m, 1e-3 * span_m.max())
    across = nodes_per_site * np.sqrt(len(sites_m) * extent_m / extent_m[::-1])
    nx, ny = (max(2, round(n)) for n in across.tolist())
    step_m = extent_m / (np.array([nx, ny]) - 1)
    eye = np.eye(nx * ny).reshape(nx, ny, -1)
    weights = np.stack([interpolate_amounts(eye, first_m, 1.0 / step_m, site) for site in sites_m])
    return Grid(first_m, step_m, (nx, ny), weights)


@dataclass(frozen=True, eq=False)
class MapProblem:
    """Normal equations of each site in some terms; penalty: on the roughness of curves.

    full: sites with presses that show the law.
    """

    grid: Grid
    terms: Terms
    penalty: float
    sites: Sequence[Normal]
    full: Sequence[int]

    @property
    def amounts(self) -> Samples:
        """Amount of one material at each site, (sites,)."""
        amounts, _ = self.fitted(range(len(self.sites)), 1)
        return (self.grid.weights @ amounts)[:, 0]

    def sparse(self) -> "MapProblem":
        """Keep as few branches, stops and curves as serve a map of one material."""
        amounts = self.amounts
        scaled = [_scale_normal(self.sites[k], amounts[k : k + 1]) for k in self.full]
        weights = sparse_solve(
            self._add_penalty(reduce(add, scaled), 1), self.terms.blocks, SPARSE_LOSS
        )
        used = np.bincount(self.terms.blocks, weights) > 0.0
        used[0] = True  # the spring
        columns = used[self.terms.blocks]
        square = np.ix_(columns, columns)
        sites = [
            replace(site, matrix=site.matrix[square], vector=site.vector[columns])
            for site in self.sites
        ]
        return replace(self, terms=keep_used_terms(self.terms, weights), sites=sites)

    def chosen(self, seed: int) -> tuple[int, float]:
        """Return the materials, as few as serve, and the error at sites left out, N."""
        count, error_n = 0, inf
        for trial in MATERIALS:
            trial_n = self._cross_validated_rmse_n(trial, seed)
            if trial_n < _MAX_ERROR_RATIO * error_n:
                count, error_n = trial, trial_n
        return count, error_n

    def _cross_validated_rmse_n(self, count: int, seed: int) -> float:
        """Return the error at sites that a map was fitted without, RMS over sites, N."""
        fold = np.random.default_rng(seed).permutation(len(self.sites)) % _FOLDS
        squares = []
        for number in range(min(_FOLDS, len(self.sites))):
            inside = np.flatnonzero(fold != number).tolist()
            amounts, materials = self.fitted(inside, count)
            for k in np.flatnonzero(fold == number).tolist():
                weights = (self.grid.weights[k] @ amounts) @ materials
                squares.append(self.sites[k].rmse(weights) ** 2)
        return float(np.sqrt(np.mean(squares)))

    def fitted(self, inside: Sequence[int], count: int) -> tuple[Samples, Samples]:
        """Fit amounts, (nodes, count), and materials, (count, terms), to the sites `inside`."""
        full = [k for k in self.full if k in inside] or list(inside)
        materials = self._initial_materials(full, count)
        for _ in range(_SWEEPS):
            here = self.grid.weights @ self._amounts(inside, materials)
            scaled = reduce(add, (_scale_normal(self.sites[k], here[k]) for k in full))
            materials = self._add_penalty(scaled, count).solve().reshape(count, -1)
        return self._amounts(inside, materials), materials

    def _initial_materials(self, full: Sequence[int], count: int) -> Samples:
        """Guess materials to begin with, (count, terms): all sites' law, and sites unlike it."""
        total = reduce(add, (self.sites[k] for k in full))
        materials = [self._add_penalty(total, 1).solve()]
        if count > 1:
            site_fits = np.stack([self._add_penalty(self.sites[k], 1).solve() for k in full])
            size = np.sqrt(np.diag(site_fits @ total.matrix @ site_fits.T))
            for _ in range(count - 1):
                basis = np.stack(materials)
                shared = np.linalg.pinv(basis @ total.matrix @ basis.T)
                residual = site_fits - (site_fits @ total.matrix @ basis.T) @ shared @ basis
                unexplained = (
                    np.sqrt(np.maximum(np.diag(residual @ total.matrix @ residual.T), 0.0)) / size
                )
                materials.append(site_fits[int(np.argmax(unexplained))])
        return np.stack(materials)

    def _amounts(self, inside: Sequence[int], materials: Samples) -> Samples:
        """Fit the amounts at the nodes, (nodes, materials), for given materials."""
        nodes, count = len(self.grid.roughness), len(materials)
        matrix, vector = np.zeros((nodes * count, nodes * count)), np.zeros(nodes * count)
        for k in inside:
            site, weight = self.sites[k], self.grid.weights[k]
            gram = materials @ site.matrix @ materials.T / site.rows
            matrix += np.kron(np.outer(weight, weight), gram)
            vector += np.kron(weight, materials @ site.vector / site.rows)
        mean_scale = np.diag(np.diag(matrix).reshape(nodes, count).sum(axis=0) / len(inside))
        # A bend has the same worth on a finer grid: its square, over a step squared.
        rough = _AMOUNT_PENALTY * NODES_PER_SITE**2 * np.kron(self.grid.roughness, mean_scale)
        solved = Normal(matrix + rough, vector, 0.0, len(inside)).solve()
        return solved.reshape(nodes, count)

    def _add_penalty(self, normal: Normal, count: int) -> Normal:
        return normal.penalised(self.penalty * _kron(np.eye(count), self.terms.roughness()))

    def model(self, amounts: Samples, materials: Samples) -> Hammerstein:
        """Return the map as a model; its own slopes are the most of any site."""
        floor = 1e-12 * materials.sum(axis=0)  # so that all materials have the same curves
        models = [build_model(self.terms, np.maximum(material, floor)) for material in materials]
        nodes = np.maximum(amounts, _MIN_AMOUNT_FRACTION * amounts.max(axis=0)).reshape(
            *self.grid.nodes, -1
        )
        slopes_n = np.stack([material.slopes_n for material in models])
        places = Places(self.grid.first_m, self.grid.step_m, nodes, slopes_n)
        return replace(models[0].with_slopes(places.most_n), places=places)


def _scale_normal(site: Normal, amounts: Samples) -> Normal:
    """Normal equations of the materials, (materials x terms,), at a site with these amounts."""
    matrix = _kron(np.outer(amounts, amounts), site.matrix)
    return Normal(matrix, _kron(amounts, site.vector), site.square, site.rows)


def _kron(one: Samples, other: Samples) -> Samples:
    return np.asarray(np.kron(one, other), dtype=np.float64)
