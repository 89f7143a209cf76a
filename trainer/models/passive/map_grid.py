"""The grid of a map: nodes over the sites, their weights at each, and what is rough."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.model.places import amounts_at
from springpot.trainer.recordings.quality.places import Site

# Of a node at a site: where every node has a site of so much, the sites are a grid themselves.
_AT_NODE = 0.8


@dataclass(frozen=True, eq=False)
class Grid:
    """Nodes in x and y, and where. weights: of each node at each site, (sites, nodes).

    finer: nodes along an axis for each that the sites have.
    """

    first_m: Samples
    step_m: Samples
    nodes: tuple[int, int]
    weights: Samples
    finer: int = 1

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


def grid_of(sites: Sequence[Site]) -> Grid:
    """As many nodes as there are sites, over the rectangle that they span.

    Sites that are no grid themselves have some nodes in pairs and leave others without any, whose
    amounts then swing. Twice as many nodes along each axis follow the sites wherever they are, and
    the least bend fills what is between.
    """
    grid = _grid(np.array(sites), 1)
    even = bool(grid.weights.max(axis=0).min() >= _AT_NODE)
    return grid if even else _grid(np.array(sites), 2)


def _grid(at: Samples, finer: int) -> Grid:
    first_m, span_m = at.min(axis=0), np.ptp(at, axis=0)
    wide = np.maximum(span_m, 1e-3 * span_m.max())
    across = finer * np.sqrt(len(at) * wide / wide[::-1])
    nx, ny = (max(2, round(n)) for n in across.tolist())
    step_m = wide / (np.array([nx, ny]) - 1)
    eye = np.eye(nx * ny).reshape(nx, ny, -1)
    weights = np.stack([amounts_at(eye, first_m, 1.0 / step_m, site) for site in at])
    return Grid(first_m, step_m, (nx, ny), weights, finer)
