"""The grid of a map: nodes over the sites, their weights at each, and what is rough."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.model.passive import amounts_at
from springpot.trainer.recordings.recording import Site

FINER = 2  # nodes along an axis for each that as many sites in a grid would have


@dataclass(frozen=True, eq=False)
class Grid:
    """Nodes in x and y, and where. weights: of each node at each site, (sites, nodes)."""

    first_m: Samples
    step_m: Samples
    nodes: tuple[int, int]
    weights: Samples

    @property
    def roughness(self) -> Samples:
        """Quadratic form of the amounts, (nodes, nodes): their squared second differences."""
        nx, ny = self.nodes
        eye = np.eye(nx * ny).reshape(nx, ny, -1)
        bends = (
            np.diff(eye, 2, axis=0), np.diff(eye, 2, axis=1),
            np.sqrt(2.0) * np.diff(np.diff(eye, axis=0), axis=1),
        )  # fmt: skip
        rows = np.concatenate([bend.reshape(-1, nx * ny) for bend in bends])
        form: Samples = rows.T @ rows
        return form


def grid_of(sites: Sequence[Site], finer: int = FINER) -> Grid:
    """Twice as many nodes along each axis as sites, over the rectangle that these span.

    The least bend fills what is between. One node for each site is off by 1.3 to 4.6 times as much
    between the sites of a grid, for its pieces are straight, and leaves nodes without any site
    where the sites are no grid.
    """
    at = np.array(sites)
    first_m, span_m = at.min(axis=0), np.ptp(at, axis=0)
    wide = np.maximum(span_m, 1e-3 * span_m.max())
    across = finer * np.sqrt(len(at) * wide / wide[::-1])
    nx, ny = (max(2, round(n)) for n in across.tolist())
    step_m = wide / (np.array([nx, ny]) - 1)
    eye = np.eye(nx * ny).reshape(nx, ny, -1)
    weights = np.stack([amounts_at(eye, first_m, 1.0 / step_m, site) for site in at])
    return Grid(first_m, step_m, (nx, ny), weights)
