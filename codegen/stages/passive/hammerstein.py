"""The passive model: sp_hammerstein.h, and beside it flow, damage and the surface."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from springpot.codegen.arrays import Real, Reals
from springpot.codegen.literals import array_text, constant_text, members_text
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.passive.damage import DamageCurves
from springpot.codegen.stages.passive.flow import FlowBranches
from springpot.codegen.stages.passive.maxwell import MaxwellBranches
from springpot.codegen.stages.passive.motion import PassiveMotion
from springpot.codegen.stages.passive.placed import PlacedCurves, Taken
from springpot.codegen.stages.passive.surface import RecoveringSurface
from springpot.codegen.stages.stage import (
    DOUBLE,
    REAL,
    Measured,
    Member,
    Stage,
    Starts,
    segments,
)


@dataclass(frozen=True)
class HammersteinConfig:
    """sp_hammerstein_config of sp_hammerstein.h, member by member."""

    origin_m: Real
    per_span: Real
    bias_n: Real
    n_pieces: int
    n_branches: int
    n_stops: int


@dataclass(frozen=True, eq=False)
class HammersteinStage(Stage):
    """Arrays of sp_hammerstein_tables, and the variable of the tick that it follows.

    Curves: values and slopes at nodes, (J + 1, 2, curves). spring: one, branches: one each, stops:
    (stops, J + 1, 2), radius: (stops,). steps: who steps which branches; those of curve 0 fill
    whole vectors. flow, damage, surface: None if the model, or the scene, has none. pulls: its
    force may be below 0.
    placed: how the curves differ from place to place; those here are the most of any place.
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

    @property
    def _beside(self) -> list[FlowBranches | DamageCurves]:
        """What adds a force of its own to spring, branches and stops."""
        return [part for part in (self.flow, self.damage) if part is not None]

    @property
    def headers(self) -> tuple[str, ...]:
        stepped = [header for step in self.steps for header in step.names.headers]
        beside = [header for part in self._beside for header in part.headers]
        surface = self.surface.headers if self.surface else ()
        own = ("sp_number.h", "sp_curve.h", "sp_stops.h", "sp_hammerstein.h")
        placed = self.placed.headers if self.placed else ()
        return (*own, *stepped, *beside, *surface, *placed)

    @property
    def members(self) -> tuple[Member, ...]:
        """Input and state of each branch, the slow ones' own, play of each stop, and the rest's."""
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
            *(member for part in self._beside for member in part.members(name)),
            *(self.surface.members(name) if self.surface else ()),
            *(self.placed.members(name) if self.placed else ()),
        )

    @property
    def curves(self) -> dict[str, Reals]:
        """Arrays that a place scales, by their names in the C; all of them are linear in it."""
        found = {"spring": self.spring, "branches": self.branches, "stops": self.stops}
        if self.damage is not None:
            found["damage"] = self.damage.curves
        if self.flow is not None:
            found["flow_n"] = self.flow.force_n
        if self.surface is not None:
            found["stiffest"] = self.surface.stiffest
        return {name: values for name, values in found.items() if values.size}

    def at(self, place_m: tuple[float, float] | None) -> "HammersteinStage":
        """The stage as it is at a place, x and y, m; None: until one is chosen."""
        if self.placed is None:
            return self
        mixed = self.placed.at(place_m or self.placed.start_m)
        here = {name: mixed[name].reshape(its.shape) for name, its in self.curves.items()}
        return replace(
            self,
            spring=here["spring"],
            branches=here["branches"],
            stops=here.get("stops", self.stops),
            damage=self.damage and replace(self.damage, curves=here["damage"]),
            flow=self.flow and replace(self.flow, force_n=here["flow_n"]),
            surface=self.surface and replace(self.surface, stiffest=here["stiffest"]),
            placed=None,
        )

    def tables(self) -> list[str]:
        stops = bool(self.config.n_stops)
        parts = [
            "/* Curves: values and slopes at the nodes, a column a branch (sp_curve.h). */",
            array_text("spring", "sp_real", self.spring.ravel()),
            array_text("branches", "sp_real", self.branches.reshape(-1, self.config.n_branches)),
            *(line for step in self.steps for line in step.tables()),
            *(line for part in self._beside for line in part.tables()),
            *(self.surface.tables() if self.surface else ()),
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

    @property
    def _play(self) -> str:
        return f"state->{self.follows}_play" if self.config.n_stops else "NULL"

    def _tick(self, stepped: Callable[[MaxwellBranches], list[str]], measured: bool) -> list[str]:
        name, capacity = self.follows, self.config.n_branches
        beside = "".join(f" + {name}_{part.what}_n" for part in self._beside)
        return [
            *self._pointers(),
            *self._where(),
            f"const sp_curve_place {name}_place = sp_curve_at({name}_u, passive.n_pieces);",
            f"sp_real {name}_branch[{capacity}];",
            f"sp_curve(branches, {capacity}, {name}_place, {name}_branch);",
            *(line for step in self.steps for line in stepped(step)),
            *(line for part in self._beside for line in part.advance_lines(name, measured)),
            f"const sp_real {name}_{'passive' if self.pulls else 'held'}_n =",
            f"    sp_hammerstein_force(&passive, &passive_tables, {name}_u, {name}_place,",
            f"                         state->{name}_held, {self._play}){beside};",
            *self._given(),
        ]

    def _pointers(self) -> list[str]:
        """Lines that declare what is constant where there are no places."""
        if self.placed is None:
            return []
        stops = "stops, stop_radius" if self.config.n_stops else "NULL, NULL"
        return [
            *self.placed.pointers(self.follows),
            f"const sp_hammerstein_tables passive_tables = {{spring, branches, {stops}}};",
        ]

    def _where(self) -> list[str]:
        """Lines that declare `{name}_u`, the share of the depth at which the model is."""
        name = self.follows
        share = f"sp_hammerstein_share(&passive, {name})"
        if self.surface is None:
            return [f"const sp_real {name}_u = {share};"]
        return [
            f"const sp_real {name}_tool = {share};",
            f"const sp_real {name}_u =",
            f"    sp_surface_at(stiffest, passive.n_pieces, &state->{name}_surface, {name}_tool);",
        ]

    def _given(self) -> list[str]:
        """Lines that keep where the surface is, and give no force that pulls."""
        name, keep, given = self.follows, [], f"{self.follows}_held_n > (sp_real)0"
        if self.surface is not None:
            keep = [
                f"state->{name}_surface.u = {name}_u;",
                f"state->{name}_surface.force_n = {name}_held_n;",
            ]
            given += f" && !({name}_u > {name}_tool)"
        if self.pulls:
            return keep
        return [
            *keep,
            f"const sp_real {name}_passive_n =",
            f"    {given} ? {name}_held_n : (sp_real)0;",
        ]

    @property
    def measured(self) -> Measured:
        return Measured(
            headers=(
                "sp_measured.h",
                *(h for step in self.steps for h in step.names.measured_headers),
                *(h for part in self._beside for h in part.measured_headers),
            ),
            tables=(
                *(table for step in self.steps for table in step.measured_tables()),
                *(table for part in self._beside for table in part.measured_tables()),
            ),
            advance=tuple(self._tick(lambda step: step.measured_step(self.follows), True)),
        )

    def restart(self) -> list[str]:
        name = self.follows
        slow = [
            line
            for step in self.steps
            if step.double
            for line in (
                f"for (uint32_t i = 0; i < {step.count}; i++) {{",
                f"    state->{name}_{step.names.prefix}[i] = 0.0;",
                "}",
            )
        ]
        surface = [
            f"state->{name}_surface.u = {name}_u;",
            f"state->{name}_surface.force_n = (sp_real)0;",
        ]
        taken = [] if self.placed is None else [*self.placed.take(name), *self._pointers()]
        resting = ("spring", "branches", "stops")
        unused = tuple(f"const sp_real *{each} " for each in self.curves if each not in resting)
        return [
            *slow,
            *(line for line in taken if not line.startswith(unused)),
            f"const sp_real {name}_u = sp_hammerstein_share(&passive, {name});",
            f"sp_hammerstein_rest(&passive, &passive_tables, {name}_u,",
            f"                    state->{name}_before, state->{name}_held, {self._play});",
            *(line for part in self._beside for line in part.restart(name)),
            *(surface if self.surface else ()),
        ]

    def advance(self) -> list[str]:
        return self._tick(lambda step: step.step(self.follows), False)

    def instructions(self, costs: Costs) -> float:
        config = self.config
        curves = config.n_branches * costs.curve
        stepped = sum(step.instructions(costs) for step in self.steps)
        beside = sum(part.instructions(costs) for part in self._beside)
        stops = config.n_stops * costs.stop
        return float(
            costs.passive + curves + stepped + beside + stops + self._surface_instructions(costs)
        )

    def restart_instructions(self, costs: Costs) -> float:
        """It reads the branches' curves too, where they rest; the surface is at the tool."""
        curves = self.config.n_branches * (costs.curve + costs.rest)
        mixed = 2.0 * costs.filled * self.placed.mixing if self.placed else 0.0
        resting = super().restart_instructions(costs) + curves + mixed
        return resting - self._surface_instructions(costs)

    def _surface_instructions(self, costs: Costs) -> float:
        return costs.surface + self.config.n_pieces * costs.surface_piece if self.surface else 0.0

    def reference(self, depth: Reals, starts: Starts, taken: Taken = ()) -> Reals:
        """Force of every tick, (n,), N.

        taken: ticks in which a place is, m, the first of them in the first; without any, the most
        of all places.
        """
        config = self.config
        u = (depth - config.origin_m) * config.per_span
        force_n = np.empty_like(u)
        places = dict(taken)
        later = [tick for tick in places if 0 < tick < len(depth)]
        changes = np.union1d(starts, later).astype(np.intp)
        stage = self
        for begin, end, rests in segments(len(depth), changes):
            # A restart leaves the model at rest at u; the C's state begins as zeros.
            at_rest = u[begin] if rests else u.dtype.type(0)
            stage = self.at(places[begin]) if begin in places else stage
            force_n[begin:end] = PassiveMotion(stage, at_rest).along(u[begin:end])[0]
        return force_n if self.pulls else np.where(force_n > 0, force_n, u.dtype.type(0))
