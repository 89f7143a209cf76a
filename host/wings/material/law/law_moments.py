"""Sums of products over rows: what every fit of a fractional solid on a set is made from."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from springpot.basics import Samples
from springpot.host.wings.material.law.fractional_solid import Branches, branches_for
from springpot.modelling import TrainingSet, highpass

_MIN_UNITS, _BLOCKS = 4, 10


@dataclass(frozen=True, eq=False)
class Moments:
    """Sums of products of the columns 1, depth, branches and force over some rows.

    products: (units, recordings, columns, columns). units: recordings, or blocks of rows where
    there are few; they are left out in turn. Each recording counts the same. free: whether each
    recording has a mean force of its own.
    """

    branches: Branches
    products: Samples
    free: bool

    def of(self, units: NDArray[np.bool_]) -> Samples:
        """Mean products over some units, without the means where they are free: (columns - 1,)."""
        total = np.zeros(self.products.shape[2:])
        for sums in self.products[units].sum(axis=0):
            if sums[0, 0] > 0.0:
                mean = np.outer(sums[0], sums[0]) / sums[0, 0] if self.free else 0.0
                total += (sums - mean) / sums[0, 0]
        centred: Samples = total[1:, 1:]
        return centred


def law_moments(data: TrainingSet, rows: NDArray[np.intp]) -> Moments:
    """Return moments of rows of a training set; branches for its rate and its longest recording."""
    branches = branches_for(data.dt_s, data.longest_s)
    depth_m = data.along(rows, lambda depth, at: depth[at]) - data.trained.min_m
    columns = [np.ones(len(rows)), depth_m]
    for tau_s in branches.tau_s.tolist():
        columns.append(data.along(rows, partial(_branch, tau_s=tau_s, dt_s=data.dt_s)))
    table = np.stack([*columns, data.force_n(rows)], axis=1)
    owner = data.owner(rows)
    many = len(data.recordings)
    unit = owner if many >= _MIN_UNITS else np.arange(len(rows)) * _BLOCKS // len(rows)
    products = np.zeros((int(unit.max()) + 1, many, table.shape[1], table.shape[1]))
    for u, r in sorted(set(zip(unit.tolist(), owner.tolist(), strict=True))):
        part = table[(unit == u) & (owner == r)]
        products[u, r] = part.T @ part
    return Moments(branches, products, data.contact == "always")


def _branch(depth_m: Samples, rows: NDArray[np.intp], tau_s: float, dt_s: float) -> Samples:
    return highpass(depth_m, tau_s, dt_s)[rows]
