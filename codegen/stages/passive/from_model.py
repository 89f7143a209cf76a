"""Fold a passive model into the arrays of its stage."""

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.model.formulas import curve_nodes
from springpot.codegen.model.passive import Hammerstein, power_order
from springpot.codegen.stages.passive.damage import damage_curves, steepest_n
from springpot.codegen.stages.passive.flow import FlowBranches, flow_branches
from springpot.codegen.stages.passive.hammerstein import (
    HammersteinConfig,
    HammersteinStage,
    StartMemory,
)
from springpot.codegen.stages.passive.maxwell import branch_steps
from springpot.codegen.stages.passive.placed import placed_curves
from springpot.codegen.stages.passive.surface import RecoveringSurface, surface_of
from springpot.codegen.stages.stage import SceneTicks
from springpot.codegen.types import RealType


def hammerstein_stage(model: Hammerstein, ticks: SceneTicks, follows: str) -> HammersteinStage:
    """Fold the poles' gains into the branches; the stops' first halves belong to the spring.

    The branches are padded to whole vectors of the ticks, with curves of 0. The surface of the
    ticks, if there is one, recovers if the model's does.
    """

    def curves_of(material: Hammerstein) -> dict[str, Reals]:
        return hammerstein_stage(material, ticks, follows).curves

    dtype, n_stops = ticks.dtype, len(model.radius_m)
    steps, slopes_n, held_n = branch_steps(model, ticks)
    remembers = model.starts_conditioned if ticks.conditioned is None else ticks.conditioned
    spring_n = model.elastic_n + model.stop_n.sum(axis=0)
    flow = None if model.flow is None else flow_branches(model.flow, ticks)
    damage = None if model.damage is None else damage_curves(model.damage, ticks)
    stops = curve_nodes(model.stop_n).astype(dtype)
    return HammersteinStage(
        config=HammersteinConfig(
            origin_m=dtype(model.origin_m),
            per_span=dtype(1.0 / model.span_m),
            bias_n=dtype(model.bias_n),
            n_pieces=model.nodes,
            n_branches=len(slopes_n),
            n_stops=n_stops,
        ),
        spring=curve_nodes(spring_n[None])[:, :, 0].astype(dtype),
        branches=curve_nodes(slopes_n).astype(dtype),
        steps=steps,
        stops=np.moveaxis(stops, 2, 0),
        radius=(model.radius_m / model.span_m).astype(dtype),
        flow=flow,
        damage=damage,
        surface=_surface(model, spring_n + slopes_n.sum(axis=0), flow, dtype)
        if ticks.surface and model.recovers
        else None,
        pulls=not ticks.surface,
        follows=follows,
        placed=placed_curves(model, curves_of, dtype),
        start=_start(model, held_n, dtype) if remembers else None,
    )


def _start(model: Hammerstein, held_n: Reals, dtype: RealType) -> StartMemory:
    memory = model.memory
    flow = memory.flow if model.flow is None else memory.flow[power_order(model.flow)]
    deepest = memory.deepest if model.damage is None else memory.deepest[power_order(model.damage)]
    return StartMemory(held_n.astype(dtype), flow.astype(dtype), deepest.astype(dtype))


def _surface(
    model: Hammerstein, slopes_n: Reals, flow: FlowBranches | None, dtype: RealType
) -> RecoveringSurface:
    beside_n = np.zeros(model.nodes)
    if flow is not None:
        beside_n = beside_n + flow.slopes_n(model.nodes)
    if model.damage is not None:
        beside_n = beside_n + steepest_n(model.damage)
    return surface_of(slopes_n + beside_n, dtype)
