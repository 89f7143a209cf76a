"""The passive model: sp_hammerstein.h."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Real, Reals
from springpot.codegen.literals import array_text, members_text, struct_text
from springpot.codegen.model.formulas import (
    curve_place,
    curve_terms,
    curve_values,
    depth_place,
    stretch_terms,
)
from springpot.codegen.model.model import BASIS_SIZE, Hammerstein
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.maxwell import MaxwellBranches, branch_steps
from springpot.codegen.stages.stage import (
    DOUBLE,
    REAL,
    VECTOR_WIDTH,
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
    degree: int
    n_branches: int
    n_stops: int


@dataclass(frozen=True, eq=False)
class HammersteinStage(Stage):
    """Arrays of sp_hammerstein_tables, and the variable of the tick that it follows.

    Curves: shape (pieces, degree + 1, curves), highest power first. spring: one, branches: one
    each, stops: (stops, pieces, degree + 1), radius: (stops,). stretch: (pieces, 4), or None.
    steps: who steps which branches; those of curve 0 fill whole vectors.
    follows: "clipped" (to the trained range) or "penetration" (not clipped). Its force is the C
    variable `{follows}_passive_n`.
    """

    config: HammersteinConfig
    spring: Reals
    branches: Reals
    steps: tuple[MaxwellBranches, ...]
    stops: Reals
    radius: Reals
    stretch: Reals | None
    follows: str

    @property
    def _by_depth(self) -> bool:
        return self.stretch is not None or any(step.by_depth for step in self.steps)

    @property
    def headers(self) -> tuple[str, ...]:
        depth = ("sp_depth.h",) if self._by_depth else ()
        stepped = [header for step in self.steps for header in step.names.headers]
        return ("sp_number.h", "sp_curve.h", "sp_stops.h", "sp_hammerstein.h", *depth, *stepped)

    @property
    def members(self) -> tuple[Member, ...]:
        """Input and state of each branch, the slow ones' own, play of each stop."""
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
        )

    def tables(self) -> list[str]:
        stops = bool(self.config.n_stops)
        parts = [
            "/* Curves: piece by piece, highest power first, a column a branch (sp_curve.h). */",
            array_text("spring", "sp_real", self.spring.ravel()),
            array_text("branches", "sp_real", self.branches.reshape(-1, self.config.n_branches)),
            *(line for step in self.steps for line in step.tables()),
        ]
        if self.stretch is not None:
            parts.append(array_text("stretch", "sp_real", self.stretch.ravel()))
        if stops:
            parts += [
                array_text("stops", "sp_real", self.stops.reshape(self.config.n_stops, -1)),
                array_text("stop_radius", "sp_real", self.radius),
            ]
        return [
            *parts,
            struct_text("passive", "sp_hammerstein_config", self.config),
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

    def _place(self) -> list[str]:
        """Lines that declare the share of the depth, stretched if it is, and where it lies."""
        name = self.follows
        share = f"{name}_u" if self.stretch is None else f"{name}_share"
        lines = [f"const sp_real {share} = sp_hammerstein_share(&passive, {name});"]
        if self._by_depth:
            lines.append(f"const sp_curve_place {name}_depth = sp_depth_place({share});")
        if self.stretch is not None:
            lines.append(f"const sp_real {name}_u = sp_depth_stretched(stretch, {name}_depth);")
        return lines

    def _tick(self, stepped: Callable[[MaxwellBranches], list[str]]) -> list[str]:
        name, capacity = self.follows, self.config.n_branches
        return [
            *self._place(),
            f"const sp_curve_place {name}_place = sp_curve_at({name}_u, passive.n_pieces);",
            f"sp_real {name}_branch[{capacity}];",
            f"sp_curve(branches, passive.degree, {capacity}, {name}_place, {name}_branch);",
            *(line for step in self.steps for line in stepped(step)),
            f"const sp_real {name}_passive_n = sp_hammerstein_force(",
            f"    &passive, &passive_tables, {name}_u, {name}_place, state->{name}_held, "
            f"{self._play});",
        ]

    @property
    def measured(self) -> Measured:
        return Measured(
            headers=(
                "sp_measured.h",
                *(h for step in self.steps for h in step.names.measured_headers),
            ),
            tables=tuple(table for step in self.steps for table in step.measured_tables()),
            advance=tuple(self._tick(lambda step: step.measured_step(self.follows))),
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
        if self.stretch is None:
            place = [f"const sp_real {name}_u = sp_hammerstein_share(&passive, {name});"]
        else:
            place = self._place()
        return [
            *slow,
            *place,
            f"sp_hammerstein_rest(&passive, &passive_tables, {name}_u,",
            f"                    state->{name}_before, state->{name}_held, {self._play});",
        ]

    def advance(self) -> list[str]:
        return self._tick(lambda step: step.step(self.follows))

    def instructions(self, costs: Costs) -> float:
        config = self.config
        curves = config.n_branches * config.degree * costs.power
        stepped = sum(step.instructions(costs) for step in self.steps)
        depth = costs.depth if self._by_depth else 0.0
        return float(costs.passive + depth + curves + stepped + config.n_stops * costs.stop)

    def restart_instructions(self, costs: Costs) -> float:
        """It reads the branches' curves too: where they rest."""
        config = self.config
        curves = config.n_branches * (config.degree * costs.power + costs.rest)
        depth = costs.depth if self.stretch is not None else 0.0
        return super().restart_instructions(costs) + depth + curves

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        """Force of every tick, (n,), N."""
        config = self.config
        u = (depth - config.origin_m) * config.per_span
        at = depth_place(u)
        if self.stretch is not None:
            u = curve_values(self.stretch[:, :, None], at)[:, 0]
        place = curve_place(u, config.n_pieces)
        g = curve_values(self.branches, place)
        held = np.empty_like(g)
        play = np.empty((len(depth), config.n_stops), dtype=depth.dtype)
        for begin, end, rests in segments(len(depth), starts):
            # A restart leaves the branches relaxed at u; the C's state begins as zeros.
            first = g[begin] if rests else np.zeros(config.n_branches, dtype=depth.dtype)
            rises = np.diff(g[begin:end], prepend=first[None, :], axis=0)
            there = (at[0][begin:end], at[1][begin:end])
            for step in self.steps:
                its = slice(step.first, step.first + step.count)
                held[begin:end, its] = step.reference(rises[:, its], there)
            if config.n_stops:
                play[begin:end] = self._played(u[begin:end], rests)
        still_n = curve_values(self.spring[:, :, None], place)[:, 0] + config.bias_n
        for k in range(config.n_stops):
            # A stop is P(u) - P(play); its P(u) is part of the spring's curve already.
            at_play = curve_place(play[:, k], config.n_pieces)
            still_n = still_n - curve_values(self.stops[k][:, :, None], at_play)[:, 0]
        # Four partial sums, as the C's vectors add them: another order rounds otherwise.
        s = np.zeros((VECTOR_WIDTH, len(depth)), dtype=depth.dtype)
        for i in range(config.n_branches):
            s[i % VECTOR_WIDTH] += held[:, i]
        force_n: Reals = still_n + ((s[0] + s[2]) + (s[1] + s[3]))
        return force_n

    def _played(self, u: Reals, rests: bool) -> Reals:
        """Play of each stop along one stretch, (n, stops)."""
        play = np.empty((len(u), len(self.radius)), dtype=u.dtype)
        p = np.full(len(self.radius), u[0] if rests else u.dtype.type(0), dtype=u.dtype)
        low, high = u[:, None] - self.radius, u[:, None] + self.radius
        for i in range(len(u)):
            p = np.where(p > low[i], p, low[i])  # as the C compares: np.clip differs for a NaN
            p = np.where(p < high[i], p, high[i])
            play[i] = p
        return play


def hammerstein_stage(
    model: Hammerstein, dt_s: float, dtype: type, follows: str, vector_width: int
) -> HammersteinStage:
    """Fold the poles' gains into the branches; the stops' first halves belong to the spring.

    MaxwellBranches are padded to whole vectors of `vector_width`, with curves of 0.
    """
    n_stops, n_basis = len(model.radius_m), BASIS_SIZE[model.basis]
    stop_n = model.stop_n.reshape(n_stops, n_basis)
    steps, weights = branch_steps(model, dt_s, dtype, vector_width)
    curves = curve_terms(model.basis, weights)
    spring = curve_terms(model.basis, (model.elastic_n + stop_n.sum(axis=0))[None])
    stretch: Reals | None = None
    if model.stretch > 0.0:
        stretch = stretch_terms(model.stretch).astype(dtype)
    return HammersteinStage(
        config=HammersteinConfig(
            origin_m=dtype(model.origin_m),
            per_span=dtype(1.0 / model.span_m),
            bias_n=dtype(model.bias_n),
            n_pieces=len(curves),
            degree=curves.shape[1] - 1,
            n_branches=len(weights),
            n_stops=n_stops,
        ),
        spring=spring[:, :, 0].astype(dtype),
        branches=curves.astype(dtype),
        steps=steps,
        stops=np.moveaxis(curve_terms(model.basis, stop_n), 2, 0).astype(dtype),
        radius=(model.radius_m / model.span_m).astype(dtype),
        stretch=stretch,
        follows=follows,
    )
