"""Fractional derivatives by a window of taps: sp_window.h and sp_weigh.h."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.ir import FirBank
from springpot.codegen.literals import array_text
from springpot.codegen.stages.stage import (
    REAL,
    U32,
    Member,
    Reals,
    Starts,
    held_before,
    padded,
)


@dataclass(frozen=True, eq=False)
class FirStage:
    """orders: those kept. taps: shape (length, lanes); lanes beyond the orders are zero."""

    orders: tuple[float, ...]
    taps: Reals

    headers = ("sp_window.h", "sp_weigh.h")

    @property
    def n_features(self) -> int:
        """Orders kept."""
        return len(self.orders)

    @property
    def room(self) -> int:
        """Lanes."""
        return int(self.taps.shape[1])

    @property
    def members(self) -> tuple[Member, ...]:
        """The window, twice, and where it begins."""
        length = len(self.taps)
        return (
            Member(f"sp_real history[2 * {length}]", (REAL,) * (2 * length)),
            Member("uint32_t newest", (U32,)),
        )

    def tables(self) -> list[str]:
        """Taps and sizes."""
        names = ", ".join(f"{order:g}" for order in self.orders)
        length, lanes = self.taps.shape
        return [
            f"enum {{\n    N_TAPS = {length},\n    N_LANES = {lanes}\n}};",
            f"/* c(r, k), newest first: a row a tap, a lane each for the orders {names}. */",
            array_text("taps", "sp_real", self.taps),
        ]

    def restart(self) -> list[str]:
        """Fill the window."""
        return ["sp_window_fill(state->history, &state->newest, N_TAPS, depth);"]

    def advance(self) -> list[str]:
        """Push the newest depth."""
        return [
            "const sp_real *window =",
            "    sp_window_push(state->history, &state->newest, N_TAPS, depth);",
        ]

    def read(self) -> list[str]:
        """Equation (16) for all orders."""
        return ["sp_weigh(taps, window, N_TAPS, N_LANES, features);"]

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        """The same sums in the same order."""
        length = len(self.taps)
        result = np.zeros((len(depth), self.n_features), dtype=depth.dtype)
        for rows, samples in held_before(depth, starts, length - 1):
            n = len(samples) - length + 1
            for i in range(self.n_features):
                total = np.zeros(n, dtype=depth.dtype)
                for k, tap in enumerate(self.taps[:, i]):
                    first = length - 1 - k
                    total += tap * samples[first : first + n]
                result[rows, i] = total
        return result


def fir_stage(bank: FirBank, kept: NDArray[np.intp], dtype: type) -> FirStage:
    """Keep the columns `kept` of the bank."""
    taps: Reals = np.zeros((len(bank.taps), padded(max(len(kept), 1))), dtype=dtype)
    taps[:, : len(kept)] = bank.taps[:, kept]
    return FirStage(orders=tuple(bank.orders[i] for i in kept), taps=taps)
