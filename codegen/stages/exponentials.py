"""Fractional derivatives as weighted sums of terms that all orders share: sp_weighted_sum.h.

The terms are exponentials (sp_poles.h), or a window's newest rises and truncated exponentials
(sp_fast_window.h).
"""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Indices, Reals, Samples
from springpot.codegen.literals import array_text
from springpot.codegen.model.features import FastFirBank, RecursiveBank
from springpot.codegen.model.formulas import SMALLEST, compute_loss_and_gain, relax_pole, to_scalars
from springpot.codegen.stages.stage import (
    DOUBLE,
    REAL,
    Columns,
    FeatureStage,
    Member,
    Probe,
    Starts,
    feature_stage,
    pad_history,
    round_up,
    stage_code,
    window_members,
)
from springpot.codegen.types import RealType

SLOW_TICKS = 1e5  # above this many ticks of time constant, a float state stops moving


@dataclass(frozen=True, eq=False)
class WeightedSumStage(FeatureStage):
    """orders: of the columns in use. weights: shape (terms, capacity)."""

    orders: tuple[float, ...]
    weights: Reals

    @property
    def n_features(self) -> int:
        return len(self.orders)

    @property
    def capacity(self) -> int:
        return int(self.weights.shape[1])

    @property
    def named(self) -> str:
        """The orders, for a comment."""
        return ", ".join(f"{order:g}" for order in self.orders)

    def probe(self) -> Probe:
        rows, vector_width = self.weights.shape
        return Probe(rows, vector_width, self.weigh)

    def weigh(self, terms: Reals) -> Reals:
        """Terms (..., terms) by the weights, each column's sum in order: (..., capacity)."""
        total: Reals = np.zeros((*terms.shape[:-1], self.capacity), dtype=self.weights.dtype)
        for k, row in enumerate(self.weights):
            total += terms[..., k, None] * row
        return total


def pad_columns(weights: Reals, used: Indices, dtype: type) -> Reals:
    """Return the columns `used`, padded with zeros to whole vectors: (terms, capacity)."""
    padded_weights: Reals = np.zeros((len(weights), round_up(max(len(used), 1))), dtype=dtype)
    padded_weights[:, : len(used)] = weights[:, used]
    return padded_weights


def step_poles(loss: Reals, rises: Reals, h: Reals) -> Reals:
    """sp_poles.h: states after each tick, (n, poles), from h, (poles,); rises (n,), (n, poles)."""
    states = np.empty((len(rises), len(h)), dtype=loss.dtype)
    for k, (pole_loss, begin) in enumerate(zip(to_scalars(loss), to_scalars(h), strict=True)):
        states[:, k] = relax_pole(pole_loss, rises if rises.ndim == 1 else rises[:, k], begin)
    return states


@dataclass(frozen=True, eq=False)
class RecursiveStage(WeightedSumStage):
    """Poles fast first; weights: shape (poles, capacity), gains folded in.

    loss: (fast poles,). slow_loss: (slow poles,), stepped in double.
    """

    loss: Reals
    slow_loss: Samples

    code = stage_code("recursive")

    @property
    def headers(self) -> tuple[str, ...]:
        slow = ("sp_slow_poles.h",) if len(self.slow_loss) else ()
        return ("sp_number.h", "sp_poles.h", *slow, "sp_weighted_sum.h")

    @property
    def members(self) -> tuple[Member, ...]:
        """Return the members of sp_state: the poles' states, and the depth before."""
        n_poles, n_slow = len(self.weights), len(self.slow_loss)
        slow = (Member(f"double slow[{n_slow}]", (DOUBLE,) * n_slow),) if n_slow else ()
        return (
            *slow,
            Member(f"sp_real poles[{n_poles}]", (REAL,) * n_poles),
            Member("sp_real last_clipped", (REAL,)),
        )

    def tables(self) -> list[str]:
        """Render the C tables: losses of the poles, weights of each derivative."""
        n_poles, vector_width = self.weights.shape
        n_fast = len(self.loss)
        slow = [array_text("slow_loss", "double", self.slow_loss)] if len(self.slow_loss) else []
        fast = [array_text("loss", "sp_real", self.loss)] if n_fast else []
        return [
            f"enum {{\n    N_POLES = {n_poles},\n    N_FAST = {n_fast},\n"
            f"    N_VECTOR = {vector_width}\n}};",
            *fast,
            *slow,
            f"/* Poles to orders: a row a pole, a lane each for the orders {self.named}. */",
            array_text("weights", "sp_real", self.weights),
        ]

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        """Return the derivatives along a depth, (n, features), as the C computes them."""
        result = np.zeros((len(depth), self.n_features), dtype=depth.dtype)
        for rows, samples in pad_history(depth, starts, 1):
            rises = np.diff(samples)
            fast = step_poles(self.loss, rises, np.zeros_like(self.loss))
            slow_rises, at_rest = rises.astype(np.float64), np.zeros_like(self.slow_loss)
            slow = step_poles(self.slow_loss, slow_rises, at_rest)
            states = np.concatenate([fast, slow.astype(depth.dtype)], axis=1)
            result[rows] = self.weigh(states)[:, : self.n_features]
        return result


@feature_stage.register
def recursive_stage(
    bank: RecursiveBank, used: Columns, dt_s: float, dtype: RealType
) -> RecursiveStage:
    """Make the C stage of fractional derivatives by recursive poles, of the orders `used` alone.

    The poles are ordered fast first: slow ones are stepped in double.
    """
    order = np.argsort(bank.tau_s)
    loss, gain = compute_loss_and_gain(bank.tau_s[order], dt_s)
    slow = bank.tau_s[order] > SLOW_TICKS * dt_s
    slow &= dtype is np.float32
    return RecursiveStage(
        orders=tuple(bank.orders[i] for i in used),
        loss=loss[~slow].astype(dtype),
        slow_loss=loss[slow],
        weights=pad_columns(gain[:, None] * bank.weights[order], used, dtype),
    )


@dataclass(frozen=True, eq=False)
class FastFirStage(WeightedSumStage):
    """keep, leave: (poles,), what a pole keeps in a tick, and of a rise until the window's end.

    weights: (direct + poles + 1, capacity). length: of the window, samples.
    """

    keep: Reals
    leave: Reals
    length: int

    code = stage_code("fast_fir")
    headers = ("sp_window.h", "sp_number.h", "sp_fast_window.h", "sp_weighted_sum.h")

    @property
    def n_direct(self) -> int:
        """Newest rises, which have weights of their own."""
        return len(self.weights) - len(self.keep) - 1

    @property
    def members(self) -> tuple[Member, ...]:
        poles = Member(f"sp_real poles[{len(self.keep)}]", (REAL,) * len(self.keep))
        return (*window_members("history", "newest", self.length + 1), poles)

    def tables(self) -> list[str]:
        """Render the C tables: the poles' factors and the weights of each derivative."""
        rows, width = self.weights.shape
        return [
            f"enum {{\n    N_WINDOW = {self.length + 1},\n    N_DIRECT = {self.n_direct},\n"
            f"    N_POLES = {len(self.keep)},\n    N_TERMS = {rows},\n    N_VECTOR = {width}\n}};",
            array_text("keep", "sp_real", self.keep),
            array_text("leave", "sp_real", self.leave),
            f"/* Rises, poles, oldest sample: a row each; lanes: the orders {self.named}. */",
            array_text("weights", "sp_real", self.weights),
        ]

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        result = np.zeros((len(depth), self.n_features), dtype=depth.dtype)
        for rows, samples in pad_history(depth, starts, self.length):
            terms = self._terms(samples, rows.stop - rows.start)
            result[rows] = self.weigh(terms)[:, : self.n_features]
        return result

    def _terms(self, samples: Reals, n: int) -> Reals:
        """Return what n ticks sum, (n, direct + poles + 1): rises, poles, oldest sample."""
        rises = np.diff(samples)  # rises[i] is that of samples[i + 1]
        newest = self.length - 1
        direct = [rises[newest - k : newest - k + n] for k in range(self.n_direct)]
        entering = rises[newest - self.n_direct : newest - self.n_direct + n]
        leaving = rises[:n]
        h = np.zeros(len(self.keep), dtype=samples.dtype)
        poles = np.empty((n, len(h)), dtype=samples.dtype)
        for i in range(n):
            h = self.keep * h + (entering[i] - self.leave * leaving[i])
            h[np.abs(h) < samples.dtype.type(SMALLEST)] = 0
            poles[i] = h
        return np.column_stack([*direct, poles, samples[1 : n + 1]])


@feature_stage.register
def fast_fir_stage(bank: FastFirBank, used: Columns, dt_s: float, dtype: RealType) -> FastFirStage:
    """Make the C stage of a long window as recent samples and exponentials, for `used` orders."""
    n_direct = len(bank.weights) - len(bank.tau_ticks) - 1
    tail_length = bank.length - 1 - n_direct
    return FastFirStage(
        orders=tuple(bank.orders[i] for i in used),
        keep=np.exp(-1.0 / bank.tau_ticks).astype(dtype),
        leave=np.exp(-tail_length / bank.tau_ticks).astype(dtype),
        weights=pad_columns(bank.weights, used, dtype),
        length=bank.length,
    )
