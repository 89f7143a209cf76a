"""The passive model: sp_hammerstein.h."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.ir import Basis, Hammerstein
from springpot.codegen.literals import array_text, struct_text
from springpot.codegen.stages.recursive import SMALLEST, loss_and_gain
from springpot.codegen.stages.stage import (
    REAL,
    Member,
    Real,
    Reals,
    Starts,
    padded,
    segments,
)

BASIS_SIZE: dict[Basis, int] = {"powers": 3, "ramps": 8}


@dataclass(frozen=True)
class HammersteinConfig:
    """sp_hammerstein_config."""

    origin_m: Real
    per_span: Real
    bias_n: Real
    n_basis: int
    n_branches: int
    n_lanes: int
    n_stops: int


@dataclass(frozen=True, eq=False)
class HammersteinStage:
    """Arrays of sp_hammerstein_tables, and the variable of the tick that it follows.

    weights: (basis, lanes), lane 0 the spring. loss: (lanes,). stop_weights: (stops, basis).
    follows: "depth" (clipped to the trained range) or "deep" (not clipped). Its force is the C
    variable `{follows}_passive_n`.
    """

    config: HammersteinConfig
    basis: Basis
    weights: Reals
    loss: Reals
    stop_weights: Reals
    radius: Reals
    follows: str

    headers = (
        "sp_number.h", "sp_basis.h", "sp_poles.h", "sp_stops.h", "sp_weigh.h", "sp_hammerstein.h",
    )  # fmt: skip

    @property
    def members(self) -> tuple[Member, ...]:
        """Input and state of each branch, play of each stop."""
        lanes, stops = self.config.n_lanes, self.config.n_stops
        name = self.follows
        play = (Member(f"sp_real {name}_play[{stops}]", (REAL,) * stops),) if stops else ()
        return (
            Member(f"sp_real {name}_before[{lanes}]", (REAL,) * lanes),
            Member(f"sp_real {name}_held[{lanes}]", (REAL,) * lanes),
            *play,
        )

    def tables(self) -> list[str]:
        """Weights, losses, radii."""
        stops = bool(self.config.n_stops)
        parts = [
            "/* Spring and branches: a row a basis function, a lane each. */",
            array_text("branch_weights", "sp_real", self.weights),
            array_text("branch_loss", "sp_real", self.loss),
        ]
        if stops:
            parts += [
                array_text("stop_weights", "sp_real", self.stop_weights),
                array_text("stop_radius", "sp_real", self.radius),
            ]
        return [
            *parts,
            struct_text("passive", "sp_hammerstein_config", self.config),
            "static const sp_hammerstein_tables passive_tables = {",
            "    .weights = branch_weights,",
            "    .loss = branch_loss,",
            *(["    .stop_weights = stop_weights,", "    .radius = stop_radius,"] if stops else []),
            "};",
        ]

    @property
    def _play(self) -> str:
        return f"state->{self.follows}_play" if self.config.n_stops else "NULL"

    def restart(self) -> list[str]:
        """Relaxed branches."""
        return [
            f"sp_hammerstein_rest(&passive, &passive_tables, {self.follows},",
            f"                    state->{self.follows}_before, state->{self.follows}_held, "
            f"{self._play});",
        ]

    def advance(self) -> list[str]:
        """Its force."""
        return [
            f"sp_real {self.follows}_branch[{self.config.n_lanes}];",
            f"const sp_real {self.follows}_passive_n = sp_hammerstein_step(",
            f"    &passive, &passive_tables, {self.follows}, state->{self.follows}_before,",
            f"    state->{self.follows}_held, {self._play}, {self.follows}_branch);",
        ]

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        """Force of every tick, N, by the same operations."""
        config = self.config
        real = depth.dtype.type
        u = (depth - config.origin_m) * config.per_span
        b = basis(self.basis, u)
        g = np.zeros((len(depth), config.n_lanes), dtype=depth.dtype)
        for j in range(config.n_basis):
            g += self.weights[j] * b[:, j : j + 1]
        force_n = config.bias_n + g[:, 0]
        smallest = real(SMALLEST)
        held = np.empty_like(g)
        play = np.empty((len(depth), config.n_stops), dtype=depth.dtype)
        for begin, end, rests in segments(len(depth), starts):
            h = np.zeros(config.n_lanes, dtype=depth.dtype)
            first = g[begin] if rests else np.zeros(config.n_lanes, dtype=depth.dtype)
            p = np.full(config.n_stops, u[begin] if rests else real(0), dtype=depth.dtype)
            rises = np.diff(g[begin:end], prepend=first[None, :], axis=0)
            low = u[begin:end, None] - self.radius
            high = u[begin:end, None] + self.radius
            for i in range(end - begin):
                h = h + (rises[i] - self.loss * h)
                h[np.abs(h) < smallest] = real(0)
                held[begin + i] = h
                if config.n_stops:
                    p = np.where(p > low[i], p, low[i])
                    p = np.where(p < high[i], p, high[i])
                    play[begin + i] = p
        for i in range(1, config.n_branches + 1):
            force_n = force_n + held[:, i]
        for k in range(config.n_stops):
            bp = basis(self.basis, play[:, k])
            total = np.zeros_like(force_n)
            for j in range(config.n_basis):
                total = total + self.stop_weights[k, j] * (b[:, j] - bp[:, j])
            force_n = force_n + total
        return force_n


def basis(kind: Basis, u: Reals) -> Reals:
    """sp_basis.h: shape (n, J)."""
    real = u.dtype.type
    if kind == "powers":
        v = np.where(u > 0, u, real(0))
        return np.stack([v, v * v, v * v * v], axis=1)
    width = real(1) / real(8)
    ramps = []
    for j in range(8):
        above = u - real(j) * width
        risen = np.where(above > 0, above, real(0))
        ramps.append(np.where(risen > width, width, risen) if j < 7 else risen)
    return np.stack(ramps, axis=1)


def hammerstein_stage(
    model: Hammerstein, dt_s: float, dtype: type, follows: str
) -> HammersteinStage:
    """Fold the poles' gains into the weights; lane 0 is the spring."""
    n_basis = BASIS_SIZE[model.basis]
    n_branches, n_stops = len(model.tau_s), len(model.radius_m)
    lanes = padded(n_branches + 1)
    pole_loss, gain = loss_and_gain(model.tau_s, dt_s)
    weights: Reals = np.zeros((n_basis, lanes), dtype=dtype)
    weights[:, 0] = model.elastic_n
    weights[:, 1 : n_branches + 1] = (gain[:, None] * model.branch_n).T
    loss: Reals = np.ones(lanes, dtype=dtype)
    loss[1 : n_branches + 1] = pole_loss
    return HammersteinStage(
        config=HammersteinConfig(
            origin_m=dtype(model.origin_m),
            per_span=dtype(1.0 / model.span_m),
            bias_n=dtype(model.bias_n),
            n_basis=n_basis,
            n_branches=n_branches,
            n_lanes=lanes,
            n_stops=n_stops,
        ),
        basis=model.basis,
        weights=weights,
        loss=loss,
        stop_weights=model.stop_n.reshape(n_stops, n_basis).astype(dtype),
        radius=(model.radius_m / model.span_m).astype(dtype),
        follows=follows,
    )
