"""The passive model: sp_hammerstein.h, and beside it flow, damage and the surface."""

from dataclasses import dataclass, replace

import numpy as np

from springpot.codegen.arrays import Real, Reals
from springpot.codegen.literals import array_text, constant_text, members_text
from springpot.codegen.model.formulas import integrate_slopes
from springpot.codegen.model.passive import Hammerstein, sort_by_power
from springpot.codegen.stages.passive.beside import (
    DamageCurves,
    FlowBranches,
    RecoveringSurface,
    bound_damage_slopes_n,
    build_damage_curves,
    build_flow_branches,
    build_surface,
)
from springpot.codegen.stages.passive.maxwell import MaxwellBranches, group_branches
from springpot.codegen.stages.passive.motion import PassiveMotion
from springpot.codegen.stages.passive.placed import PlacedCurves, PlaceTicks, build_placed_curves
from springpot.codegen.stages.stage import (
    DOUBLE,
    REAL,
    Member,
    SceneTicks,
    Stage,
    Starts,
    segments,
    stage_code,
)
from springpot.codegen.types import RealType, Scalar


@dataclass(frozen=True)
class HammersteinConfig:
    """sp_hammerstein_config of sp_hammerstein.h, member by member."""

    origin_m: Real
    u_per_m: Real
    bias_n: Real
    n_intervals: int
    n_branches: int
    n_stops: int


@dataclass(frozen=True, eq=False)
class StartMemory:
    """`Memory` that the object begins with when its history restarts, in the order of the stage.

    held_n: of branches, (capacity,), N; flow: h, (F,); deepest: M of damage, (D,); play: of stops,
    (K,); force_n: at u. near_u: how deep a tool may be, least and most, that goes on from u in the
    next tick. surface: the object has one.
    """

    held_n: Reals
    flow: Reals
    deepest: Reals
    play: Reals
    u: Scalar
    force_n: Scalar
    near_u: tuple[Scalar, Scalar]
    surface: bool

    def position(self, tool_u: Scalar) -> Scalar | None:
        """Return the depth u at which the model starts for a tool at tool_u; None: at rest.

        The next tick moves it to the tool. At a surface a tool above is let go in it, and one far
        below has come there slowly; without one the object would pull or push at either.
        """
        least, most = self.near_u
        if self.surface:
            return tool_u if tool_u > most else self.u
        return None if tool_u < least or tool_u > most else self.u

    def tables(self) -> list[str]:
        """Render the state in which training ended as C tables, for scenes that start with it."""
        named = {"held": self.held_n, "flow": self.flow, "deepest": self.deepest, "play": self.play}
        return [
            "/* The object as the training presses left it, when its history restarts. */",
            *(
                array_text(f"start_{name}", "sp_real", values)
                for name, values in named.items()
                if values.size
            ),
        ]


@dataclass(frozen=True, eq=False)
class HammersteinStage(Stage):
    """Arrays of sp_hammerstein_tables, and the variable of the tick that it follows.

    Curves: values and slopes at nodes, (J + 1, 2, curves). spring: one, branches: one each, stops:
    (stops, J + 1, 2), radius: (stops,). steps: who steps which branches; those of curve 0 fill
    whole vectors. flow, damage, surface: None if the model, or the scene, has none. pulls: its
    force may be below 0.
    placed: how the curves differ from place to place; those here are the most of any place.
    start: None if the object has rested for ever where its history restarts.
    follows: "clipped" (to the trained range) or "penetration" (not clipped). Its force is the C
    variable `{follows}_passive_n`.
    """

    config: HammersteinConfig
    spring: Reals
    branches: Reals
    steps: tuple[MaxwellBranches, ...]
    stops: Reals
    radius: Reals
    flow: FlowBranches | None
    damage: DamageCurves | None
    surface: RecoveringSurface | None
    pulls: bool
    follows: str
    placed: PlacedCurves | None = None
    start: StartMemory | None = None

    code = stage_code("passive")

    @property
    def _extra_parts(self) -> list[FlowBranches | DamageCurves]:
        """List the parts that add a force to spring, branches and stops."""
        return [part for part in (self.flow, self.damage) if part is not None]

    @property
    def headers(self) -> tuple[str, ...]:
        stepped = [header for step in self.steps for header in step.names.headers]
        beside = [header for part in self._extra_parts for header in part.headers]
        surface = self.surface.headers if self.surface else ()
        core = ("sp_number.h", "sp_curve.h", "sp_stops.h", "sp_hammerstein.h")
        placed = self.placed.headers if self.placed else ()
        return (*core, *stepped, *beside, *surface, *placed)

    @property
    def members(self) -> tuple[Member, ...]:
        """Return the members of sp_state: inputs and forces of branches, sliders, the rest."""
        capacity, stops, name = self.config.n_branches, self.config.n_stops, self.follows
        slow = [
            Member(f"double {name}_{step.names.prefix}[{step.count}]", (DOUBLE,) * step.count)
            for step in self.steps
            if step.double
        ]
        play = (Member(f"sp_real {name}_play[{stops}]", (REAL,) * stops),) if stops else ()
        return (
            *slow,
            Member(f"sp_real {name}_before[{capacity}]", (REAL,) * capacity),
            Member(f"sp_real {name}_held[{capacity}]", (REAL,) * capacity),
            *play,
            *(member for part in self._extra_parts for member in part.members(name)),
            *(self.surface.members(name) if self.surface else ()),
            *(self.placed.members(name) if self.placed else ()),
        )

    @property
    def curves(self) -> dict[str, Reals]:
        """Return the arrays that a site scales, by their names in C; all of them are linear."""
        arrays = {"spring": self.spring, "branches": self.branches, "stops": self.stops}
        if self.damage is not None:
            arrays["damage"] = self.damage.curves
        if self.flow is not None:
            arrays["flow_n"] = self.flow.force_n
        if self.surface is not None:
            arrays["max_slope_n"] = self.surface.max_slope_n
        return {name: values for name, values in arrays.items() if values.size}

    def at(self, place_m: tuple[float, float] | None) -> "HammersteinStage":
        """Return the stage with the curves of a site, x and y, m; None: of the stiffest."""
        if self.placed is None:
            return self
        mixed = self.placed.at(place_m or self.placed.start_m)
        curves_here = {
            name: mixed[name].reshape(array.shape) for name, array in self.curves.items()
        }
        return replace(
            self,
            spring=curves_here["spring"],
            branches=curves_here["branches"],
            stops=curves_here.get("stops", self.stops),
            damage=self.damage and replace(self.damage, curves=curves_here["damage"]),
            flow=self.flow and replace(self.flow, force_n=curves_here["flow_n"]),
            surface=self.surface and replace(self.surface, max_slope_n=curves_here["max_slope_n"]),
            placed=None,
        )

    def tables(self) -> list[str]:
        """Render the C tables: curves of spring and branches, losses, radii of the sliders."""
        stops = bool(self.config.n_stops)
        parts = [
            "/* Curves: values and slopes at the nodes, a column a branch (sp_curve.h). */",
            array_text("spring", "sp_real", self.spring.ravel()),
            array_text("branches", "sp_real", self.branches.reshape(-1, self.config.n_branches)),
            *(line for step in self.steps for line in step.tables()),
            *(line for part in self._extra_parts for line in part.tables()),
            *(self.surface.tables() if self.surface else ()),
            *(self.start.tables() if self.start else ()),
        ]
        if stops:
            parts += [
                array_text("stops", "sp_real", self.stops.reshape(self.config.n_stops, -1)),
                array_text("stop_radius", "sp_real", self.radius),
            ]
        if self.placed is not None:
            mixed = tuple(f"static const sp_real {name}[" for name in self.curves)
            constant = [part for part in parts[1:] if not part.startswith(mixed)]
            config = constant_text("passive", self.config)
            return [*self.placed.tables(), *constant, config]
        return [
            *parts,
            constant_text("passive", self.config),
            members_text(
                "passive_tables",
                "sp_hammerstein_tables",
                {
                    "spring": "spring",
                    "branches": "branches",
                    "stops": "stops" if stops else "NULL",
                    "radius": "stop_radius" if stops else "NULL",
                },
            ),
        ]

    def reference(self, depth: Reals, starts: Starts, places: PlaceTicks = ()) -> Reals:
        """Force of every tick, (n,), N.

        places: the first tick of each, m, the first of them in tick 0; without any, the most of all
        places.
        """
        config = self.config
        u = (depth - config.origin_m) * config.u_per_m
        force_n = np.empty_like(u)
        chosen = dict(places)
        later = [tick for tick in chosen if 0 < tick < len(depth)]
        changes = np.union1d(starts, later).astype(np.intp)
        stage = self
        for begin, end, rests in segments(len(depth), changes):
            # A restart leaves the model at rest at u; the C's state begins as zeros.
            at_rest = u[begin] if rests else u.dtype.type(0)
            stage = self.at(chosen[begin]) if begin in chosen else stage
            force_n[begin:end] = PassiveMotion(stage, at_rest).along(u[begin:end])[0]
        return force_n if self.pulls else np.where(force_n > 0, force_n, u.dtype.type(0))


def hammerstein_stage(model: Hammerstein, ticks: SceneTicks, follows: str) -> HammersteinStage:
    """Turn a fitted passive model into the tables that a tick evaluates.

    The gains of the poles are folded into the branches' curves, which are padded to whole vectors.
    A stop (a slider with a spring: friction) is P(u) - P(play): P(u) is added to the spring's
    curve, and a tick subtracts P(play). follows: the depth of a tick that the model is evaluated
    at, "penetration" or "clipped". A model without a surface may pull.
    """

    def curves_of(material: Hammerstein) -> dict[str, Reals]:
        return hammerstein_stage(material, ticks, follows).curves

    dtype, n_stops = ticks.dtype, len(model.radius_m)
    steps, slopes_n, held_n = group_branches(model, ticks)
    springs_n = np.vstack([model.elastic_n, model.stop_n])
    flow = None if model.flow is None else build_flow_branches(model.flow, ticks)
    damage = None if model.damage is None else build_damage_curves(model.damage, ticks)
    stops, start = integrate_slopes(model.stop_n).astype(dtype), None
    if model.continues:
        memory, reach_u = model.memory, ticks.start_reach_m / model.span_m
        flow_n, deepest = memory.flow, memory.deepest
        flow_n = flow_n if model.flow is None else flow_n[sort_by_power(model.flow)]
        deepest = deepest if model.damage is None else deepest[sort_by_power(model.damage)]
        start = StartMemory(
            held_n=held_n.astype(dtype),
            flow=flow_n.astype(dtype),
            deepest=deepest.astype(dtype),
            play=memory.play.astype(dtype),
            u=dtype(memory.u),
            force_n=dtype(memory.force_n),
            near_u=(dtype(memory.u - reach_u), dtype(memory.u + reach_u)),
            surface=ticks.surface,
        )
    return HammersteinStage(
        config=HammersteinConfig(
            origin_m=dtype(model.origin_m),
            u_per_m=dtype(1.0 / model.span_m),
            bias_n=dtype(model.bias_n),
            n_intervals=model.nodes,
            n_branches=len(slopes_n),
            n_stops=n_stops,
        ),
        spring=integrate_slopes(springs_n.sum(axis=0)[None])[:, :, 0].astype(dtype),
        branches=integrate_slopes(slopes_n).astype(dtype),
        steps=steps,
        stops=np.moveaxis(stops, 2, 0),
        radius=(model.radius_m / model.span_m).astype(dtype),
        flow=flow,
        damage=damage,
        surface=_build_surface(model, np.vstack([springs_n, slopes_n]), flow, dtype)
        if ticks.surface and model.recovers
        else None,
        pulls=not ticks.surface,
        follows=follows,
        placed=build_placed_curves(model, curves_of, dtype),
        start=start,
    )


def _build_surface(
    model: Hammerstein, slopes_n: Reals, flow: FlowBranches | None, dtype: RealType
) -> RecoveringSurface:
    """Return the recovering surface, by the most that all curves together rise at each node."""
    most_n = slopes_n.sum(axis=0)
    if flow is not None:
        most_n = most_n + flow.slopes_n(model.nodes)
    if model.damage is not None:
        most_n = most_n + bound_damage_slopes_n(model.damage)
    return build_surface(most_n, dtype)
