"""Curves of an object that is not the same everywhere: sp_map.h."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Real, Reals
from springpot.codegen.literals import array_text, constant_text
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.model.places import interpolate_amounts, locate_in_grid, mix_materials
from springpot.codegen.stages.passive.beside import MIN_STIFFNESS_FRACTION
from springpot.codegen.stages.stage import REAL, U32, Member
from springpot.codegen.types import RealType

_STIFFEST = "max_slope_n"
_ROUNDING_MARGIN = 1.0 + 1e-5
PlaceTicks = Sequence[tuple[int, tuple[float, float]]]  # first tick of a place, m


@dataclass(frozen=True)
class MapConfig:
    """sp_map_config of sp_map.h, member by member."""

    first_x_m: Real
    first_y_m: Real
    steps_per_m_x: Real
    steps_per_m_y: Real
    nodes_x: int
    nodes_y: int
    n_materials: int
    n_curves: int

    @property
    def nodes(self) -> tuple[int, int]:
        """Nodes in x and y."""
        return self.nodes_x, self.nodes_y


@dataclass(frozen=True, eq=False)
class PlacedCurves:
    """Materials, mixed into the state's curves where the tool comes down.

    amounts: (nodes in x, nodes in y, materials). materials: (materials, curves), the numbers of all
    curves of each, end to end; sizes: of each array that they hold, by its name in the C, in order.
    start_m: the place until another is chosen. least: the least divisor at the surface, N a piece.
    """

    config: MapConfig
    amounts: Reals
    materials: Reals
    sizes: dict[str, int]
    start_m: tuple[float, float]
    least: Real

    headers = ("sp_map.h",)

    def members(self, name: str) -> tuple[Member, ...]:
        count = self.config.n_curves
        return (
            Member(f"sp_map_state {name}_map", (REAL, REAL, U32)),
            Member(f"sp_real {name}_curves[{count}]", (REAL,) * count),
        )

    def tables(self) -> list[str]:
        """Render the C tables: each material's curves, and the amounts at every node."""
        materials = self.config.n_materials
        return [
            "/* A map: amounts at the nodes, and the curves of each material (sp_map.h). */",
            array_text("amounts", "sp_real", self.amounts.reshape(-1, materials)),
            array_text("materials", "sp_real", self.materials),
            constant_text("place_map", self.config),
        ]

    @property
    def begins(self) -> dict[str, int]:
        """Index at which each array begins among a material's numbers."""
        first = np.cumsum([0, *self.sizes.values()]).tolist()
        return dict(zip(self.sizes, first, strict=False))

    def _grid(self, place_m: tuple[float, float]) -> tuple[Reals, Reals, Reals]:
        config = self.config
        first_m = np.array([config.first_x_m, config.first_y_m])
        per_step = np.array([config.steps_per_m_x, config.steps_per_m_y])
        return first_m, per_step, np.array(place_m, dtype=first_m.dtype)

    def find_changes(self, asked: PlaceTicks, lets_in: Callable[[int], int]) -> PlaceTicks:
        """Find the sites that are felt, and the first row of each, from those that were asked for.

        A site changes only while the tool is off the object. asked: rows from which each is asked
        for, in order; lets_in: the first row from one on in which the tool is off the object, or
        the history restarts. A site that is felt already changes nothing.
        """
        changes = {0: self.start_m}
        steps = locate_in_grid(self.config.nodes, *self._grid(self.start_m))
        for row, place_m in asked:
            new_steps = locate_in_grid(self.config.nodes, *self._grid(place_m))
            if new_steps != steps:
                changes[lets_in(row)] = place_m
            steps = new_steps
        return list(changes.items())

    def at(self, place_m: tuple[float, float]) -> dict[str, Reals]:
        """Return the curves at a site, m, by their names in the C."""
        amount = interpolate_amounts(self.amounts, *self._grid(place_m))
        ends = np.cumsum([*self.sizes.values()])[:-1]
        curves = dict(
            zip(self.sizes, np.split(mix_materials(amount, self.materials), ends), strict=True)
        )
        if _STIFFEST in curves:
            curves[_STIFFEST] = np.maximum(curves[_STIFFEST], self.least)
        return curves


def build_placed_curves(
    model: Hammerstein, curves_of: Callable[[Hammerstein], dict[str, Reals]], dtype: RealType
) -> PlacedCurves | None:
    """Return the map of an object that differs from site to site; None for one that is the same.

    curves_of: the arrays of a model of one material.
    """
    places = model.places
    if places is None:
        return None
    material_curves = [curves_of(model.with_slopes(slopes_n)) for slopes_n in places.slopes_n]
    for curves in material_curves:
        if _STIFFEST in curves:  # stays a bound when mixing is rounded
            curves[_STIFFEST] = _ROUNDING_MARGIN * curves[_STIFFEST]
    flat = [
        np.concatenate([arrays.ravel() for arrays in curves.values()]) for curves in material_curves
    ]
    materials = np.stack(flat).astype(dtype)
    first_x_m, first_y_m = places.first_m.astype(dtype)
    steps_per_m_x, steps_per_m_y = (1.0 / places.step_m).astype(dtype)
    return PlacedCurves(
        MapConfig(
            first_x_m, first_y_m, steps_per_m_x, steps_per_m_y, *places.nodes, *materials.shape
        ),
        places.amounts.astype(dtype),
        materials,
        {name: values.size for name, values in material_curves[0].items()},
        places.stiffest_m,
        dtype(
            MIN_STIFFNESS_FRACTION
            * max(float(arrays.get(_STIFFEST, np.zeros(1)).max()) for arrays in material_curves)
        ),
    )
