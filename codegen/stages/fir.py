"""Fractional derivatives by a window of taps: sp_window.h and sp_taps.h."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.literals import array_text
from springpot.codegen.model.features import FirBank
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.stage import (
    REAL,
    U32,
    Columns,
    FeatureStage,
    Member,
    Probe,
    Starts,
    feature_stage,
    held_before,
    padded,
    stage_code,
)
from springpot.codegen.types import RealType

SUMS = 16  # SP_TAPS_SUMS


@dataclass(frozen=True, eq=False)
class FirStage(FeatureStage):
    """orders: those kept. taps: shape (orders, length), zero beyond `n_taps`."""

    orders: tuple[float, ...]
    taps: Reals
    n_taps: int

    headers = ("sp_window.h", "sp_taps.h")

    code = stage_code("fir")

    @property
    def n_features(self) -> int:
        return len(self.orders)

    @property
    def capacity(self) -> int:
        return len(self.taps)

    @property
    def members(self) -> tuple[Member, ...]:
        """The window, twice so that its samples are contiguous, and where it begins."""
        length = self.taps.shape[1]
        return (
            Member(f"sp_real history[2 * {length}]", (REAL,) * (2 * length)),
            Member("uint32_t newest", (U32,)),
        )

    def tables(self) -> list[str]:
        names = ", ".join(f"{order:g}" for order in self.orders)
        rows, length = self.taps.shape
        return [
            f"enum {{\n    N_TAPS = {length},\n    N_ORDERS = {rows}\n}};",
            f"/* c(r, k), newest first, {self.n_taps} and padding: a row each of {names}. */",
            array_text("taps", "sp_real", self.taps),
        ]

    def probe(self) -> Probe:
        rows, length = self.taps.shape
        return Probe(
            inputs=length,
            outputs=rows,
            sums=lambda made_up: np.array([tap_sums(row, made_up, 1)[0] for row in self.taps]),
        )

    def instructions(self, costs: Costs) -> float:
        rows, length = self.taps.shape
        return float(rows * (length * costs.tap + costs.tap_row))

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        length = self.taps.shape[1]
        result = np.zeros((len(depth), self.n_features), dtype=depth.dtype)
        for rows, samples in held_before(depth, starts, length - 1):
            n = len(samples) - length + 1
            newest_first = samples[::-1]
            for i in range(self.n_features):
                result[rows, i] = tap_sums(self.taps[i], newest_first, n)[::-1]
        return result


def tap_sums(taps: Reals, newest_first: Reals, n: int) -> Reals:
    """sp_taps.h for n windows, the newest first, each a sample earlier: shape (n,), m/s^r."""
    s = np.zeros((SUMS, n), dtype=taps.dtype)
    for k, tap in enumerate(taps):
        s[k % SUMS] += tap * newest_first[k : k + n]
    s = s[:8] + s[8:]
    s = s[:4] + s[4:]
    total: Reals = (s[0] + s[2]) + (s[1] + s[3])
    return total


@feature_stage.register
def fir_stage(bank: FirBank, kept: Columns, dt_s: float, dtype: RealType) -> FirStage:
    """Keep the columns `kept` of the bank."""
    n_taps = len(bank.taps)
    taps: Reals = np.zeros((max(len(kept), 1), padded(n_taps, SUMS)), dtype=dtype)
    taps[: len(kept), :n_taps] = bank.taps[:, kept].T
    return FirStage(orders=tuple(bank.orders[i] for i in kept), taps=taps, n_taps=n_taps)
