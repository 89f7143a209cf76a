"""Reference of a force of three axes as it leaves: sp_lateral.h with sp_output.h.

The length of the force leaves as one force does.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.notes import LIMITED
from springpot.codegen.reference.output import Output
from springpot.codegen.stages.stage import SMALLEST, bounded, flushed


def squared(way: Sequence[Any], real: type[Any]) -> Any:
    """Sum of squares, m^2 or N^2."""
    total = real(0)
    for part in way:
        total = total + abs(part) * abs(part)
    return total


class Output3(Output):
    """A length as Output keeps it, and its direction, as a vector of length 1."""

    def __init__(self, plan: Plan) -> None:
        super().__init__(plan)
        zero = self._real(0)
        self._unit, self._was = [zero] * 3, [zero] * 3

    def turn(self, felt: Sequence[Any]) -> Any:
        """sp_lateral_length."""
        one, parts = self._real(1), [flushed(bounded(n)) for n in felt]
        length = np.sqrt(squared(parts, self._real))
        known = length > self._real(SMALLEST)
        self._unit = [max(min(n / length, one), -one) if known else self._real(0) for n in parts]
        return length

    def vector(self, given: Any) -> list[Any]:
        """sp_lateral_give."""
        return [given * part for part in self._unit]

    def came_from(self, before: list[Any], latched: bool) -> None:
        """Know the vector that was given last; latched, keep its direction."""
        self._was = before
        if latched:
            self.turn(before)

    def _slewed(self, force: Any) -> tuple[Any, int]:
        """sp_output_force's end, and sp_lateral_grown."""
        given, note = super()._slewed(force)
        ahead, was, zero = self.vector(given), self._was, self._real(0)
        square = squared(was, self._real)
        along = was[0] * ahead[0] + was[1] * ahead[1] + was[2] * ahead[2]
        part = along / square if square > self._real(SMALLEST) else zero
        stays = max(min(part, self._real(1)), zero)
        more = [n - stays * its for n, its in zip(ahead, was, strict=True)]
        growth, slew = np.sqrt(squared(more, self._real)), self._config.slew_n
        if not growth > slew:
            return given, note
        share = slew / growth
        length = self.turn([stays * its + share * n for its, n in zip(was, more, strict=True)])
        return min(length, given), note | LIMITED
