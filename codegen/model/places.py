"""A map of places: materials on a grid, and how much of each there is at a place."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import (
    Real,
    Reals,
    Samples,
    require,
    require_not_negative,
    require_positive,
    require_shape,
)

MAX_NODES = 100  # of an axis, and of a curve


@dataclass(frozen=True, eq=False)
class Places:
    """Materials on a regular grid: force at a place = sum of amount_r(place) times that of r.

    first_m, step_m: place of the first node, and from node to node, x and y, (2,). amounts: of each
    material at each node, (nodes in x, nodes in y, materials), >= 0; bilinear between nodes, and
    constant outside the grid. slopes_n: of each material what `Hammerstein.slopes_n` gives,
    (materials, slopes).
    """

    first_m: Samples
    step_m: Samples
    amounts: Samples
    slopes_n: Samples

    def require_valid(self, slopes: int) -> None:
        """Raise DataError, with field and reason."""
        require(self.amounts.ndim == 3, f"places.amounts: {self.amounts.ndim} axes, not 3")
        in_range = all(2 <= n <= MAX_NODES for n in self.nodes)
        require(in_range, f"places.amounts: {self.nodes}, not 2 to {MAX_NODES}")
        require_shape("places.first_m", self.first_m, (2,))
        require_positive("places.step_m", self.step_m, (2,))
        materials = self.amounts.shape[2]
        require_not_negative("places.amounts", self.amounts, (*self.nodes, materials))
        require_not_negative("places.slopes_n", self.slopes_n, (materials, slopes))

    @property
    def last_m(self) -> Samples:
        """Place of the last node, x and y, (2,)."""
        last_m: Samples = self.first_m + self.step_m * (np.array(self.nodes) - 1)
        return last_m

    @property
    def nodes(self) -> tuple[int, int]:
        """Nodes in x and in y."""
        return self.amounts.shape[0], self.amounts.shape[1]

    @property
    def stiffest_m(self) -> tuple[float, float]:
        """Place of the stiffest node, x and y: what holds there is safe elsewhere."""
        stiffness = (self.amounts @ self.slopes_n).sum(axis=2)
        node = np.unravel_index(int(np.argmax(stiffness)), self.nodes)
        x_m, y_m = (self.first_m + self.step_m * np.array(node)).tolist()
        return x_m, y_m

    @property
    def most_n(self) -> Samples:
        """Return the greatest of each slope over all places, (slopes,)."""
        most_n: Samples = np.max(self.amounts @ self.slopes_n, axis=(0, 1))
        return most_n


def locate_in_grid(
    nodes: tuple[int, ...], first_m: Reals, per_step: Reals, place_m: Reals
) -> tuple[Real, ...]:
    """Return a site in steps from the grid's first node, clamped (sp_map_grid_coordinate)."""
    node_position = ((place_m - first_m) * per_step).tolist()
    real = per_step.dtype.type
    return tuple(
        real(min(coordinate if coordinate > 0.0 else 0.0, n - 1))
        for coordinate, n in zip(node_position, nodes, strict=True)
    )


def interpolate_amounts(amounts: Reals, first_m: Reals, per_step: Reals, place_m: Reals) -> Reals:
    """Return the amount of each material at a site, (materials,), bilinearly (sp_map_amounts)."""
    real = amounts.dtype.type
    steps = locate_in_grid(amounts.shape[:2], first_m, per_step, place_m)
    i, j = (min(int(at), nodes - 2) for at, nodes in zip(steps, amounts.shape[:2], strict=True))
    x, y, one = steps[0] - real(i), steps[1] - real(j), real(1)
    weights = ((one - x) * (one - y), (one - x) * y, x * (one - y), x * y)
    corners = (amounts[i, j], amounts[i, j + 1], amounts[i + 1, j], amounts[i + 1, j + 1])
    total: Reals = weights[0] * corners[0]
    for weight, corner in zip(weights[1:], corners[1:], strict=True):
        total = total + weight * corner
    return total


def mix_materials(amount: Reals, materials: Reals) -> Reals:
    """sp_map_mix: sum of the materials, (materials, n), by their amounts, in the order of the C."""
    total: Reals = amount[0] * materials[0]
    for weight, material in zip(amount[1:], materials[1:], strict=True):
        total = total + weight * material
    return total
