"""Materials side by side for a tool that slides on their map: sp_lateral.h."""

import math
from dataclasses import dataclass, replace

import numpy as np

from springpot.codegen.arrays import Real, Reals, Samples
from springpot.codegen.errors import UsageError
from springpot.codegen.literals import array_text, constant_text
from springpot.codegen.model.formulas import curve_place, curve_values, pieces_of_one
from springpot.codegen.model.model import Model
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.model.places import Places
from springpot.codegen.scene import Scene
from springpot.codegen.stages.passive.from_model import hammerstein_stage
from springpot.codegen.stages.passive.hammerstein import HammersteinStage
from springpot.codegen.stages.passive.placed import PlacedCurves
from springpot.codegen.stages.passive.stored import RENEWED, stored_areas
from springpot.codegen.stages.stage import DOUBLE, REAL, U32, Member, SceneTicks

# Of a contact of incompressible bodies, sideways over along the depth: 2 (1 - v) / (2 - v), v = 1/2
# (Mindlin 1949, Compliance of elastic bodies in contact).
_SIDEWAYS = 2.0 / 3.0
_OF_LIMIT = 0.5  # of the stiffest spring that a device bears with every hand
_MOST_WAYS = 64
_NO_MAP = "the model has no map: train on recordings of places"
_DRAWN = 0.05  # of the contact's width: how far the drag's spring is drawn at the trained depth


@dataclass(frozen=True)
class DragConfig:
    """sp_drag_config of sp_drag.h, member by member."""

    width_m: Real
    stiffness_npm: Real


@dataclass(frozen=True)
class AnchorConfig:
    """sp_anchor_config of sp_anchor.h, member by member."""

    friction: Real
    stick_npm: Real
    drag_npm: Real
    ways: int


@dataclass(frozen=True, eq=False)
class LateralStage:
    """Hold what the lateral force needs beside a map.

    materials: a stage of each, which follows "lateral". areas: of each, (materials, areas), as
    `stored_areas`. m_per_piece: of the depth.
    """

    placed: PlacedCurves
    materials: tuple[HammersteinStage, ...]
    areas: Reals
    m_per_piece: Real
    drag: DragConfig
    anchor: AnchorConfig

    headers = ("sp_stored.h", "sp_lateral.h", "sp_anchor.h", "sp_drag.h")

    @property
    def of_one(self) -> HammersteinStage:
        """The stage of the first material: all have the same numbers of everything."""
        return self.materials[0]

    @property
    def members(self) -> tuple[Member, ...]:
        """State of each material, and what they share."""
        count, config = len(self.materials), self.of_one.config
        own = [
            Member(f"double lateral_{step.names.prefix}[{count * step.count}]",
                   (DOUBLE,) * (count * step.count))
            for step in self.of_one.steps if step.double
        ]  # fmt: skip
        branches, stops = count * config.n_branches, config.n_stops
        play = [Member(f"sp_real lateral_play[{stops}]", (REAL,) * stops)] if stops else []
        return (
            *own,
            Member(f"sp_real lateral_before[{branches}]", (REAL,) * branches),
            Member(f"sp_real lateral_held[{branches}]", (REAL,) * branches),
            *play,
            Member(f"sp_real lateral_stored[{count}]", (REAL,) * count),
            Member(f"sp_real lateral_takes[{count}]", (REAL,) * count),
            Member("sp_surface_state lateral_surface", (REAL, REAL)),
            Member("sp_lateral_state lateral", (REAL,) * 10 + (U32,)),
            Member("sp_anchor_state anchor", (REAL,) * 8 + (U32,) * 3),
            Member("sp_guard_state guard_x", (REAL, REAL, U32, U32)),
            Member("sp_guard_state guard_y", (REAL, REAL, U32, U32)),
        )

    def tables(self) -> list[str]:
        """Definitions of its constant arrays."""
        return [
            "/* Integrals of the curves of each material up to each node (sp_stored.h). */",
            array_text("areas", "sp_real", self.areas),
            constant_text("m_per_piece", self.m_per_piece),
            constant_text("drag", self.drag),
            constant_text("anchor", self.anchor),
        ]


def lateral_stage(
    model: Model,
    placed: PlacedCurves | None,
    scene: Scene,
    ticks: SceneTicks,
    limit_npm: float,
    jump_m: float,
) -> LateralStage | None:
    """Resolve `[places] mode`. None in the mode "held".

    placed: the model's map. limit_npm: of the stiffest spring that the device bears. jump_m: way of
    a hand in a tick at most.

    Raises UsageError if this model, or this scene, has no lateral force.
    """
    if scene.places.mode == "held":
        if scene.places.friction:
            raise UsageError('[places] friction: only of the mode "lateral"; or leave it out')
        return None
    if placed is None:
        raise _refused(_NO_MAP)
    hammerstein, places, radius_mm = _slid(model, scene)
    dtype, pulls = ticks.dtype, replace(ticks, surface=False)
    materials = tuple(
        hammerstein_stage(hammerstein.with_slopes(its), pulls, "lateral") for its in places.slopes_n
    )
    areas = np.stack([stored_areas(stage) for stage in materials])
    m_per_piece = hammerstein.span_m / pieces_of_one(hammerstein.nodes)
    # A sphere touches a circle of the radius sqrt(2 R d); its mean chord is pi/2 times that.
    width_m = 0.5 * np.pi * np.sqrt(2e-3 * radius_mm * hammerstein.span_m)
    # What renewing takes of branches that have relaxed, if their curves are straight.
    full = RENEWED * np.array(
        [_of_branches(stage, its) for stage, its in zip(materials, areas, strict=True)]
    )
    most_n = float(np.max(places.amounts @ full)) * m_per_piece / width_m
    drag = DragConfig(dtype(width_m), dtype(max(most_n, 1e-6) / (_DRAWN * width_m)))
    deepest = np.array([_deepest_n(its) for its in materials])
    stick_npm = _SIDEWAYS * float(np.max(places.amounts @ deepest)) / hammerstein.span_m
    stick_npm = max(min(stick_npm, _OF_LIMIT * limit_npm), 1.0)
    crossed = sum(math.ceil(jump_m / step_m) for step_m in places.step_m)
    anchor = AnchorConfig(
        dtype(scene.places.friction), dtype(stick_npm), drag.stiffness_npm,
        min(1 + crossed, _MOST_WAYS),
    )  # fmt: skip
    return LateralStage(placed, materials, areas.astype(dtype), dtype(m_per_piece), drag, anchor)


def _slid(model: Model, scene: Scene) -> tuple[Hammerstein, Places, float]:
    """Return a model's law and map, and the radius of the tip, mm, if a tool may slide on them."""
    hammerstein = model.hammerstein
    if hammerstein is None or hammerstein.places is None:
        raise _refused(_NO_MAP)
    if hammerstein.flow is not None or hammerstein.damage is not None:
        raise _refused("what a law with flow or damage has stored is not known")
    at_rest = hammerstein.bias_n == 0.0 and hammerstein.origin_m >= 0.0
    if (scene.guard.contact or model.contact) != "surface" or not at_rest:
        raise _refused("the object has no surface to slide on")
    for key, value, only in (
        ("coupling.mode", scene.coupling.mode, "off"),
        ("smoothing.time_constant_s", scene.smoothing.time_constant_s, 0.0),
        ("guard.outside", scene.guard.outside, "fallback"),
    ):
        if value != only:
            raise _refused(f"{key} is {value!r}, and has to be {only!r} for three axes")
    radius_mm = scene.places.tip_radius_mm
    if radius_mm is None:
        raise _refused("give tip_radius_mm, of the tip that pressed the object")
    return hammerstein, hammerstein.places, radius_mm


def _deepest_n(stage: HammersteinStage) -> float:
    """Return the force at the trained depth if nothing has relaxed, N."""
    deepest = curve_place(np.ones(1), stage.config.n_pieces)
    curves = (stage.spring[:, :, None], stage.branches)
    return float(sum(curve_values(its.astype(np.float64), deepest).sum() for its in curves))


def _of_branches(stage: HammersteinStage, areas: Samples) -> float:
    """Return the stored energy of branches that have not relaxed, at u = 1, N pieces."""
    pieces, branches = stage.config.n_pieces, stage.config.n_branches
    if pieces == 1:
        return 0.5 * float(stage.branches[0, 1].sum())
    return float(areas[pieces : pieces * (1 + branches)].reshape(pieces, branches)[-1].sum())


def _refused(why: str) -> UsageError:
    return UsageError(f'[places] mode = "lateral": {why}; or leave the mode out')
