"""The surface that recovers while the tool is away: sp_surface.h."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals, Samples
from springpot.codegen.literals import array_text
from springpot.codegen.model.formulas import curve_place, pieces_of_one
from springpot.codegen.stages.stage import REAL, Member
from springpot.codegen.types import RealType, Scalar

LEAST = 1e-6  # of the stiffest piece: what no spring resists would come back at once


@dataclass(frozen=True, eq=False)
class RecoveringSurface:
    """stiffest: (J,), N a piece: the most that the force can rise through each piece."""

    stiffest: Reals

    headers = ("sp_surface.h",)

    def members(self, name: str) -> tuple[Member, ...]:
        return (Member(f"sp_surface_state {name}_surface", (REAL, REAL)),)

    def tables(self) -> list[str]:
        return [
            "/* At most so stiff is each piece of the depth, N a piece (sp_surface.h). */",
            array_text("stiffest", "sp_real", self.stiffest),
        ]

    def at(self, u: Scalar, before: Scalar, force_n: Scalar) -> Scalar:
        """sp_surface_at: where the model is while the tool is at u; it was at `before`."""
        if not u < before:
            return u
        if not force_n > 0:
            return before
        found = self._back(before, force_n)
        back = found if found < before else before
        return u if u > back else back

    def may_leave(self, u: Reals, before: Reals, force_n: Reals) -> NDArray[np.bool_]:
        """Ticks, (n,), in which the tool may come off: all with `at` above u, and few others.

        At the stiffest of all pieces up to `before` its way takes more than the force.
        """
        steepest = np.maximum.accumulate(self.stiffest.astype(np.float64))
        way = (before.astype(np.float64) - u) * pieces_of_one(len(self.stiffest))
        takes_n = steepest[curve_place(before, len(self.stiffest))[0]] * way
        return (u < before) & (force_n < 1.01 * takes_n)

    def _back(self, before: Scalar, force_n: Scalar) -> Scalar:
        """sp_surface_back: how far the surface comes back in a tick."""
        real = self.stiffest.dtype.type
        pieces, ways = curve_place(np.array([before]), len(self.stiffest))
        piece, way, left_n = int(pieces[0]), ways[0], force_n
        takes_n = self.stiffest[piece] * way
        while piece > 0 and left_n > takes_n:
            left_n = left_n - takes_n
            piece, way = piece - 1, real(1)
            takes_n = self.stiffest[piece]
        way = way - left_n / self.stiffest[piece]
        end = real(piece) + (way if way > 0 else real(0))
        return end / real(pieces_of_one(len(self.stiffest)))


def surface_of(most_n: Samples, dtype: RealType) -> RecoveringSurface:
    """Bound the stiffness of each piece, above which a step back could pull.

    most_n: the most that the force rises at each node, (J,), N for u from 0 to 1.
    """
    stiffest = np.append(np.maximum(most_n[1:], most_n[:-1]), most_n[-1])
    stiffest = np.maximum(stiffest, LEAST * max(float(stiffest.max()), 1e-3))
    # Rounded up, so that it is a bound in the scene's number type too.
    rounded = np.nextafter((stiffest / pieces_of_one(len(most_n))).astype(dtype), dtype(np.inf))
    return RecoveringSurface(rounded)
