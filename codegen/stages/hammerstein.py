"""The passive model: sp_hammerstein.h."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Real, Reals
from springpot.codegen.literals import array_text, struct_text
from springpot.codegen.model.model import BASIS_SIZE, Basis, Hammerstein
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.recursive import SLOW_TICKS, loss_and_gain
from springpot.codegen.stages.stage import (
    DOUBLE,
    REAL,
    SMALLEST,
    VECTOR_WIDTH,
    Measured,
    Member,
    Stage,
    Starts,
    padded,
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
    each, stops: (stops, pieces, degree + 1), radius: (stops,). loss, per_tau (1/s), per_gain
    (inverse of what is folded into the branches): (branches,). slow_loss: of the last ones, which
    are stepped in double; their entries of loss are not used.
    follows: "clipped" (to the trained range) or "penetration" (not clipped). Its force is the C
    variable `{follows}_passive_n`.
    """

    config: HammersteinConfig
    spring: Reals
    branches: Reals
    per_tau: Reals
    per_gain: Reals
    loss: Reals
    stops: Reals
    radius: Reals
    slow_loss: NDArray[np.float64]
    follows: str

    @property
    def headers(self) -> tuple[str, ...]:
        slow = ("sp_hammerstein_slow.h",) if len(self.slow_loss) else ()
        return ("sp_number.h", "sp_curve.h", "sp_poles.h", "sp_stops.h", "sp_hammerstein.h", *slow)

    @property
    def members(self) -> tuple[Member, ...]:
        """Input and state of each branch, the slow ones' own, play of each stop."""
        vector_width, stops = self.config.n_branches, self.config.n_stops
        name = self.follows
        n_slow = len(self.slow_loss)
        slow = (Member(f"double {name}_slow[{n_slow}]", (DOUBLE,) * n_slow),) if n_slow else ()
        play = (Member(f"sp_real {name}_play[{stops}]", (REAL,) * stops),) if stops else ()
        return (
            *slow,
            Member(f"sp_real {name}_before[{vector_width}]", (REAL,) * vector_width),
            Member(f"sp_real {name}_held[{vector_width}]", (REAL,) * vector_width),
            *play,
        )

    def tables(self) -> list[str]:
        stops = bool(self.config.n_stops)
        parts = [
            "/* Curves: piece by piece, highest power first, a column a branch (sp_curve.h). */",
            array_text("spring", "sp_real", self.spring.ravel()),
            array_text("branches", "sp_real", self.branches.reshape(-1, self.config.n_branches)),
            array_text("branch_loss", "sp_real", self.loss),
        ]
        if len(self.slow_loss):
            parts.append(array_text("slow_branch_loss", "double", self.slow_loss))
        if stops:
            parts += [
                array_text("stops", "sp_real", self.stops.reshape(self.config.n_stops, -1)),
                array_text("stop_radius", "sp_real", self.radius),
            ]
        return [
            *parts,
            struct_text("passive", "sp_hammerstein_config", self.config),
            "static const sp_hammerstein_tables passive_tables = {",
            "    .spring = spring,",
            "    .branches = branches,",
            "    .loss = branch_loss,",
            *(["    .stops = stops,", "    .radius = stop_radius,"] if stops else []),
            "};",
        ]

    @property
    def _play(self) -> str:
        return f"state->{self.follows}_play" if self.config.n_stops else "NULL"

    def _branches(self) -> list[str]:
        """Lines that declare the room for the branches, and the slow ones."""
        lines = [f"sp_real {self.follows}_branch[{self.config.n_branches}];"]
        if len(self.slow_loss):
            lines += [
                f"const sp_hammerstein_slow {self.follows}_slow = {{",
                f"    .n = {len(self.slow_loss)}, .loss = slow_branch_loss,",
                f"    .held = state->{self.follows}_slow}};",
            ]
        return lines

    @property
    def measured(self) -> Measured:
        slow = "_slow" if len(self.slow_loss) else ""
        return Measured(
            headers=("sp_measured.h", f"sp_hammerstein{slow}_dt.h"),
            tables=(
                array_text("branch_per_tau", "sp_real", self.per_tau),
                array_text("branch_per_gain", "sp_real", self.per_gain),
            ),
            advance=(
                *self._branches(),
                f"const sp_real {self.follows}_passive_n = sp_hammerstein_step{slow}_dt(",
                f"    &passive, &passive_tables, {self._slow}branch_per_tau, "
                "branch_per_gain, dt_s,",
                f"    {self.follows}, state->{self.follows}_before, state->{self.follows}_held,",
                f"    {self._play}, {self.follows}_branch);",
            ),
        )

    @property
    def _slow(self) -> str:
        return f"&{self.follows}_slow, " if len(self.slow_loss) else ""

    def restart(self) -> list[str]:
        slow = [
            f"for (uint32_t i = 0; i < {len(self.slow_loss)}; i++) {{",
            f"    state->{self.follows}_slow[i] = 0.0;",
            "}",
        ]
        return [
            *(slow if len(self.slow_loss) else ()),
            f"sp_hammerstein_rest(&passive, &passive_tables, {self.follows},",
            f"                    state->{self.follows}_before, state->{self.follows}_held, "
            f"{self._play});",
        ]

    def advance(self) -> list[str]:
        slow = "_slow" if self._slow else ""
        return [
            *self._branches(),
            f"const sp_real {self.follows}_passive_n = sp_hammerstein_step{slow}(",
            f"    &passive, &passive_tables, {self._slow}{self.follows}, "
            f"state->{self.follows}_before,",
            f"    state->{self.follows}_held, {self._play}, {self.follows}_branch);",
        ]

    def instructions(self, costs: Costs) -> float:
        config = self.config
        branch = costs.branch + config.degree * costs.power
        slow = len(self.slow_loss) * costs.slow_pole
        return float(
            costs.passive + config.n_branches * branch + slow + config.n_stops * costs.stop
        )

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        """Force of every tick, (n,), N."""
        config = self.config
        real = depth.dtype.type
        u = (depth - config.origin_m) * config.per_span
        place = self._place(u)
        g = _curves(self.branches, *place)
        still_n = _curves(self.spring[:, :, None], *place)[:, 0] + config.bias_n
        smallest = real(SMALLEST)
        held = np.empty_like(g)
        play = np.empty((len(depth), config.n_stops), dtype=depth.dtype)
        for begin, end, rests in segments(len(depth), starts):
            # A restart leaves the branches relaxed at u; the C's state begins as zeros.
            n_fast = config.n_branches - len(self.slow_loss)
            h = np.zeros(n_fast, dtype=depth.dtype)
            slow_h = np.zeros(len(self.slow_loss))
            first = g[begin] if rests else np.zeros(config.n_branches, dtype=depth.dtype)
            p = np.full(config.n_stops, u[begin] if rests else real(0), dtype=depth.dtype)
            rises = np.diff(g[begin:end], prepend=first[None, :], axis=0)
            low = u[begin:end, None] - self.radius
            high = u[begin:end, None] + self.radius
            for i in range(end - begin):
                h = h + (rises[i, :n_fast] - self.loss[:n_fast] * h)
                h[np.abs(h) < smallest] = real(0)
                slow_h = slow_h + (rises[i, n_fast:].astype(np.float64) - self.slow_loss * slow_h)
                slow_h[np.abs(slow_h) < SMALLEST] = 0.0
                held[begin + i, :n_fast] = h
                held[begin + i, n_fast:] = slow_h.astype(depth.dtype)
                if config.n_stops:
                    # The C's comparisons: np.clip would treat a NaN otherwise.
                    p = np.where(p > low[i], p, low[i])
                    p = np.where(p < high[i], p, high[i])
                    play[begin + i] = p
        for k in range(config.n_stops):
            # A stop is P(u) - P(play); its P(u) is part of the spring's curve already.
            at_play = self._place(play[:, k])
            still_n = still_n - _curves(self.stops[k][:, :, None], *at_play)[:, 0]
        # Four partial sums, as the C's vectors add them: another order rounds otherwise.
        s = np.zeros((VECTOR_WIDTH, len(depth)), dtype=depth.dtype)
        for i in range(config.n_branches):
            s[i % VECTOR_WIDTH] += held[:, i]
        force_n: Reals = still_n + ((s[0] + s[2]) + (s[1] + s[3]))
        return force_n

    def _place(self, u: Reals) -> tuple[NDArray[np.intp], Reals]:
        """sp_curve_at: the piece that u is in and the way from its start, both (n,)."""
        real, n = u.dtype.type, self.config.n_pieces
        v = np.where(u > 0, u, real(0))
        found = np.where(v * real(n) < real(n - 1), v * real(n), real(n - 1))
        piece = found.astype(np.intp)
        return piece, v - piece.astype(u.dtype) / real(n)


def _curves(terms: Reals, piece: NDArray[np.intp], way: Reals) -> Reals:
    """sp_curve: values (n, curves)."""
    values: Reals = terms[piece, 0]
    for power in range(1, terms.shape[1]):
        values = values * way[:, None] + terms[piece, power]
    return values


def basis(kind: Basis, u: Reals) -> Iterator[Reals]:
    """The functions of a basis one after another, each (n,); `curve_terms` has them by pieces."""
    real = u.dtype.type
    if kind == "powers":
        v = np.maximum(u, real(0))
        yield v
        yield v * v
        yield v * v * v
        return
    width = real(1) / real(8)
    for j in range(8):
        risen = np.maximum(u - real(j) * width, real(0))
        yield np.minimum(risen, width) if j < 7 else risen


def hammerstein_stage(
    model: Hammerstein, dt_s: float, dtype: type, follows: str, vector_width: int
) -> HammersteinStage:
    """Fold the poles' gains into the branches; the stops' first halves belong to the spring.

    Branches are padded to whole vectors of `vector_width`, with curves of 0; slow ones come last.
    """
    n_branches, n_stops = len(model.tau_s), len(model.radius_m)
    capacity = padded(max(n_branches, 1), vector_width)
    pole_loss, gain = loss_and_gain(model.tau_s, dt_s)
    stop_n = model.stop_n.reshape(n_stops, BASIS_SIZE[model.basis])
    slow = (model.tau_s > SLOW_TICKS * dt_s) & (dtype is np.float32)
    n_slow = int(np.sum(slow))
    at = np.concatenate([np.arange(n_branches - n_slow), np.arange(capacity - n_slow, capacity)])
    order = np.argsort(slow, kind="stable")
    branches = np.zeros((capacity, BASIS_SIZE[model.basis]))
    branches[at] = (gain[:, None] * model.branch_n)[order]
    loss: Reals = np.ones(capacity, dtype=dtype)
    per_tau, per_gain = loss.copy(), loss.copy()
    loss[at] = pole_loss[order]
    per_tau[at], per_gain[at] = 1.0 / model.tau_s[order], 1.0 / gain[order]
    curves = curve_terms(model.basis, branches)
    return HammersteinStage(
        config=HammersteinConfig(
            origin_m=dtype(model.origin_m),
            per_span=dtype(1.0 / model.span_m),
            bias_n=dtype(model.bias_n),
            n_pieces=len(curves),
            degree=curves.shape[1] - 1,
            n_branches=capacity,
            n_stops=n_stops,
        ),
        spring=curve_terms(model.basis, (model.elastic_n + stop_n.sum(axis=0))[None])[
            :, :, 0
        ].astype(dtype),
        branches=curves.astype(dtype),
        per_tau=per_tau,
        per_gain=per_gain,
        loss=loss,
        stops=np.moveaxis(curve_terms(model.basis, stop_n), 2, 0).astype(dtype),
        slow_loss=pole_loss[slow],
        radius=(model.radius_m / model.span_m).astype(dtype),
        follows=follows,
    )


def curve_terms(kind: Basis, weights: Reals) -> NDArray[np.float64]:
    """Weights (curves, J) on a basis as polynomials: (pieces, degree + 1, curves)."""
    if kind == "powers":
        constant = np.zeros((1, len(weights)))
        return np.concatenate([weights.T[::-1], constant])[None]
    # In piece j ramp j rises; those before it are full, at weight / n_pieces; those after it are 0.
    n_pieces = BASIS_SIZE[kind]
    starts = np.concatenate([np.zeros((1, len(weights))), np.cumsum(weights.T, axis=0)[:-1]])
    return np.stack([weights.T, starts / n_pieces], axis=1)
